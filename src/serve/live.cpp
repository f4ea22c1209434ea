// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/live.hpp"

#include <algorithm>

#include <fmt/format.h>

#include "core/error.hpp"
#include "core/version.hpp"
#include "haptics/realtime.hpp"
#include "plot/color_map.hpp"

namespace palpate::serve {

using haptics::TouchModel;
using nlohmann::json;

namespace {

constexpr double kFarPick = 20;                   // [mm] a click beside the head is none
constexpr double kHover = 4;                      // [mm] between lifted tool and skin
constexpr std::int64_t kSilence = 3'000'000'000;  // [ns]

json regions_of(const TouchModel& model) {
  const auto stiffness = haptics::region_stiffness(model);
  json all = json::array();
  for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r) {
    const auto count =
        std::count(model.region.begin(), model.region.end(), static_cast<SkinRegion>(r));
    if (count == 0) continue;
    all.push_back({{"code", r}, {"name", kSkinRegionNames[r]}, {"stiffness", stiffness[r]}});
  }
  return all;
}

/// The compared regions as in the report, the others in shades that stay behind them.
std::string region_color(SkinRegion region) {
  for (std::size_t i = 0; i < kPublishedOrder.size(); ++i)
    if (kPublishedOrder[i] == region) return plot::hex(plot::category_color(i));
  switch (region) {
    case SkinRegion::eye:
      return "#8fa3b8";
    case SkinRegion::nose:
      return "#b9a79a";
    case SkinRegion::lips:
      return "#a98a93";
    case SkinRegion::ear:
      return "#9aa894";
    case SkinRegion::neck:
      return "#b3b3a6";
    default:
      return plot::hex(plot::missing_color());
  }
}

json colors() {
  constexpr int kSteps = 64;
  json scale = json::array(), regions = json::array();
  for (int i = 0; i < kSteps; ++i)
    scale.push_back(plot::hex(plot::sequential_color(static_cast<double>(i) / (kSteps - 1))));
  for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r)
    regions.push_back(region_color(static_cast<SkinRegion>(r)));
  return {
      {"sequential", scale}, {"missing", plot::hex(plot::missing_color())}, {"regions", regions}};
}

}  // namespace

std::optional<PressPlace> press_place(const TouchModel& model, const Vec3& picked) {
  const haptics::SurfacePoint at = model.mesh.nearest(picked, kFarPick * kFarPick);
  if (!at.found()) return {};
  return PressPlace{at.on.point, model.mesh.blended_normal(at)};
}

TouchedCurve touched_curve(const TouchModel& model, const haptics::TickOutput& out) {
  TouchedCurve curve;
  if (!out.in_contact || out.vertices[0] < 0) return curve;
  Triangle corners;
  const std::size_t last = model.curves.knots - 1;
  for (int k = 0; k < 3; ++k) {
    const auto row = model.mesh.vertex_of[static_cast<std::size_t>(out.vertices[k])];
    corners[k] = row;
    curve.deepest += out.weights[k] *
                     model.curves.travel[static_cast<std::size_t>(row) * model.curves.knots + last];
  }
  curve.deepest = std::max(1.2 * curve.deepest, out.depth);
  for (std::size_t i = 0; i < kCurveSamples; ++i) {
    const double depth = curve.deepest * static_cast<double>(i) / (kCurveSamples - 1);
    curve.force[i] = model.curves.blend_force(corners, out.weights, depth).force;
  }
  return curve;
}

LiveTouch::LiveTouch(haptics::TouchCycle& cycle, const haptics::TouchLoop& loop,
                     PointerDevice* pointer, const haptics::Recorder* recorder, LiveFacts facts)
    : cycle_(cycle),
      loop_(loop),
      pointer_(pointer),
      recorder_(recorder),
      facts_(std::move(facts)),
      regions_(regions_of(*cycle.setup().model)) {
  if (!pointer_) return;
  workspace_ = haptics::facing(*cycle_.setup().model, pointer_->info());
  pointer_->begin(Vec3::Zero(), Vec3::Zero());
  cycle_.set_workspace(workspace_);
}

