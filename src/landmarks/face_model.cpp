// SPDX-License-Identifier: GPL-3.0-or-later
#include "landmarks/face_model.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>

namespace palpate::landmarks {
namespace {

constexpr std::int16_t kData[] = {
#include "landmarks/face_model_data.inc"
};
constexpr int kRow = 6 + 3 * FaceModel::kModes;

// The last rows of the data, in the order in which tools/assets/face_model.py writes them.
constexpr std::array<const char*, 12> kMarks = {
    "nose_tip",          "nose_corner_left", "eye_outer_left", "eye_inner_left", "chin",
    "gnathion",          "nasion",           "glabella",       "subnasale",      "stomion",
    "mouth_corner_left", "ear_left"};
constexpr std::size_t kRows = std::size(kData) / kRow;
static_assert(kRows * kRow == std::size(kData));

Vec3 vector_at(std::size_t row, int column) {
  const std::int16_t* p = kData + row * kRow + column;
  return Vec3(p[0], p[1], p[2]) / 100;
}

FaceModel::Modes modes_at(std::size_t row) {
  FaceModel::Modes modes;
  for (int k = 0; k < FaceModel::kModes; ++k) modes[k] = vector_at(row, 6 + 3 * k);
  return modes;
}

Vec3 mirrored(const Vec3& p) {
  return {-p.x(), p.y(), p.z()};
}

FaceModel::Modes mirrored(FaceModel::Modes modes) {
  for (Vec3& m : modes) m = mirrored(m);
  return modes;
}

FaceModel build() {
  FaceModel model;
  const std::size_t samples = kRows - kMarks.size();
  for (std::size_t row = 0; row < samples; ++row) {
    const Vec3 p = vector_at(row, 0), n = vector_at(row, 3).normalized();
    const auto modes = modes_at(row);
    model.points.push_back(p);
    model.normals.push_back(n);
    model.modes.push_back(modes);
    if (p.x() == 0) continue;
    model.points.push_back(mirrored(p));
    model.normals.push_back(mirrored(n));
    model.modes.push_back(mirrored(modes));
  }
  for (std::size_t i = 0; i < kMarks.size(); ++i) {
    const std::string name = kMarks[i];
    const std::size_t row = samples + i;
    model.marks[name] = vector_at(row, 0);
    model.mark_modes[name] = modes_at(row);
    const auto left = name.rfind("_left");
    if (left == std::string::npos) continue;
    const std::string right = name.substr(0, left) + "_right";
    model.marks[right] = mirrored(vector_at(row, 0));
    model.mark_modes[right] = mirrored(modes_at(row));
  }
  return model;
}

Vec3 displaced(Vec3 p, const FaceModel::Modes& modes, const FaceModel::Coefficients& c) {
  for (int k = 0; k < FaceModel::kModes; ++k) p += c[k] * modes[k];
  return p;
}

}  // namespace

Vec3 FaceModel::point(std::size_t i, const Coefficients& c) const {
  return displaced(points[i], modes[i], c);
}

Vec3 FaceModel::mark(const std::string& name, const Coefficients& c) const {
  return displaced(marks.at(name), mark_modes.at(name), c);
}

const FaceModel& face_model() {
  static const FaceModel model = build();
  return model;
}

}  // namespace palpate::landmarks
