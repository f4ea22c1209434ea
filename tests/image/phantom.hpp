// SPDX-License-Identifier: GPL-3.0-or-later
// A head of concentric ellipsoids as a CT would see it, and the same as files.
#pragma once
#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>

#include "image/volume.hpp"

namespace palpate::image {

inline const Vec3 kSkinAxes(70, 80, 75), kSkullAxes(63, 73, 68);  // [mm]
inline const Vec3 kCentre(5, -8, 12);

/// 0 on the ellipsoid, about the distance [mm] near it, negative inside.
inline double level_of(const Vec3& p, const Vec3& axes) {
  const Vec3 q = (p - kCentre).cwiseQuotient(axes);
  return (q.norm() - 1) * axes.minCoeff();
}

/// Air -1000, flesh 40, a shell of bone 1000 of 6 mm with soft borders of one voxel, an air bubble
/// inside and a bar of flesh outside (a head holder).
inline Volume phantom(double edge = 2) {
  Volume v;
  v.format = "phantom";
  const Mat3 turn = Eigen::AngleAxisd(0.3, Vec3(1, 2, 0.5).normalized()).toRotationMatrix();
  v.step = edge * turn;
  const int n = static_cast<int>(2 * 95 / edge);
  v.size = {n, n, n};
  v.origin = kCentre - v.step * Vec3(n / 2.0, n / 2.0, n / 2.0);
  const auto share = [&](double level) { return std::clamp(0.5 - level / edge, 0.0, 1.0); };
  v.value.reserve(v.index(0, 0, n));
  for (int k = 0; k < n; ++k)
    for (int j = 0; j < n; ++j)
      for (int i = 0; i < n; ++i) {
        const Vec3 p = v.place(Vec3(i, j, k));
        double hu = -1000 + 1040 * share(level_of(p, kSkinAxes));
        const double outer = share(level_of(p, kSkullAxes));
        const double inner = share(level_of(p, kSkullAxes - Vec3::Constant(6)));
        hu += 960 * (outer - inner);
        if ((p - kCentre).norm() < 15) hu = -1000;
        if (i < 2 && k < n / 2) hu = 40;
        v.value.push_back(static_cast<float>(hu));
      }
  return v;
}

template <class T>
void put(std::string& out, std::size_t at, T value) {
  if (out.size() < at + sizeof(T)) out.resize(at + sizeof(T));
  std::memcpy(out.data() + at, &value, sizeof(T));
}

/// NIfTI-1 of 16-bit integers, with the affine.
inline std::string nifti_of(const Volume& v) {
  std::string out(352, '\0');
  put<std::int32_t>(out, 0, 348);
  put<std::int16_t>(out, 40, 3);
  for (int a = 0; a < 3; ++a)
    put<std::int16_t>(out, 42 + 2 * a, static_cast<std::int16_t>(v.size[a]));
  put<std::int16_t>(out, 70, 4);
  put<std::int16_t>(out, 72, 16);
  for (int a = 0; a < 3; ++a) put<float>(out, 80 + 4 * a, static_cast<float>(v.spacing(a)));
  put<float>(out, 108, 352);
  put<float>(out, 112, 1);
  out[123] = 2;
  put<std::int16_t>(out, 254, 1);
  for (int r = 0; r < 3; ++r) {
    for (int c = 0; c < 3; ++c)
      put<float>(out, 280 + 16 * r + 4 * c, static_cast<float>(v.step(r, c)));
    put<float>(out, 280 + 16 * r + 12, static_cast<float>(v.origin[r]));
  }
  out.replace(344, 4, std::string("n+1\0", 4));
  for (const float x : v.value)
    put<std::int16_t>(out, out.size(), static_cast<std::int16_t>(std::lround(x)));
  return out;
}

inline std::string nrrd_of(const Volume& v) {
  std::string out =
      "NRRD0004\n# made by a test\ntype: short\ndimension: 3\nspace: "
      "left-posterior-superior\nsizes:";
  for (const int n : v.size) out.append(" ").append(std::to_string(n));
  out += "\nspace directions:";
  for (int a = 0; a < 3; ++a)
    out += " (" + std::to_string(v.step(0, a)) + "," + std::to_string(v.step(1, a)) + "," +
           std::to_string(v.step(2, a)) + ")";
  out += "\nendian: little\nencoding: raw\nspace origin: (" + std::to_string(v.origin[0]) + "," +
         std::to_string(v.origin[1]) + "," + std::to_string(v.origin[2]) + ")\n\n";
  for (const float x : v.value)
    put<std::int16_t>(out, out.size(), static_cast<std::int16_t>(std::lround(x)));
  return out;
}

/// One slice, explicit VR little endian.
inline std::string dicom_of(const Volume& v, int k) {
  std::string out(128, '\0');
  out += "DICM";
  const auto element = [&](std::uint16_t group, std::uint16_t number, const char* vr,
                           std::string value) {
    if (value.size() % 2) value += ' ';
    put<std::uint16_t>(out, out.size(), group);
    put<std::uint16_t>(out, out.size(), number);
    out += vr;
    if (std::string(vr) == "OW") {
      put<std::uint16_t>(out, out.size(), 0);
      put<std::uint32_t>(out, out.size(), static_cast<std::uint32_t>(value.size()));
    } else {
      put<std::uint16_t>(out, out.size(), static_cast<std::uint16_t>(value.size()));
    }
    out += value;
  };
  const auto numbers = [](std::initializer_list<double> all) {
    std::string s;
    for (const double x : all) s.append(s.empty() ? "" : "\\").append(std::to_string(x));
    return s;
  };
  const auto us = [](int x) {
    std::string s;
    put<std::uint16_t>(s, 0, static_cast<std::uint16_t>(x));
    return s;
  };
  const Vec3 p = v.place(Vec3(0, 0, k)), r = v.step.col(0).normalized(),
             c = v.step.col(1).normalized();
  element(2, 0x10, "UI", "1.2.840.10008.1.2.1");
  element(0x20, 0xe, "UI", "1.2.3");
  element(0x20, 0x32, "DS", numbers({p.x(), p.y(), p.z()}));
  element(0x20, 0x37, "DS", numbers({r.x(), r.y(), r.z(), c.x(), c.y(), c.z()}));
  element(0x28, 0x10, "US", us(v.size[1]));
  element(0x28, 0x11, "US", us(v.size[0]));
  element(0x28, 0x30, "DS", numbers({v.spacing(1), v.spacing(0)}));
  element(0x28, 0x100, "US", us(16));
  element(0x28, 0x103, "US", us(0));
  element(0x28, 0x1052, "DS", "-1024");
  element(0x28, 0x1053, "DS", "1");
  std::string pixels;
  for (int j = 0; j < v.size[1]; ++j)
    for (int i = 0; i < v.size[0]; ++i)
      put<std::uint16_t>(pixels, pixels.size(),
                         static_cast<std::uint16_t>(std::lround(v.at(i, j, k)) + 1024));
  element(0x7fe0, 0x10, "OW", pixels);
  return out;
}

}  // namespace palpate::image
