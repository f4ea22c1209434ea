// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/study_touch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>

#include "core/error.hpp"

namespace palpate::app {
using haptics::TouchModel;
using study::HapticSample;
using study::StudyRegion;

haptics::Workspace pose_of(const StudyRegion& region, const haptics::DeviceInfo& device) {
  return haptics::aimed_at(region.point, region.normal, device);
}

namespace {

constexpr double kForce = 2;        // [N] of the stiffness that tables and studies give
constexpr double kReach = 40 * 40;  // [mm^2] of the nearest skin, squared

SkinRegion region_named(const std::string& name) {
  const auto at = std::find(kSkinRegionNames.begin(), kSkinRegionNames.end(), name);
  return static_cast<SkinRegion>(at - kSkinRegionNames.begin());
}

/// 2 N / u(2 N) of the blended curve at a point of the skin; the curve ascends.
double stiffness_at(const TouchModel& model, const haptics::SurfacePoint& at) {
  const auto& corners = model.mesh.triangles[static_cast<std::size_t>(at.triangle)];
  double low = 0, high = 100;  // [mm]
  for (int i = 0; i < 60; ++i) {
    const double middle = 0.5 * (low + high);
    const double force = model.curves.blend_force(corners, at.on.barycentric, middle).force;
    (force < kForce ? low : high) = middle;
  }
  return kForce / high;
}

}  // namespace

std::vector<StudyRegion> study_regions(const TouchModel& model,
                                       const std::vector<std::string>& names) {
  const auto medians = haptics::region_stiffness(model);
  std::vector<StudyRegion> all;
  for (const std::string& name : names) {
    const SkinRegion region = region_named(name);
    const haptics::Workspace aim = haptics::aimed_at(model, region, haptics::DeviceInfo{});
    StudyRegion r;
    r.name = name;
    r.stiffness = medians[static_cast<std::size_t>(region)];
    r.point = aim.at_head;
    r.normal = aim.rotation.col(2);
    const haptics::SurfacePoint at = model.mesh.nearest(r.point, kReach);
    if (!at.found() || !(r.stiffness > 0))
      throw InputError(fmt::format("this head has no stiffness in its region {}", name));
    r.stiffness_at_point = stiffness_at(model, at);
    all.push_back(std::move(r));
  }
  return all;
}

haptics::TickSetup study_setup(const TouchModel& model, const haptics::DeviceLimits& limits,
                               const haptics::TickOptions& options, double factor, double largest) {
  haptics::DeviceLimits room = limits;
  room.peak_force /= largest;
  room.stiffness /= largest;
  haptics::TickSetup setup = haptics::make_tick_setup(model, room, options);
  setup.limits = limits;
  setup.scale *= factor;
  return setup;
}

double largest_factor(const study::Protocol& protocol, const std::string& part) {
  for (const study::Part& p : protocol.parts)
    if (p.id == part && p.kind == study::PartKind::discrimination) return 1 + p.staircase.most;
  return 1;
}

std::vector<haptics::Waypoint> probing(const haptics::DeviceInfo& device, double tool_radius,
                                       double seconds, double force, double hand_stiffness) {
  const double deeper = force / hand_stiffness;  // [mm] below the skin that the hand aims at
  const auto at = [&](double x, double height) {
    return Vec3(device.center + Vec3(x, 0, tool_radius + height));
  };
  std::vector<haptics::Waypoint> path{{0, at(0, 25)}};
  double time = 0;
  const auto go = [&](double duration, const Vec3& where) {
    time += duration;
    path.push_back({time, where});
  };
  go(0.5, at(0, 3));
  for (int i = 0; time < seconds; ++i) {
    const double x = 2.0 * (i % 3 - 1);  // a little to each side of the place
    go(0.5, at(x, -deeper));
    go(0.6, at(x, -deeper));
    go(0.4, at(0, 3));
  }
  go(0.5, at(0, 25));
  return path;
}

// --- live

/// Between the loop and the device: notes where the hand is and what it gets.
class StudyTouch::Tap final : public haptics::Device {
 public:
  struct Tick {
    std::int64_t time_ns = 0;
    Vec3 position = Vec3::Zero(), force = Vec3::Zero();  // user's axes
  };
  explicit Tap(haptics::Device& device) : device_(device) {}

