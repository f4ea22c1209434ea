// SPDX-License-Identifier: GPL-3.0-or-later
// Commands, state and the pointer, driven tick by tick without a thread.
#include <gtest/gtest.h>

#include <cstring>
#include <limits>

#include "scene.hpp"

namespace palpate::serve {
namespace {

Command press(const Vec3& point, double depth, bool begin) {
  Command c;
  c.kind = Command::Kind::press;
  c.point = point;
  c.depth = depth;
  c.begin = begin;
  return c;
}

TEST(Protocol, CommandsComeBackAndNothingElseIsOne) {
  const Command c = press({1.5, -2, 70}, 3.25, true);
  const auto back = parse_command(command_bytes(c));
  ASSERT_TRUE(back);
  EXPECT_EQ(back->point, c.point);
  EXPECT_EQ(back->depth, c.depth);
  EXPECT_TRUE(back->begin);
  const std::string good = command_bytes(c);
  for (std::size_t n = 0; n < good.size(); ++n) EXPECT_FALSE(parse_command(good.substr(0, n))) << n;
  EXPECT_FALSE(parse_command(good + '\0'));
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(),
                           std::numeric_limits<double>::infinity(), 1e9, -2001.0})
    for (const std::size_t at : {8, 16, 24, 32}) {
      std::string broken = good;
      std::memcpy(broken.data() + at, &bad, sizeof bad);
      EXPECT_FALSE(parse_command(broken)) << bad << " at " << at;
    }
  Command aim;
  aim.kind = Command::Kind::aim;
  aim.region = SkinRegion::chin;
  EXPECT_EQ(parse_command(command_bytes(aim))->region, SkinRegion::chin);
  std::string no_region = command_bytes(aim);
  no_region[4] = 99;
  EXPECT_FALSE(parse_command(no_region));
  std::string no_kind = command_bytes(aim);
  no_kind[0] = 0;
  EXPECT_FALSE(parse_command(no_kind));
}

class Live : public testing::Test {
 protected:
  Scene s_;
  std::int64_t now_ = 1;
  void run(int ticks) {
    for (int i = 0; i < ticks; ++i) s_.cycle.advance(now_ += 1'000'000, 0);
  }
  haptics::TickOutput out() { return s_.cycle.latest().out; }
};

TEST_F(Live, APressGivesTheMapsForceAtTheDepth) {
  for (const Vec3& at : {Vec3(0, 0, 95), Vec3(75, 0, 0), Vec3(0, 110, 0), Vec3(-40, -50, 70)}) {
    for (const double depth : {0.5, 2.0, 5.0}) {
      s_.live.apply(press(at, depth, true), 1);
      run(1500);
      const auto place = press_place(s_.model, at);
      ASSERT_TRUE(place);
      EXPECT_LT((s_.cycle.latest().tool - place->center(5, depth)).norm(), 1e-9);
      ASSERT_TRUE(out().in_contact);
      EXPECT_NEAR(out().depth, depth, 0.05);
      Triangle corners;
      for (int k = 0; k < 3; ++k)
        corners[k] = s_.model.mesh.vertex_of[static_cast<std::size_t>(out().vertices[k])];
      EXPECT_NEAR(out().map_force,
                  s_.model.curves.blend_force(corners, out().weights, out().depth).force, 1e-6);
      EXPECT_EQ(s_.cycle.latest().trip, haptics::Trip::none);
    }
  }
}

TEST_F(Live, TheToolNeverCrossesTheHeadOnItsWayToANewPlace) {
  s_.live.apply(press(Vec3(75, 0, 0), 4, true), 1);
  run(1000);
  s_.live.apply(press(Vec3(-75, 0, 0), 0.5, true), 1);
  double most = 0;
  for (int i = 0; i < 1000; ++i) {
    run(1);
    most = std::max(most, out().in_contact ? out().depth : 0);
    EXPECT_LT(s_.cycle.latest().tool.x(), 0);
  }
  EXPECT_LT(most, 0.6);
}

TEST_F(Live, LiftsWhenAskedWhenThePageGoesAndWhenItIsSilent) {
  s_.live.apply(press(Vec3(0, 0, 95), 3, true), 7);
  run(1000);
  ASSERT_TRUE(out().in_contact);
  Command lift;
  s_.live.apply(lift, 8);  // somebody else
  run(500);
  EXPECT_TRUE(out().in_contact);
  s_.live.apply(lift, 7);
  run(500);
  EXPECT_FALSE(out().in_contact);
  s_.live.apply(press(Vec3(0, 0, 95), 3, true), 7);
  run(500);
  ASSERT_TRUE(out().in_contact);
  s_.live.forget(7);
  run(500);
  EXPECT_FALSE(out().in_contact);
}

TEST_F(Live, ATouchBelongsToWhoBeganIt) {
  s_.live.apply(press(Vec3(0, 0, 95), 3, true), 1);
  s_.live.apply(press(Vec3(0, 0, 95), 9, false), 2);
  run(1000);
  EXPECT_NEAR(out().depth, 3, 0.05);
  s_.live.apply(press(Vec3(0, 0, 95), 1, true), 2);
  s_.live.apply(press(Vec3(0, 0, 95), 9, false), 1);
  run(1000);
  EXPECT_NEAR(out().depth, 1, 0.05);
}

TEST_F(Live, AClickBesideTheHeadIsNone) {
  s_.live.apply(press(Vec3(500, 500, 500), 3, true), 1);
  run(200);
  EXPECT_FALSE(out().in_contact);
}

TEST_F(Live, StateHoldsWhatTheTickSays) {
  s_.live.apply(press(Vec3(0, 0, 95), 3, true), 1);
  run(1000);
  const std::string bytes = s_.live.state();
  ASSERT_EQ(bytes.size(), 16U + 8 * 90);
  EXPECT_EQ(bytes.substr(0, 4), "PLST");
  const auto number = [&](std::size_t i) {
    double x = 0;
    std::memcpy(&x, bytes.data() + 16 + 8 * i, sizeof x);
    return x;
  };
  EXPECT_EQ(number(14), out().depth);
  EXPECT_EQ(number(15), out().map_force);
  EXPECT_EQ(number(7), out().force.z());
  EXPECT_EQ(number(26), 17) << "in contact, finite";
  EXPECT_GE(number(48), out().depth);
  // The curve passes through the working point.
  const double step = number(48) / (kCurveSamples - 1);
  const auto i = static_cast<std::size_t>(number(14) / step);
  EXPECT_LE(number(49 + i), number(15) + 1e-12);
  EXPECT_GE(number(50 + i), number(15) - 1e-12);
}

TEST_F(Live, HelloTellsTheRegionToLookAtFirst) {
  EXPECT_TRUE(s_.live.hello()["look_at"].is_null());
  LiveFacts facts;
  facts.look_at = SkinRegion::cheek;
  const LiveTouch other(s_.cycle, s_.loop, nullptr, nullptr, facts);
  EXPECT_EQ(other.hello()["look_at"], static_cast<int>(SkinRegion::cheek));
}

TEST_F(Live, PauseZeroesTheForce) {
  s_.live.apply(press(Vec3(0, 0, 95), 3, true), 1);
  run(1000);
  Command pause;
  pause.kind = Command::Kind::pause;
  pause.on = true;
  s_.live.apply(pause, 1);
  run(5);
  EXPECT_EQ(out().force.norm(), 0);
}

}  // namespace
}  // namespace palpate::serve
