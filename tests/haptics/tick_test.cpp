// SPDX-License-Identifier: Apache-2.0
// The tick: the map's force, no jumps, Coulomb's cone, no energy from nowhere.
#include "haptics/tick.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "core/error.hpp"
#include "scenes.hpp"
#include "slide.hpp"

namespace palpate::haptics {
namespace {

using scenes::elastic_only;

TickInput at(const Vec3& p) {
  TickInput input;
  input.position = p;
  return input;
}

Vec3 random_direction(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return Vec3(normal(rng), normal(rng), normal(rng)).normalized();
}

// The map's own words: core's coefficients, blended over the nearest triangle found by trying all.
double mapped_force(const TouchableHead& head, const std::vector<Vec3>& normals, double radius,
                    const Vec3& center) {
  double best = 1e300, force = 0;
  for (const Triangle& t : head.skin.triangles) {
    const auto& p = head.skin.points;
    const TrianglePoint on = nearest_on_triangle(center, p[t[0]], p[t[1]], p[t[2]]);
    const double distance = (on.point - center).norm();
    if (distance >= best) continue;
    best = distance;
    Vec3 n = Vec3::Zero();
    for (int k = 0; k < 3; ++k) n += on.barycentric[k] * normals[t[k]];
    const double depth = radius - std::copysign(distance, n.dot(center - on.point));
    force = 0;
    for (int k = 0; k < 3; ++k) {
      const auto u = head.map.curve(static_cast<std::size_t>(t[k]));
      force += on.barycentric[k] * force_at(stiffness_coefficients(head.map.forces, u), u, depth);
    }
  }
  return force;
}

TEST(Tick, ForceIsTheBlendedMapAtRandomContacts) {
  const TouchableHead head = scenes::bumpy_head(40);
  const TouchModel model = make_touch_model(head);
  const TickSetup setup = make_tick_setup(model, unlimited(), elastic_only());
  const std::vector<Vec3> normals = vertex_normals(head.skin);
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> depth(0.05, 8);
  double worst = 0;
  for (int i = 0; i < 600; ++i) {
    const Vec3 d = random_direction(rng);
    const SurfacePoint near = model.mesh.nearest(Vec3(75 * d.x(), 110 * d.y(), 95 * d.z()), 1e300);
    const Vec3 center = near.on.point + (5 - depth(rng)) * model.mesh.blended_normal(near);
    TickState state;
    (void)tick(setup, at(near.on.point + 7 * model.mesh.blended_normal(near)), state);
    const TickOutput out = tick(setup, at(center), state);
    ASSERT_TRUE(out.in_contact);
    worst = std::max(worst, std::abs(out.map_force - mapped_force(head, normals, 5, center)));
    ASSERT_NEAR(out.force.norm(), std::min(out.map_force, 100.0), 1e-12);
  }
  EXPECT_LT(worst, 1e-6);
}

// Straight down at one vertex: k_i u + b_i on every piece and beyond the last knot.
TEST(Tick, FollowsEveryPieceOfACurve) {
  const TouchableHead head = scenes::bumpy_head(40, 0);
  const TouchModel model = make_touch_model(head);
  const TickSetup setup = make_tick_setup(model, unlimited(), elastic_only());
  std::size_t top = 0;
  for (std::size_t v = 0; v < head.skin.points.size(); ++v)
    if (head.skin.points[v].y() > head.skin.points[top].y()) top = v;
  const auto u = head.map.curve(top);
  const StiffnessCoefficients c = stiffness_coefficients(head.map.forces, u);
  TickState state;
  for (double depth = -1; depth < u.back() + 2; depth += 0.0137) {
    const Vec3 center = head.skin.points[top] + (5 - depth) * Vec3::UnitY();
    const TickOutput out = tick(setup, at(center), state);
    ASSERT_NEAR(out.map_force, force_at(c, u, depth), 1e-9) << depth;
  }
}

// 100 mm/s from crown to neck, 3 mm deep (slide.hpp).
TEST(Tick, SlidingOverTheWholeHeadDoesNotJump) {
  for (const int n : {50, 112}) {
    const TouchModel model = make_touch_model(scenes::bumpy_head(n));
    scenes::SlideOptions options;
    options.spacing = 15;
    const scenes::SlideResult worst = scenes::slide_over_head(model, options);
    EXPECT_GT(worst.ticks, 60000U);
    EXPECT_EQ(worst.lifts, 0U);
    EXPECT_LT(worst.excess, 0.05);
    EXPECT_LT(worst.turn_smooth, 2);
    EXPECT_LT(worst.depth_jump, 0.05);
    std::printf("%zu triangles: %zu ticks, excess %.4f N, depth %.4f mm, turn %.2f deg\n",
                model.mesh.triangles.size(), worst.ticks, worst.excess, worst.depth_jump,
                worst.turn_smooth);
  }
}

// A right-angled ridge turns the nearest point's direction by 90 degrees within a tenth of a
// millimetre of the tool's way, when the tool is fast: the hand feels it turn.
TEST(Tick, PushGoesOverTheRidgeInSteps) {
  const TouchModel model =
      make_touch_model(scenes::landscape(40, 80, 1, [](double x, double) { return -std::abs(x); }));
  const TickSetup setup = make_tick_setup(model, unlimited(), elastic_only());
  TickState state;
  TickOutput out, before;
  double fastest = 0;
  for (double z = 6; z > 1; z -= 0.02) out = tick(setup, at(Vec3(-3, 0, z)), state);
  ASSERT_TRUE(out.in_contact);
  for (double x = -3; x < 3; x += 0.5) {  // 500 mm/s
    before = out;
    out = tick(setup, at(Vec3(x, 0, 4 - std::abs(x))), state);
    fastest = std::max(fastest, std::acos(std::min(1.0, out.normal.dot(before.normal))));
  }
  EXPECT_TRUE(out.settling);
  for (int i = 0; i < 100; ++i) out = tick(setup, at(Vec3(3, 0, 1)), state);
  EXPECT_FALSE(out.settling);
  const TickOutput still = tick(setup, at(Vec3(3, 0, 1)), state);
  EXPECT_EQ(still.elastic, still.map_force);
  EXPECT_LT((still.normal - Vec3(1, 0, 1).normalized()).norm(), 1e-3);
  EXPECT_LT(fastest, 1.6 * std::numbers::pi / 180);
}

TEST(Tick, CoulombConeSticksThenSlips) {
  const TouchModel model =
      make_touch_model(scenes::landscape(40, 20, 1, [](double, double) { return 0.0; }));
  TickOptions o = elastic_only();
  o.static_friction = 0.5;
  o.kinetic_friction = 0.3;
  o.slip_distance = 0.5;
  const TickSetup setup = make_tick_setup(model, unlimited(), o);
  TickState state;
  for (double z = 6; z > 3; z -= 0.01) (void)tick(setup, at(Vec3(0, 0, z)), state);
  const double normal = 2;  // [N] 2 mm at 1 N/mm
  double largest = 0, last = 0;
  for (double x = 0; x < 10; x += 0.01) {
    const TickOutput out = tick(setup, at(Vec3(x, 0, 3)), state);
    last = -out.force.x();
    if (x < 1.9) {
      EXPECT_NEAR(last, 0.5 * x, 0.01);
    }  // sticking: a spring of 0.5 N/mm
    largest = std::max(largest, last);
    EXPECT_NEAR(out.force.z(), normal, 1e-6);
  }
  EXPECT_NEAR(largest, 0.5 * normal, 0.02);
  EXPECT_NEAR(last, 0.3 * normal, 1e-3);
  for (int i = 0; i < 1000; ++i) (void)tick(setup, at(Vec3(10, 0, 3)), state);
  EXPECT_LT(state.slip, 1e-3) << "static friction heals at rest";
}

TEST(Tick, FrictionCanDifferFromVertexToVertex) {
  const TouchableHead head = scenes::landscape(40, 20, 1, [](double, double) { return 0.0; });
  TouchModelOptions options;
  for (const Vec3& p : head.skin.points) options.friction.push_back(p.x() < 0 ? 0 : 2);
  const TouchModel model = make_touch_model(head, options);
  TickOptions o = elastic_only();
  o.static_friction = o.kinetic_friction = 0.3;
  const TickSetup setup = make_tick_setup(model, unlimited(), o);
  const auto shear_at = [&](double x0) {
    TickState state;
    TickOutput out;
    for (double z = 6; z > 3; z -= 0.01) out = tick(setup, at(Vec3(x0, 0, z)), state);
    for (double y = 0; y < 8; y += 0.02) out = tick(setup, at(Vec3(x0, y, 3)), state);
    return -out.force.y();
  };
  EXPECT_NEAR(shear_at(-20), 0, 1e-9);
  EXPECT_NEAR(shear_at(20), 2 * 0.3 * 2, 1e-6);
}

TEST(Tick, RateTermOpposesIndentingOnlyAndNeverPulls) {
  const TouchModel model =
      make_touch_model(scenes::landscape(40, 20, 1, [](double, double) { return 0.0; }));
  TickOptions o = elastic_only();
  o.rate = 0.002;
  DeviceLimits strong = unlimited();
  const TickSetup setup = make_tick_setup(model, strong, o);
  TickState state;
  TickOutput out;
  for (double z = 6; z > 3; z -= 0.1) out = tick(setup, at(Vec3(0, 0, z)), state);  // 100 mm/s
  EXPECT_NEAR(out.force.z(), out.elastic * 1.2, 0.01);
  for (double z = 3; z < 6; z += 2.0) {  // 2 m/s out
    out = tick(setup, at(Vec3(0, 0, z)), state);
    EXPECT_GE(out.force.z(), 0);
  }
}

TEST(Tick, DeviceLimitsHold) {
  const TouchModel model = make_touch_model(scenes::even_sphere(30, 90, 6));
  for (const DeviceLimits& device : known_devices()) {
    TickOptions o = elastic_only();
    o.slew = 500;
    const TickSetup setup = make_tick_setup(model, device, o);
    TickState state;
    TickOutput previous;
    for (double r = 96; r > 60; r -= 0.05) {
      const TickOutput out = tick(setup, at(Vec3(0, r, 0)), state);
      ASSERT_LE(out.force.norm(), device.peak_force * (1 + 1e-12)) << device.name;
      ASSERT_LE((out.force - previous.force).norm(), 0.5 * (1 + 1e-9));
      ASSERT_LE(out.elastic - previous.elastic, device.stiffness * 0.05 * 1.001) << device.name;
      previous = out;
    }
    EXPECT_TRUE(previous.clamped);
  }
}

TEST(Tick, ScalingForAWeakDeviceKeepsRatios) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(30));
  const auto touch = limits_of("3D Systems Touch");
  ASSERT_TRUE(touch);
  TickOptions keep_ratios = elastic_only();
  keep_ratios.scaling = Scaling::ratio;
  const TickSetup weak = make_tick_setup(model, *touch, keep_ratios);
  const TickSetup full = make_tick_setup(model, unlimited(), elastic_only());
  ASSERT_LT(weak.scale, 1);
  EXPECT_FALSE(weak.warnings.empty());
  for (const Vec3& d : {Vec3(0.1, -1, 0.2), Vec3(0.2, 1, 0.1), Vec3(1, 0.1, 0.3)}) {
    const SurfacePoint near = model.mesh.nearest(300 * d, 1e300);
    const Vec3 n = model.mesh.blended_normal(near);
    TickState a, b;
    (void)tick(weak, at(near.on.point + 6 * n), a);
    (void)tick(full, at(near.on.point + 6 * n), b);
    const TickOutput x = tick(weak, at(near.on.point + 4.2 * n), a);
    const TickOutput y = tick(full, at(near.on.point + 4.2 * n), b);
    EXPECT_NEAR(x.elastic / y.elastic, weak.scale, 0.01 * weak.scale);
  }
}

