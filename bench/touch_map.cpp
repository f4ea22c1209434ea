// SPDX-License-Identifier: GPL-3.0-or-later
// The tick against the map by another way: the nearest triangle by trying all, core's coefficients.
#include <cmath>
#include <random>
#include <span>

#include "haptics/slide.hpp"
#include "touch_figures.hpp"

namespace palpate::bench {

using namespace haptics;

namespace {

class Checker {
 public:
  explicit Checker(const TouchScene& scene)
      : scene_(scene), setup_(make_tick_setup(scene.model, unlimited(), scenes::elastic_only())) {
    skin_ = scene.head.skin;
    for (Vec3& p : skin_.points) p = scene.head.frame.to_head(scene.head.unit_mm * p);
  }
  double worst = 0;  // [N]
  int compared = 0, creases = 0, blocked = 0, behind = 0;

  void check_one_in(const std::vector<std::int32_t>& triangles) {
    const ContactMesh& mesh = scene_.model.mesh;
    const Triangle& t =
        mesh.triangles[static_cast<std::size_t>(triangles[rng_() % triangles.size()])];
    const Vec3 b = Vec3(uniform(), uniform(), uniform()) + Vec3::Constant(1e-3);
    Vec3 p = Vec3::Zero(), n = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      p += b[k] / b.sum() * mesh.points[static_cast<std::size_t>(t[k])];
      n += b[k] * mesh.normals[static_cast<std::size_t>(t[k])];
    }
    press(p, n.normalized(), 0.05 + 3.95 * uniform());
  }

 private:
  double uniform() { return static_cast<double>(rng_()) / 4294967296.0; }

  void press(const Vec3& p, const Vec3& n, double depth) {
    const double radius = scene_.model.tool_radius;
    TickState state;
    TickInput input;
    input.position = p + (radius + 1) * n;
    (void)tick(setup_, input, state);
    if (state.in_contact) {  // in the other lip, say: not pressed from outside
      ++blocked;
      return;
    }
    input.position = p + (radius - depth) * n;
    ProxyState proxy = state.proxy;
    const Contact contact = find_contact(scene_.model.mesh, radius, input.position, proxy);
    const TickOutput out = tick(setup_, input, state);
    if (contact.count > 1) {  // rests on several flanks: not the nearest point's force
      ++creases;
      return;
    }
    const double force = mapped(input.position);
    if (std::isnan(force)) {
      ++behind;
      return;
    }
    worst = std::max(worst, std::abs(out.map_force - force));
    ++compared;
  }

  // NaN where the nearest skin is the back of another sheet (of a mouth, an eye socket), which the
  // tool, outside, does not touch.
  [[nodiscard]] double mapped(const Vec3& center) const {
    double best = 1e300;
    TrianglePoint on{};
    const Triangle* corners = nullptr;
    for (const Triangle& t : skin_.triangles) {
      const TrianglePoint q =
          nearest_on_triangle(center, skin_.points[t[0]], skin_.points[t[1]], skin_.points[t[2]]);
      const double distance = (q.point - center).norm();
      if (distance >= best) continue;
      best = distance;
      on = q;
      corners = &t;
    }
    const TouchModel& model = scene_.model;
    const std::size_t m = model.curves.knots;
    Vec3 n = Vec3::Zero();
    for (int k = 0; k < 3; ++k)
      n += on.barycentric[k] *
           model.mesh.normals[static_cast<std::size_t>(model.mesh.vertex_of[(*corners)[k]])];
    if (n.dot(center - on.point) < 0) return std::nan("");
    const double depth = model.tool_radius - best;
    double force = 0;
    for (int k = 0; k < 3; ++k) {
      const auto row = static_cast<std::size_t>(model.mesh.vertex_of[(*corners)[k]]);
      const std::span<const double> u(model.curves.travel.data() + row * m, m);
      force +=
          on.barycentric[k] * force_at(stiffness_coefficients(scene_.head.map.forces, u), u, depth);
    }
    return force;
  }

  const TouchScene& scene_;
  TickSetup setup_;
  SurfaceMesh skin_;
  std::mt19937 rng_{3};
};

}  // namespace

void compare_with_map(const TouchScene& scene, int per_region, Table& table) {
  const TouchModel& model = scene.model;
  Checker checker(scene);
  int regions = 0;
  for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r) {
    std::vector<std::int32_t> own;
    for (std::size_t t = 0; t < model.mesh.triangles.size(); ++t)
      if (model.region[static_cast<std::size_t>(model.mesh.triangles[t][0])] ==
          static_cast<SkinRegion>(r))
        own.push_back(static_cast<std::int32_t>(t));
    if (own.empty()) continue;
    ++regions;
    for (int i = 0; i < per_region; ++i) checker.check_one_in(own);
  }
  table.add(
      "force against the map", "1e-6 N, every region",
      fmt::format(
          "{:.1e} N; {} contacts in {} regions, {} more in creases, {} not reached from outside, "
          "{} before another sheet's back",
          checker.worst, checker.compared, regions, checker.creases, checker.blocked,
          checker.behind),
      checker.worst <= 1e-6);
}

}  // namespace palpate::bench
