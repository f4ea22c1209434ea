// SPDX-License-Identifier: Apache-2.0
// The proxy: nearest point everywhere, nothing pops through, no jump in a crease.
#include "haptics/contact.hpp"

#include <gtest/gtest.h>

#include "haptics/crease.hpp"
#include "haptics/touch_model.hpp"
#include "scenes.hpp"

namespace palpate::haptics {
namespace {

SurfacePoint brute_force(const ContactMesh& mesh, const Vec3& p) {
  SurfacePoint best;
  for (std::int32_t t = 0; t < static_cast<std::int32_t>(mesh.triangles.size()); ++t) {
    const SurfacePoint s = mesh.measure(t, p);
    if (s.distance2 < best.distance2) best = s;
  }
  return best;
}

Vec3 random_direction(std::mt19937& rng) {
  std::normal_distribution<double> normal;
  return Vec3(normal(rng), normal(rng), normal(rng)).normalized();
}

TEST(Nearest, AgreesWithBruteForceFromAnyStart) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(20));
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> radius(0, 200);
  SurfacePoint start;
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p = radius(rng) * random_direction(rng);
    const SurfacePoint expected = brute_force(model.mesh, p);
    const SurfacePoint cold = model.mesh.nearest(p, 1e300);
    const SurfacePoint warm =
        model.mesh.nearest(p, 1e300, start.found() ? model.mesh.descend(p, start) : start);
    ASSERT_EQ(cold.distance2, expected.distance2) << i;
    ASSERT_EQ(warm.distance2, expected.distance2) << i;
    ASSERT_EQ(warm.triangle, cold.triangle) << i;
    start = warm;
  }
}

TEST(Nearest, NothingWithinTheRadiusIsNothing) {
  const TouchModel model = make_touch_model(scenes::even_sphere(10, 100, 1));
  EXPECT_FALSE(model.mesh.nearest(Vec3(0, 0, 120), 15 * 15).found());
  EXPECT_TRUE(model.mesh.nearest(Vec3(0, 0, 120), 21 * 21).found());
}

TEST(ContactMesh, WeldsSeamsAndTurnsTrianglesOutwards) {
  TouchableHead head = scenes::even_sphere(6, 100, 1);
  // Cut every triangle loose and turn every third one round.
  SurfaceMesh loose;
  StiffnessMap map = head.map;
  map.displacement.clear();
  for (std::size_t t = 0; t < head.skin.triangles.size(); ++t) {
    Triangle corners = head.skin.triangles[t];
    if (t % 3 == 0) std::swap(corners[1], corners[2]);
    const auto first = static_cast<std::int32_t>(loose.points.size());
    for (const std::int32_t v : corners) loose.points.push_back(head.skin.points[v]);
    loose.triangles.push_back({first, first + 1, first + 2});
  }
  const ContactMesh mesh = make_contact_mesh(loose);
  EXPECT_EQ(mesh.points.size(), head.skin.points.size());
  EXPECT_EQ(mesh.border_edges, 0U);
  EXPECT_GT(signed_volume({mesh.points, mesh.triangles}), 0);
  for (std::size_t p = 0; p < mesh.points.size(); ++p)
    EXPECT_GT(mesh.normals[p].dot(mesh.points[p].normalized()), 0.99);
}

// From outside and inside a convex head the depth is the one of the method: R minus the signed
// distance to the nearest point.
TEST(Contact, DepthIsRadiusMinusSignedDistance) {
  const TouchModel model = make_touch_model(scenes::bumpy_head(40, 0.0));
  std::mt19937 rng(2);
  std::uniform_real_distribution<double> depth(0.1, 12);
  for (int i = 0; i < 300; ++i) {
    const Vec3 away = random_direction(rng);
    const SurfacePoint below = brute_force(model.mesh, 60 * away);
    const Vec3 n = model.mesh.blended_normal(below);
    ProxyState state;
    const double target = depth(rng);
    for (int step = 0; step <= 60; ++step) {
      const Vec3 center = below.on.point + (5.5 - (target + 0.5) * step / 60) * n;
      const Contact contact = find_contact(model.mesh, 5, center, state);
      const SurfacePoint nearest = brute_force(model.mesh, center);
      const double side = model.mesh.side_normal(nearest).dot(center - nearest.on.point);
      const double expected = 5 - std::copysign(std::sqrt(nearest.distance2), side);
      if (expected <= 0) {
        ASSERT_EQ(contact.count, 0);
        continue;
      }
      ASSERT_EQ(contact.count, 1);
      ASSERT_NEAR(contact.depth, expected, 1e-9);
      ASSERT_FALSE(contact.from_inside);
    }
  }
}