TEST(Tick, PublishedPresetClampsAt8Point7) {
  EXPECT_EQ(published_preset().peak_force, 8.7);
  EXPECT_EQ(limits_of("falcon")->peak_force, 8.0);
}

TEST(Tick, StartingInsideIsSoft) {
  const TouchModel model = make_touch_model(scenes::even_sphere(30, 90, 2));
  TickOptions o = elastic_only();
  o.soft_start = 0.3;
  const TickSetup setup = make_tick_setup(model, unlimited(), o);
  TickState state;
  double previous = 0;
  for (int i = 0; i <= 300; ++i) {
    const TickOutput out = tick(setup, at(Vec3(0, 92, 0)), state);
    ASSERT_LE(out.force.norm() - previous, out.elastic / 300 * 1.01);
    previous = out.force.norm();
  }
  EXPECT_NEAR(previous, 6, 0.1);
}

TEST(Tick, NotFiniteIsZeroForceAndAFreshStart) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 2));
  const TickSetup setup = make_tick_setup(model, unlimited());
  TickState state;
  for (double r = 97; r > 92; r -= 0.05) (void)tick(setup, at(Vec3(0, r, 0)), state);
  const double bad = std::numeric_limits<double>::quiet_NaN();
  for (const Vec3& p : {Vec3(bad, 0, 0), Vec3(0, 1 / 0.0, 0)}) {
    const TickOutput out = tick(setup, at(p), state);
    EXPECT_FALSE(out.finite);
    EXPECT_EQ(out.force.norm(), 0);
  }
  const TickOutput out = tick(setup, at(Vec3(0, 92, 0)), state);
  EXPECT_TRUE(out.finite);
  EXPECT_LT(out.force.norm(), 0.1) << "soft start";
}

