// SPDX-License-Identifier: GPL-3.0-or-later
// Time of one tick in contact, 5 mm tool sliding at 100 mm/s and 3 mm depth over bumpy heads,
// beside an empty tick timed the same way; and the change of the force from tick to tick.
//   bench_tick [ticks] : one line per head, in microseconds
#include <fmt/core.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "haptics/scenes.hpp"
#include "haptics/tick.hpp"

namespace {

using palpate::Vec3;
using namespace palpate::haptics;

struct Times {
  double median, p999, longest;
};

Times summary(std::vector<double>& us) {
  std::sort(us.begin(), us.end());
  return {us[us.size() / 2], us[us.size() - us.size() / 1000 - 1], us.back()};
}

// A spiral from pole to pole on the head's ellipsoid, `step` mm apart.
std::vector<Vec3> spiral(std::size_t count, double step) {
  std::vector<Vec3> directions;
  double polar = 0.3, azimuth = 0;
  for (std::size_t i = 0; i < count; ++i) {
    directions.emplace_back(std::sin(polar) * std::cos(azimuth), std::cos(polar),
                            std::sin(polar) * std::sin(azimuth));
    azimuth += step / (90 * std::sin(polar));
    polar += 2.5 / static_cast<double>(count);
  }
  return directions;
}

// Tool centres that keep the depth against the model, found by projecting onto its surface.
std::vector<Vec3> slide(const TouchModel& model, std::size_t count, double step, double depth) {
  std::vector<Vec3> path;
  SurfacePoint near;
  for (const Vec3& d : spiral(count, step)) {
    Vec3 p(75 * d.x(), 110 * d.y(), 95 * d.z());
    for (int k = 0; k < 6; ++k) {
      near = model.mesh.nearest(p, 1e300);
      p = near.on.point + (model.tool_radius - depth) * model.mesh.blended_normal(near);
    }
    path.push_back(p);
  }
  return path;
}

void run(int n, std::size_t ticks) {
  const auto head = scenes::bumpy_head(n);
  const auto t0 = std::chrono::steady_clock::now();
  const TouchModel model = make_touch_model(head);
  const double load = std::chrono::duration<double>(std::chrono::steady_clock::now() - t0).count();
  const TickSetup setup = make_tick_setup(model, *limits_of("falcon"));
  const std::vector<Vec3> path = slide(model, ticks, 0.1, 3);

  std::vector<double> touch, empty;
  TickState state;
  double sum = 0;
  for (const Vec3& p : path) {
    const TickInput input{p, Vec3::Zero(), 0.001, false, false};
    const auto a = std::chrono::steady_clock::now();
    const TickOutput out = tick(setup, input, state);
    const auto b = std::chrono::steady_clock::now();
    sum += out.force.x();
    const auto c = std::chrono::steady_clock::now();
    touch.push_back(std::chrono::duration<double, std::micro>(b - a).count());
    empty.push_back(std::chrono::duration<double, std::micro>(c - b).count());
  }
  const Times t = summary(touch), e = summary(empty);
  fmt::print(
      "{:8} triangles  tick median {:.2f}  99.9 % {:.2f}  longest {:.1f}   empty {:.2f}  {:.2f}  "
      "{:.1f}"
      "   load {:.2f} s  ({:.3f})\n",
      model.mesh.triangles.size(), t.median, t.p999, t.longest, e.median, e.p999, e.longest, load,
      sum);
}

}  // namespace

int main(int argc, char** argv) {
  const std::size_t ticks = argc > 1 ? std::strtoul(argv[1], nullptr, 10) : 100000;
  for (const int n : {50, 112, 354}) run(n, ticks);
}
