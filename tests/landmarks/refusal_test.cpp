// SPDX-License-Identifier: GPL-3.0-or-later
// What is not a head is refused with one line that says what was looked for.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "core/error.hpp"
#include "heads.hpp"
#include "landmarks/complete.hpp"

namespace palpate::landmarks {
namespace {

using Field = std::function<double(const Vec3&)>;  // [mm] negative inside

// The zero level of a field by marching tetrahedra (Kuhn's six per cell), points welded by edge.
SurfaceMesh surface_of(const Field& field, const Vec3& low, const Vec3& high, double step) {
  const Eigen::Vector3i n = ((high - low) / step).array().ceil().cast<int>() + 1;
  const auto id = [&](int i, int j, int k) { return (k * n.y() + j) * n.x() + i; };
  std::vector<Vec3> grid;
  std::vector<double> value;
  for (int k = 0; k < n.z(); ++k)
    for (int j = 0; j < n.y(); ++j)
      for (int i = 0; i < n.x(); ++i) {
        grid.push_back(low + step * Vec3(i, j, k));
        value.push_back(field(grid.back()));
      }
  SurfaceMesh mesh;
  std::map<std::pair<int, int>, int> cut;
  const auto crossing = [&](int a, int b) {
    const auto [at, fresh] = cut.try_emplace(std::minmax(a, b), mesh.points.size());
    if (fresh) {
      const double t = value[a] / (value[a] - value[b]);
      mesh.points.push_back(grid[a] + t * (grid[b] - grid[a]));
    }
    return at->second;
  };
  const auto add = [&](int a, int b, int c, const Vec3& outward) {
    const Vec3 normal = (mesh.points[b] - mesh.points[a]).cross(mesh.points[c] - mesh.points[a]);
    if (normal.dot(outward) < 0) std::swap(b, c);
    mesh.triangles.push_back({a, b, c});
  };
  const auto march = [&](const std::array<int, 4>& tet) {
    std::vector<int> in, out;
    Vec3 outward = Vec3::Zero();
    for (int v : tet) {
      (value[v] < 0 ? in : out).push_back(v);
      outward += (value[v] < 0 ? -1.0 : 1.0) * grid[v];
    }
    if (in.empty() || out.empty()) return;
    if (in.size() == 2) {
      outward = grid[out[0]] + grid[out[1]] - grid[in[0]] - grid[in[1]];
      const int a = crossing(in[0], out[0]), b = crossing(in[0], out[1]);
      const int c = crossing(in[1], out[1]), d = crossing(in[1], out[0]);
      add(a, b, c, outward);
      add(a, c, d, outward);
      return;
    }
    const bool one_in = in.size() == 1;
    const int lone = one_in ? in[0] : out[0];
    const auto& rest = one_in ? out : in;
    outward =
        (one_in ? 1.0 : -1.0) * (grid[rest[0]] + grid[rest[1]] + grid[rest[2]] - 3 * grid[lone]);
    add(crossing(lone, rest[0]), crossing(lone, rest[1]), crossing(lone, rest[2]), outward);
  };
  constexpr int kPaths[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
  for (int k = 0; k + 1 < n.z(); ++k)
    for (int j = 0; j + 1 < n.y(); ++j)
      for (int i = 0; i + 1 < n.x(); ++i)
        for (const auto& path : kPaths) {
          Eigen::Vector3i at(i, j, k);
          std::array<int, 4> tet{id(i, j, k), 0, 0, 0};
          for (int s = 0; s < 3; ++s) {
            ++at[path[s]];
            tet[s + 1] = id(at.x(), at.y(), at.z());
          }
          march(tet);
        }
  return mesh;
}

double capsule(const Vec3& p, const Vec3& a, const Vec3& b, double r) {
  const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
  return (p - (a + t * (b - a))).norm() - r;
}

double box(const Vec3& p, const Vec3& half, double round) {
  const Vec3 q = p.cwiseAbs() - half;
  return q.cwiseMax(0).norm() + std::min(q.maxCoeff(), 0.0) - round;
}

double hand(const Vec3& p) {
  double d = box(p, Vec3(38, 45, 9), 6);
  for (int f = 0; f < 4; ++f) {
    const double x = -30 + 20 * f, length = 70 + (f == 1 || f == 2 ? 15 : 0);
    d = std::min(d, capsule(p, Vec3(x, 40, 0), Vec3(1.2 * x, 45 + length, 6), 9));
  }
  return std::min(d, capsule(p, Vec3(38, -20, 4), Vec3(80, 30, 20), 10));
}

std::string refusal(const SurfaceMesh& mesh, bool face_alone_will_do = true) {
  try {
    const SurfaceMesh skin = surface::make_working_surface(mesh).mesh;
    if (face_alone_will_do)
      (void)find_face(skin);
    else
      (void)detect_landmarks(skin);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

void expect_one_line(const std::string& message, const std::string& words) {
  EXPECT_NE(message.find(words), std::string::npos) << message;
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

TEST(Refusal, Cube) {
  const auto cube = [](const Vec3& p) { return box(p, Vec3::Constant(90), 0.5); };
  expect_one_line(refusal(surface_of(cube, Vec3::Constant(-99), Vec3::Constant(99), 6)),
                  "no face found");
}

TEST(Refusal, Sphere) {
  const auto ball = [](const Vec3& p) { return p.norm() - 95; };
  expect_one_line(refusal(surface_of(ball, Vec3::Constant(-101), Vec3::Constant(102), 6)),
                  "no face found");
}

TEST(Refusal, Hand) {
  expect_one_line(refusal(surface_of(hand, Vec3(-70, -70, -30), Vec3(110, 150, 50), 3)),
                  "no face found");
}

TEST(Refusal, FaceWithoutABack) {
  const KnownHead& head = bundled_head();
  SurfaceMesh face;
  face.points = head.scan.points;
  const double cut = head.truth.at("eye_outer_left").z() - 45;  // [mm] behind the eyes
  for (const Triangle& t : head.scan.triangles) {
    if (face.points[t[0]].z() > cut) face.triangles.push_back(t);
  }
  expect_one_line(refusal(face, false), "without the back of its head");
}

// The part of a face that is left by a box must not pass where a face alone will do.
SurfaceMesh cut_face(double below, double above, double wide) {
  const KnownHead& head = bundled_head();
  SurfaceMesh face{head.scan.points, {}};
  const Vec3 eye = head.truth.at("eye_outer_left");
  for (const Triangle& t : head.scan.triangles) {
    const Vec3& p = face.points[t[0]];
    if (p.z() > eye.z() - 45 && p.y() > eye.y() - below && p.y() < eye.y() + above &&
        std::abs(p.x()) < wide)
      face.triangles.push_back(t);
  }
  return face;
}

TEST(Refusal, PartOfAFace) {
  EXPECT_EQ(refusal(cut_face(130, 75, 200)), "");
  EXPECT_NE(refusal(cut_face(50, 75, 200)), "");   // ends above the lips
  EXPECT_NE(refusal(cut_face(130, -5, 200)), "");  // begins below the eyes
}

}  // namespace
}  // namespace palpate::landmarks