TEST(Tick, HugePositionsAreFreeSpace) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 90, 2));
  const TickSetup setup = make_tick_setup(model, unlimited());
  TickState state;
  for (const double r : {1e3, 1e6, 1e12, 1e100, 1e300})
    EXPECT_EQ(tick(setup, at(Vec3(0, r, r)), state).force.norm(), 0) << r;
}

// A hand that presses where it is soft, slides to where it is stiff and lets go there would gain
// energy with every round. The controller takes it out.
double energy_of_rounds(bool passivity) {
  const TouchableHead head = scenes::landscape(40, 40, 1, [](double, double) { return 0.0; });
  TouchableHead graded = head;
  for (std::size_t v = 0; v < head.skin.points.size(); ++v)
    for (std::size_t i = 0; i < 10; ++i)
      graded.map.displacement[v * 10 + i] *= head.skin.points[v].x() < 0 ? 2 : 0.5;
  const TouchModel model = make_touch_model(graded);
  TickOptions o = elastic_only();
  o.passivity = passivity;
  const TickSetup setup = make_tick_setup(model, unlimited(), o);
  TickState state;
  Vec3 p(-20, 0, 6);
  Vec3 force = Vec3::Zero();
  double taken = 0;
  const auto go = [&](const Vec3& to) {
    const int steps = static_cast<int>((to - p).norm() / 0.05) + 1;
    const Vec3 from = p;
    for (int i = 1; i <= steps; ++i) {
      const Vec3 next = from + (to - from) * i / steps;
      taken -= force.dot(next - p);
      p = next;
      force = tick(setup, at(p), state).force;
    }
  };
  for (int round = 0; round < 5; ++round) {
    go(Vec3(-20, 0, 3));
    go(Vec3(20, 0, 3));
    go(Vec3(20, 0, 6));
    go(Vec3(-20, 0, 6));
  }
  return taken;
}

TEST(Tick, PassivityControllerStopsTheEnergyPump) {
  EXPECT_LT(energy_of_rounds(false), -5 * 2.0);
  EXPECT_GT(energy_of_rounds(true), -0.05);
}

TEST(TouchModel, HeadsOfNoSizeAreRefused) {
  TouchableHead far = scenes::even_sphere(5, 90, 2);
  far.skin.points[7].y() = 1e30;
  TouchableHead tiny = scenes::even_sphere(5, 90, 2);
  tiny.unit_mm = 1e-6;
  try {
    (void)make_touch_model(far);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("vertex 7"), std::string::npos);
  }
  EXPECT_THROW((void)make_touch_model(tiny), InputError);
}

TEST(Tick, OptionsOutOfRangeAreNamed) {
  const TouchModel model = make_touch_model(scenes::even_sphere(10, 90, 2));
  TickOptions o;
  o.kinetic_friction = 0.9;
  try {
    (void)make_tick_setup(model, unlimited(), o);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("kinetic friction"), std::string::npos);
  }
}

}  // namespace
}  // namespace palpate::haptics
