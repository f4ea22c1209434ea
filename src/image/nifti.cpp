// SPDX-License-Identifier: GPL-3.0-or-later
// NIfTI-1 in one file: https://nifti.nimh.nih.gov/nifti-1 (header nifti1.h). World axes are +x
// right to left's mirror: R, A, S, a right-handed frame.
#include <fmt/format.h>

#include <cmath>

#include "image/voxels.hpp"

namespace palpate::image {
namespace {

constexpr std::size_t kHeader = 348;
const std::string kAnew = "write it anew as one .nii file";

VoxelType voxel_type(int code, const std::string& name) {
  switch (code) {
    case 2:
      return VoxelType::u8;
    case 4:
      return VoxelType::i16;
    case 8:
      return VoxelType::i32;
    case 16:
      return VoxelType::f32;
    case 64:
      return VoxelType::f64;
    case 256:
      return VoxelType::i8;
    case 512:
      return VoxelType::u16;
    case 768:
      return VoxelType::u32;
    default:
      refuse(name, fmt::format("voxels of NIfTI type {} are not read", code),
             "convert it to 16-bit integers or floats");
  }
}

/// [mm] in one of the header's length unit; 0 (not said) counts as mm.
double length_unit(int code) {
  return code == 1 ? 1000 : code == 3 ? 0.001 : 1;
}

struct Header {
  std::string_view bytes;
  bool swap = false;
  [[nodiscard]] int i16(std::size_t at) const { return load<std::int16_t>(bytes, at, swap); }
  [[nodiscard]] double f32(std::size_t at) const { return load<float>(bytes, at, swap); }
};

/// The quaternion form: rotation, voxel sizes and the flip of the third axis.
void set_quaternion_form(const Header& h, Volume& v) {
  const double b = h.f32(256), c = h.f32(260), d = h.f32(264);
  const double a = std::sqrt(std::max(0.0, 1 - b * b - c * c - d * d));
  const Mat3 turn = Eigen::Quaterniond(a, b, c, d).normalized().toRotationMatrix();
  const double flip = h.f32(76) < 0 ? -1 : 1;
  for (int k = 0; k < 3; ++k) v.step.col(k) = turn.col(k) * h.f32(80 + 4 * k) * (k == 2 ? flip : 1);
  v.origin = {h.f32(268), h.f32(272), h.f32(276)};
}

}  // namespace

Volume parse_nifti(std::string_view bytes, const std::string& name) {
  std::string inflated;
  if (bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b') {
    inflated = inflate_gzip(bytes, kHeader, name);
    if (inflated.size() < kHeader) refuse(name, "ends inside its header", "copy the file again");
  }
  Header h{inflated.empty() ? bytes : std::string_view(inflated)};
  if (h.bytes.size() < kHeader) refuse(name, "ends inside its header", "copy the file again");
  h.swap = load<std::int32_t>(h.bytes, 0) != static_cast<std::int32_t>(kHeader);
  if (load<std::int32_t>(h.bytes, 0, h.swap) != static_cast<std::int32_t>(kHeader) ||
      h.bytes.substr(344, 3) != "n+1")
    refuse(name, "is no NIfTI-1 file of header and voxels in one", kAnew);
  const int dimensions = h.i16(40);
  if (dimensions < 3 || dimensions > 7) refuse(name, "is not three-dimensional", kAnew);
  for (int d = 4; d <= dimensions; ++d)
    if (h.i16(40 + 2 * d) > 1)
      refuse(name, "holds more than one volume", "extract one volume of the series");
  Volume v;
  v.format = "nifti";
  std::array<std::int64_t, 3> size{};
  for (int a = 0; a < 3; ++a) size[a] = v.size[a] = h.i16(42 + 2 * a);
  const std::size_t count = checked_count(size, name);
  const VoxelType type = voxel_type(h.i16(70), name);

  if (h.i16(254) > 0)  // the affine form
    for (int row = 0; row < 3; ++row) {
      for (int col = 0; col < 3; ++col) v.step(row, col) = h.f32(280 + 16 * row + 4 * col);
      v.origin[row] = h.f32(280 + 16 * row + 12);
    }
  else if (h.i16(252) > 0)
    set_quaternion_form(h, v);
  else {
    for (int a = 0; a < 3; ++a) v.step(a, a) = h.f32(80 + 4 * a);
    v.warnings.push_back(name + " does not say how its axes lie: left and right may be swapped");
  }
  const double unit = length_unit(static_cast<unsigned char>(h.bytes[123]) & 7);
  v.step *= unit;
  v.origin *= unit;
  check_grid(v, name);

  const double offset = h.f32(108);
  if (!(offset >= kHeader && offset <= 1e6)) refuse(name, "its voxels start nowhere", kAnew);
  const auto start = static_cast<std::size_t>(offset);
  double slope = h.f32(112), intercept = h.f32(116);
  if (slope == 0) slope = 1, intercept = 0;
  if (!inflated.empty()) {
    const std::size_t all = start + count * bytes_of(type);
    const bool swap = h.swap;
    inflated = inflate_gzip(bytes, all, name);
    bytes = inflated;
    h = {bytes, swap};
  }
  if (bytes.size() < start) refuse(name, "ends before its voxels", "copy the file again");
  v.value = to_floats(bytes.substr(start), type, h.swap, count, slope, intercept, name);
  return v;
}

}  // namespace palpate::image