json LiveTouch::hello() const {
  const haptics::TickSetup& setup = cycle_.setup();
  const haptics::DeviceInfo& device = cycle_.device().info();
  json names = json::array(), trips = json::array();
  for (const auto n : kSkinRegionNames) names.push_back(n);
  for (const auto n : haptics::kTripNames) trips.push_back(n);
  return {{"type", "hello"},
          {"protocol", kLiveVersion},
          {"version", kVersion},
          {"head", facts_.head_name},
          {"pointer", pointer_ != nullptr},
          {"device",
           {{"backend", device.backend},
            {"name", device.name},
            {"serial", device.serial},
            {"peak_n", device.limits.peak_force},
            {"stiffness_n_mm", device.limits.stiffness}}},
          {"tool_radius_mm", setup.model->tool_radius},
          {"map_radius_mm", setup.model->map_radius},
          {"scale", setup.scale},
          {"reshaped", setup.reshaped},
          {"region_names", names},
          {"trip_names", trips},
          {"regions", regions_},
          {"colors", colors()},
          {"fingerprint", fmt::format("{:016x}", setup.model->fingerprint)},
          {"recording", facts_.recording},
          {"look_at", facts_.look_at ? json(static_cast<int>(*facts_.look_at)) : json()},
          {"warnings", facts_.warnings}};
}

json LiveTouch::health() const {
  const haptics::LoopReport r = loop_.report();
  json trips = json::object();
  for (std::size_t i = 1; i < r.trips.size(); ++i)
    trips[std::string(haptics::kTripNames[i])] = r.trips[i];
  json out = {{"type", "health"},
              {"rate_hz", r.rate_hz},
              {"ticks", r.ticks},
              {"skipped", r.skipped},
              {"late_median_us", r.late_median_us},
              {"late_p999_us", r.late_p999_us},
              {"late_longest_us", r.late_longest_us},
              {"late_above_1ms", r.late_above_1ms},
              {"tick_median_us", r.tick_median_us},
              {"tick_p999_us", r.tick_p999_us},
              {"tick_longest_us", r.tick_longest_us},
              {"guarded", r.guarded},
              {"passivity_removed_n_mm", r.removed},
              {"trips", trips},
              {"warnings", pointer_ ? json::array() : json(r.warnings)},  // a mouse needs no rights
              {"device", haptics::name(cycle_.latest().device)},
              {"trouble", cycle_.device().trouble()}};
  if (recorder_)
    out["recorder"] = {{"written", recorder_->written()},
                       {"dropped", recorder_->dropped()},
                       {"error", recorder_->error()}};
  return out;
}

std::string LiveTouch::state() const {
  const haptics::CycleSnapshot now = cycle_.latest();
  return state_bytes(now, touched_curve(*cycle_.setup().model, now.out));
}

Vec3 LiveTouch::to_user(const Vec3& head) const {
  return workspace_.rotation.transpose() * (head - workspace_.at_head) + workspace_.at_user;
}

void LiveTouch::press(const Command& c, std::uint64_t client) {
  // A page that was silent for so long that its touch was lifted takes it up again.
  const bool begin = c.begin || owner_ == 0;
  if (!pointer_ || (!begin && owner_ != client)) return;
  const TouchModel& model = *cycle_.setup().model;
  const auto place = press_place(model, c.point);
  if (!place) return;
  place_ = *place;
  heard_ns_ = haptics::monotonic_ns();
  const double radius = model.tool_radius;
  if (!begin) {
    pointer_->move_to(to_user(place_.center(radius, c.depth)));
    return;
  }
  // Every touch begins in the air above its point, with a workspace of its own.
  owner_ = client;
  workspace_ = haptics::aimed_at(place_.point, place_.normal, pointer_->info());
  pointer_->begin(to_user(place_.center(radius, -kHover)), to_user(place_.center(radius, c.depth)));
  cycle_.set_workspace(workspace_);
}

void LiveTouch::lift() {
  if (owner_ == 0) return;
  owner_ = 0;
  pointer_->move_to(to_user(place_.center(cycle_.setup().model->tool_radius, -kHover)));
}

void LiveTouch::apply(const Command& c, std::uint64_t client) {
  switch (c.kind) {
    case Command::Kind::press:
      return press(c, client);
    case Command::Kind::lift:
      if (owner_ == client) lift();
      return;
    case Command::Kind::pause:
      return cycle_.pause(c.on);
    case Command::Kind::aim:
      if (pointer_) return;  // the page turns its own camera
      try {
        cycle_.set_workspace(haptics::aimed_at(*cycle_.setup().model, c.region,
                                               cycle_.device().info(),
                                               cycle_.latest().workspace.scale));
      } catch (const InputError&) {
        // A region that this head has not: the head stays as it is.
      }
      return;
  }
}

void LiveTouch::forget(std::uint64_t client) {
  if (owner_ == client) lift();
}

void LiveTouch::keep() {
  if (owner_ != 0 && haptics::monotonic_ns() - heard_ns_ > kSilence) lift();
}

}  // namespace palpate::serve