  [[nodiscard]] const haptics::DeviceInfo& info() const override { return device_.info(); }
  [[nodiscard]] haptics::DeviceStatus read(haptics::DeviceSample& sample) noexcept override {
    const haptics::DeviceStatus status = device_.read(sample);
    if (status == haptics::DeviceStatus::ok) position_ = sample.position;
    seen_ = seen_ || status == haptics::DeviceStatus::ok;
    return status;
  }
  haptics::DeviceStatus write(const Vec3& force) noexcept override {
    const auto now = std::chrono::steady_clock::now().time_since_epoch();
    const std::int64_t ns = std::chrono::duration_cast<std::chrono::nanoseconds>(now).count();
    if (seen_ && !ticks.push({ns, position_, force}))
      dropped.fetch_add(1, std::memory_order_relaxed);
    return device_.write(force);
  }
  void release() noexcept override { device_.release(); }
  [[nodiscard]] std::string trouble() const override { return device_.trouble(); }

  haptics::SpscQueue<Tick, 8192> ticks;  // 8 s
  std::atomic<std::uint64_t> dropped{0};

 private:
  haptics::Device& device_;
  Vec3 position_ = Vec3::Zero();
  bool seen_ = false;
};

StudyTouch::StudyTouch(const TouchModel& model, haptics::Device& device, double rate_hz,
                       int priority)
    : model_(model),
      device_(device),
      rate_hz_(rate_hz),
      priority_(priority),
      tap_(std::make_unique<Tap>(device)) {}

StudyTouch::~StudyTouch() {
  end();
}

void StudyTouch::begin(const StudyRegion& region, const study::Screen& screen, double largest) {
  end();
  (void)drain();
  pose_ = pose_of(region, device_.info());
  setup_ = study_setup(model_, device_.info().limits, {}, screen.factor, largest);
  haptics::CycleOptions options;
  options.clutch_button = -1;  // a trial's place stays where it is
  cycle_ = std::make_unique<haptics::TouchCycle>(setup_, *tap_, pose_, options);
  haptics::LoopOptions loop;
  loop.rate_hz = rate_hz_;
  loop.priority = priority_;
  loop_ = std::make_unique<haptics::TouchLoop>(*cycle_, loop);
  loop_->start();
}

void StudyTouch::end() {
  if (!loop_) return;
  loop_->stop();
  loop_.reset();
  cycle_.reset();
}

void StudyTouch::pause(bool on) {
  if (cycle_) cycle_->pause(on);
}

std::vector<HapticSample> StudyTouch::drain() {
  std::vector<HapticSample> all;
  Tap::Tick tick;
  std::int64_t last = -1;
  while (tap_->ticks.pop(tick)) {
    HapticSample s;
    s.time_us = std::max(tick.time_ns / 1000, last + 1);
    last = s.time_us;
    s.position = pose_.to_head(tick.position);
    s.force = pose_.rotation * tick.force;
    s.contact = tick.force != Vec3::Zero();
    const haptics::SurfacePoint at = model_.mesh.nearest(s.position, kReach);
    if (at.found()) s.region = static_cast<std::uint8_t>(model_.region_at(at));
    all.push_back(s);
  }
  return all;
}

std::uint64_t StudyTouch::dropped() const {
  return tap_->dropped.load(std::memory_order_relaxed);
}

haptics::CycleSnapshot StudyTouch::latest() const {
  return cycle_ ? cycle_->latest() : haptics::CycleSnapshot{};
}

}  // namespace palpate::app