// A plate 2 mm thick, thinner than the tool: an ear.
class Plate : public testing::Test {
 protected:
  // Both faces of a slab |z| < 1 with |x|, |y| < 40, as a flattened box.
  static TouchableHead make() {
    TouchableHead head = scenes::landscape(
        40, 40, 1, [](double, double) { return 1.0; }, false);
    for (Vec3& p : head.skin.points)
      if (p.z() < 0) p.z() = -1;
    return head;
  }
  TouchModel model_ = make_touch_model(make());
};

TEST_F(Plate, ToolPressedThroughStaysOnItsSide) {
  ProxyState state;
  for (double z = 8; z > -30; z -= 0.05) {
    const Contact contact = find_contact(model_.mesh, 5, Vec3(3.3, 4.1, z), state);
    if (z < 5.9) {
      ASSERT_EQ(contact.count, 1) << z;
      ASSERT_NEAR(contact.depth, 6 - z, 1e-9);
      ASSERT_GT(contact.normal.z(), 0.9);
    }
  }
}

TEST_F(Plate, OneHugeStepThroughIsCaughtOnTheNearSide) {
  for (const double z0 : {7.0, 20.0, 300.0}) {
    ProxyState state;
    EXPECT_EQ(find_contact(model_.mesh, 5, Vec3(3.3, 4.1, z0), state).count, 0);
    const Contact contact = find_contact(model_.mesh, 5, Vec3(3.4, 4.0, -20), state);
    ASSERT_EQ(contact.count, 1);
    EXPECT_NEAR(contact.depth, 26, 1e-9);
    EXPECT_GT(contact.normal.z(), 0.9);
    EXPECT_FALSE(contact.from_inside);
  }
}

TEST_F(Plate, SlidingOverTheRimLetsGoOnTheOtherSide) {
  ProxyState state;
  Contact contact;
  for (double z = 8; z > 2; z -= 0.05)
    contact = find_contact(model_.mesh, 5, Vec3(30, 0, z), state);
  for (double x = 30; x < 50; x += 0.05)
    contact = find_contact(model_.mesh, 5, Vec3(x, 0, 2), state);
  EXPECT_EQ(contact.count, 0);
  for (double z = 2; z > -20; z -= 0.05)
    contact = find_contact(model_.mesh, 5, Vec3(50, 0, z), state);
  for (double x = 50; x > 10; x -= 0.05)
    contact = find_contact(model_.mesh, 5, Vec3(x, 0, -20), state);
  EXPECT_EQ(contact.count, 0);
  for (double z = -20; z < -3; z += 0.05)
    contact = find_contact(model_.mesh, 5, Vec3(10, 0, z), state);
  ASSERT_EQ(contact.count, 1);
  EXPECT_LT(contact.normal.z(), -0.9);
}

// 80 km/h glitch across a whole head, and back.
TEST(Contact, AFastMoveAcrossTheHeadStopsWhereItEnters) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 100, 1));
  ProxyState state;
  EXPECT_EQ(find_contact(model.mesh, 5, Vec3(0, 130, 0), state).count, 0);
  Contact contact = find_contact(model.mesh, 5, Vec3(1, 30, 0), state);
  ASSERT_EQ(contact.count, 1);
  EXPECT_GT(contact.normal.y(), 0.9);
  contact = find_contact(model.mesh, 5, Vec3(0, 130, 0), state);
  EXPECT_EQ(contact.count, 0);
}

// A V-shaped groove: across its bottom the nearest point jumps, the push must not.
TEST(Contact, PushIsContinuousAcrossACrease) {
  for (const double slope : {0.3, 0.6, 1.0, 1.7}) {
    const TouchModel model = make_touch_model(scenes::landscape(
        30, 60, 1, [&](double x, double) { return slope * std::abs(x - 0.013); }, false));
    ProxyState state;
    Vec3 previous = Vec3::Zero();
    const double bottom = 5 * std::sqrt(1 + slope * slope) - 2;  // 2 mm beyond touching both
    for (double z = bottom + 12; z > bottom; z -= 0.01)
      (void)find_contact(model.mesh, 5, Vec3(-3, 0.2, z), state);
    double largest = 0;
    for (double x = -3; x < 3; x += 0.01) {
      const Contact contact = find_contact(model.mesh, 5, Vec3(x, 0.2, bottom), state);
      ASSERT_GT(contact.count, 0);
      const Vec3 push = contact.depth * contact.normal;
      if (x > -3) largest = std::max(largest, (push - previous).norm());
      previous = push;
    }
    // Each flank alone turns the push by at most the step; the sum over both by a few steps.
    EXPECT_LT(largest, 0.08) << slope;
  }
}

TEST(Contact, SlotNarrowerThanTheToolPushesOut) {
  // Two walls facing each other, 6 mm apart, for a 10 mm ball.
  const TouchModel model = make_touch_model(scenes::landscape(
      30, 120, 1, [](double x, double) { return std::abs(x) < 2.9 ? -20.0 : 0.0; }, false));
  ProxyState state;
  Contact contact;
  for (double z = 8; z > 2; z -= 0.01) contact = find_contact(model.mesh, 5, Vec3(0, 0, z), state);
  ASSERT_GE(contact.count, 2);
  EXPECT_GT(contact.normal.z(), 0.98);
  EXPECT_NEAR(contact.depth, 2, 0.05);  // rests on both rims at a height of 4 mm
}

// The shortcut of a sliding contact must never hide a nearer point or a second flank: every tick of
// a random walk, in creases too, agrees with the answer found from nothing.
TEST(Contact, SlidingAgreesWithTheAnswerFromNothing) {
  const auto grooves = [](double x, double y) {
    return 3 * std::abs(std::sin(x / 4)) + 1.5 * std::abs(std::sin(y / 7));
  };
  const std::array<TouchableHead, 3> heads = {scenes::bumpy_head(40, 2.5),
                                              scenes::landscape(40, 150, 1, grooves, false),
                                              scenes::landscape(40, 40, 1, grooves, true)};
  for (const TouchableHead& head : heads) {
    const TouchModel model = make_touch_model(head);
    const Box box = model.mesh.tree.box();
    std::mt19937 rng(9);
    std::normal_distribution<double> normal;
    ProxyState state;
    Vec3 p = box.center() + Vec3(1, 2, 0.5 * box.size().z() + 8);
    int touching = 0, creases = 0;
    Vec3 drift = Vec3::UnitX();
    for (int i = 0; i < 20000; ++i) {
      const SurfacePoint near = model.mesh.nearest(p, 1e300);
      const Vec3 n = model.mesh.blended_normal(near);
      drift = (drift + 0.1 * Vec3(normal(rng), normal(rng), normal(rng))).normalized();
      p = near.on.point + (3 + 1.5 * std::sin(i * 0.01)) * n + 0.1 * (drift - n * n.dot(drift));
      if (std::abs(p.x()) > 35 || std::abs(p.y()) > 35) drift = (box.center() - p).normalized();
      const Contact contact = find_contact(model.mesh, 5, p, state);
      const SurfacePoint nearest = model.mesh.nearest(p, 1e300);
      if (nearest.distance2 >= 25 || model.mesh.side_normal(nearest).dot(p - nearest.on.point) < 0)
        continue;
      const Contact expected = rest_on_flanks(model.mesh, 5, p, nearest, false);
      ASSERT_EQ(contact.count, expected.count) << i;
      ASSERT_NEAR(contact.depth, expected.depth, 1e-9) << i;
      ASSERT_LT((contact.normal - expected.normal).norm(), 1e-6) << i;
      ++touching;
      creases += contact.count > 1;
    }
    EXPECT_GT(touching, 5000);
    std::printf("%d of 20000 in contact, %d in a crease\n", touching, creases);
  }
}

TEST(Contact, InsideAtTheStartIsKnownAsSuch) {
  const TouchModel model = make_touch_model(scenes::even_sphere(20, 100, 1));
  ProxyState state;
  const Contact contact = find_contact(model.mesh, 5, Vec3(0, 80, 0), state);
  ASSERT_EQ(contact.count, 1);
  EXPECT_TRUE(contact.from_inside);
  EXPECT_NEAR(contact.depth, 25, 0.5);
}

TEST(Contact, AnOpenScanIsFeltFromOutsideOnly) {
  const TouchModel model = make_touch_model(scenes::landscape(
      40, 40, 1, [](double, double) { return 0.0; }, true));
  EXPECT_GT(model.mesh.border_edges, 0U);
  ProxyState state;
  Contact contact = find_contact(model.mesh, 5, Vec3(0, 0, 30), state);
  for (double x = 0; x < 60; x += 0.5) (void)find_contact(model.mesh, 5, Vec3(x, 0, 30), state);
  for (double z = 30; z > -10; z -= 0.5) (void)find_contact(model.mesh, 5, Vec3(60, 0, z), state);
  for (double x = 60; x > 0; x -= 0.5)
    contact = find_contact(model.mesh, 5, Vec3(x, 0, -10), state);
  EXPECT_EQ(contact.count, 0);
  double z = -10;
  for (; z < 0.001 && contact.count == 0; z += 0.1)
    contact = find_contact(model.mesh, 5, Vec3(0, 0, z), state);
  contact = find_contact(model.mesh, 5, Vec3(0, 0, 0.1), state);
  ASSERT_EQ(contact.count, 1);
  EXPECT_TRUE(contact.from_inside);
}

}  // namespace
}  // namespace palpate::haptics
