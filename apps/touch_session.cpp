// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/touch_session.hpp"

#include "apps/touch_points.hpp"

#include <fmt/format.h>
#include <spawn.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <optional>
#include <thread>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "haptics/find_devices.hpp"
#include "haptics/loop.hpp"
#include "haptics/simulated_hand.hpp"
#include "io/head_file.hpp"
#include "serve/access.hpp"
#include "serve/server.hpp"

extern char** environ;  // for posix_spawnp

namespace palpate::app {
namespace fs = std::filesystem;
using haptics::Device;
using haptics::TouchModel;
using nlohmann::json;
using Say = std::function<void(const std::string&)>;

namespace {

constexpr int kUsualPort = 8733;

struct OpenedDevice {
  std::unique_ptr<Device> device;
  serve::PointerDevice* pointer = nullptr;  // the same object, where it is the pointer
};

OpenedDevice open_pointer(double rate_hz) {
  serve::PointerOptions options;
  options.rate_hz = rate_hz;
  auto pointer = std::make_unique<serve::PointerDevice>(options);
  serve::PointerDevice* raw = pointer.get();
  return {std::move(pointer), raw};
}

std::optional<SkinRegion> region_named(const std::string& name, const TouchModel& model) {
  if (name.empty()) return {};
  for (std::size_t r = 0; r < kSkinRegionNames.size(); ++r) {
    if (kSkinRegionNames[r] != name) continue;
    const auto region = static_cast<SkinRegion>(r);
    if (std::find(model.region.begin(), model.region.end(), region) == model.region.end())
      throw InputError(fmt::format("--region {}: this head has none", name));
    return region;
  }
  throw InputError(
      fmt::format("--region {}: there is no such region; one of cranium, forehead, "
                  "eyebrow, cheekbone, cheek, chin, jaw, eye, nose, lips, ear, neck",
                  name));
}

/// A hand that visits every region, again and again, or stays on one.
std::unique_ptr<Device> open_simulated(const TouchOptions& o, const TouchModel& model,
                                       std::optional<SkinRegion> region) {
  const std::string& spec = o.device;
  haptics::SimulatedHandOptions options;
  options.rate_hz = o.rate_hz;
  options.repeat = true;
  const std::size_t colon = spec.find(':');
  if (colon != std::string::npos) {
    const auto limits = haptics::limits_of(spec.substr(colon + 1));
    if (!limits)
      throw InputError(
          fmt::format("--device {}: no device of that name is in the table "
                      "(docs/method/touch.md); try simulated:falcon",
                      spec));
    options.limits = *limits;
  }
  constexpr double kForce = 2;  // [N] a probing finger's
  return std::make_unique<haptics::SimulatedHand>(
      region ? haptics::region_press(model, *region, kForce, options.stiffness)
             : haptics::region_tour(model, kForce, options.stiffness),
      options);
}

OpenedDevice open(const TouchOptions& o, const TouchModel& model, std::optional<SkinRegion> region,
                  const Say& say) {
  if (o.device == "pointer") return open_pointer(o.rate_hz);
  if (o.device.starts_with("simulated")) return {open_simulated(o, model, region)};
  try {
    return {haptics::open_device(o.device)};
  } catch (const InputError& error) {
    if (o.device != "auto") throw;
    say(fmt::format("{}", error.what()));
    say("touching with the mouse on the page instead");
    return open_pointer(o.rate_hz);
  }
}

/// The published study's clamp, unless the device itself reports another limit.
haptics::DeviceLimits limits_for(const TouchOptions& o, const Device& device) {
  const haptics::DeviceLimits& own = device.info().limits;
  if (o.preset != "published") return own;
  const haptics::DeviceLimits falcon = *haptics::limits_of("falcon");
  if (own.name != falcon.name)
    throw InputError(
        fmt::format("--preset published is the Novint Falcon's; this device is {}. Try --device "
                    "simulated:falcon",
                    device.info().name));
  return own.peak_force == falcon.peak_force ? haptics::published_preset() : own;
}

haptics::Workspace place(const TouchOptions& o, const TouchModel& model,
                         std::optional<SkinRegion> region, const Device& device) {
  // The simulated hand's path and the pointer's places are in the head's own frame.
  if (device.info().backend == "simulated" || device.info().backend == "pointer") return {};
  if (region) return haptics::aimed_at(model, *region, device.info(), o.workspace_scale);
  return haptics::facing(model, device.info(), 20, o.workspace_scale);
}

std::unique_ptr<serve::Server> start_server(const TouchOptions& o, serve::PageFiles files,
                                            serve::LiveTouch& live,
                                            const serve::Channels& channels) {
  serve::ServerOptions options;
  options.address = o.address;
  options.token = o.token;
  if (options.token.empty() && !serve::is_loopback(o.address)) options.token = serve::new_token();
  if (o.port != 0) {
    options.port = static_cast<unsigned short>(o.port);
    return std::make_unique<serve::Server>(options, std::move(files), live, channels);
  }
  try {
    options.port = kUsualPort;
    return std::make_unique<serve::Server>(options, files, live, channels);
  } catch (const InputError&) {
    options.port = 0;  // the usual one is taken
    return std::make_unique<serve::Server>(options, std::move(files), live, channels);
  }
}

void open_browser(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  std::string program = "xdg-open", address = url;
  char* arguments[] = {program.data(), address.data(), nullptr};
  pid_t child = 0;
  (void)posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ);
}

/// Says what happens to a device, once: a hand that feels nothing must not have to guess why.
class DeviceWatch {
 public:
  DeviceWatch(const haptics::TouchCycle& cycle, const Say& say) : cycle_(cycle), say_(say) {}
  void look() {
    const haptics::DeviceStatus now = cycle_.latest().device;
    if (now == last_ || now == haptics::DeviceStatus::waiting) return;
    const bool first = last_ == haptics::DeviceStatus::waiting;
    last_ = now;
    if (now == haptics::DeviceStatus::ok && first) return;
    const std::string why =
        now == haptics::DeviceStatus::ok ? std::string() : cycle_.device().trouble();
    say_(fmt::format("device {}{}{}", haptics::name(now), why.empty() ? "" : ": ", why));
  }

 private:
  const haptics::TouchCycle& cycle_;
  const Say& say_;
  haptics::DeviceStatus last_ = haptics::DeviceStatus::waiting;
};

/// @param look  called often, in this thread
void wait(const TouchOptions& o, const Progress& stop, DeviceWatch watch,
          const std::function<void()>& look) {
  using clock = std::chrono::steady_clock;
  const auto end = clock::now() + std::chrono::duration<double>(o.seconds);
  try {
    while (o.seconds <= 0 || clock::now() < end) {
      stop.step("touch", 0);
      watch.look();
      look();
      std::this_thread::sleep_for(std::chrono::milliseconds(50));
    }
  } catch (const Cancelled&) {
    // Ctrl-C is how a touch ends.
  }
}

json describe(const haptics::LoopReport& r) {
  json trips = json::object(), histogram = json::array();
  for (const haptics::HistogramRow& row : r.histogram)
    histogram.push_back({{"below_us", row.below_us}, {"late", row.late}, {"tick", row.tick}});
  for (std::size_t i = 1; i < r.trips.size(); ++i)
    trips[std::string(haptics::kTripNames[i])] = r.trips[i];
  return {
      {"rate_hz", r.rate_hz},
      {"ticks", r.ticks},
      {"skipped", r.skipped},
      {"late_us",
       {{"median", r.late_median_us}, {"p999", r.late_p999_us}, {"longest", r.late_longest_us}}},
      {"late_above_1ms", r.late_above_1ms},
      {"tick_us",
       {{"median", r.tick_median_us}, {"p999", r.tick_p999_us}, {"longest", r.tick_longest_us}}},
      {"histogram", histogram},
      {"passivity_removed_n_mm", r.removed},
      {"watchdog", trips},
      {"guarded", r.guarded},
      {"warnings", r.warnings},
      {"text", haptics::text(r)}};
}

}  // namespace

fs::path page_folder() {
  std::error_code ignored;
  if (const char* set = std::getenv("PALPATE_WEB"); set && *set) return set;
  const fs::path beside = fs::read_symlink("/proc/self/exe", ignored).parent_path();
  for (const fs::path& folder :
       {beside / "web", beside.parent_path() / "share" / "palpate" / "web"})
    if (fs::is_regular_file(folder / "index.html", ignored)) return folder;
  return {};
}

json run_touch(const TouchOptions& o, const Progress& stop, const Say& say) {
  std::string bytes = read_file(o.head);
  const TouchableHead head = io::parse_head(bytes, o.head.string());
  haptics::TouchModelOptions model_options;
  model_options.tool_radius = o.tool_radius;
  const TouchModel model = haptics::make_touch_model(head, model_options);
  const auto region = region_named(o.region, model);
  const OpenedDevice opened = open(o, model, region, say);
  Device& device = *opened.device;
  const haptics::TickSetup setup = haptics::make_tick_setup(model, limits_for(o, device), o.tick);
  for (const auto* list : {&model.warnings, &setup.warnings})
    for (const std::string& w : *list) say("warning: " + w);
  std::unique_ptr<haptics::Recorder> recorder;
  if (!o.record.empty())
    recorder = std::make_unique<haptics::Recorder>(o.record, setup, device.info().name, o.rate_hz);
  haptics::CycleOptions cycle_options;
  // A late tick frightens nobody who holds a mouse; with a device the strict limit stays.
  if (opened.pointer) cycle_options.late = 0.25;
  haptics::TouchCycle cycle(setup, device, place(o, model, region, device), cycle_options,
                            recorder.get());
  haptics::LoopOptions loop_options;
  loop_options.rate_hz = o.rate_hz;
  loop_options.priority = o.priority;
  haptics::TouchLoop loop(cycle, loop_options);

  serve::LiveFacts facts;
  facts.head_name = o.head.filename().string();
  facts.recording = o.record.string();
  facts.look_at = region;
  facts.warnings = model.warnings;
  facts.warnings.insert(facts.warnings.end(), setup.warnings.begin(), setup.warnings.end());
  serve::LiveTouch live(cycle, loop, opened.pointer, recorder.get(), facts);
  std::unique_ptr<PointsDesk> desk;  // outlives the server, which knows its channel
  std::unique_ptr<serve::Server> server;
  json result = {{"head", o.head.string()}, {"device", device.info().name}};
  if (o.page) {
    serve::PageFiles files = serve::load_page(page_folder());
    files["/head.glb"] = {std::move(bytes), serve::content_type("head.glb")};
    desk = std::make_unique<PointsDesk>(head, model, o.head, say);
    server = start_server(o, std::move(files), live, {{"/points", &desk->channel()}});
    result["url"] = server->url();
  }
  loop.start();
  if (!opened.pointer)  // a mouse does not need the rights that a device does
    for (const std::string& w : loop.report().warnings) say("warning: " + w);
  say(fmt::format("device: {} ({:.0f} Hz)", device.info().name, o.rate_hz));
  if (server) {
    say("open " + server->url());
    if (o.open_browser) open_browser(server->url());
  }
  wait(o, stop, {cycle, say}, [&] {
    if (desk) desk->look(*server);
  });
  server.reset();
  loop.stop();
  result["loop"] = describe(loop.report());
  if (recorder) {
    recorder->finish();
    result["recording"] = {{"file", o.record.string()},
                           {"ticks", recorder->written()},
                           {"dropped", recorder->dropped()}};
  }
  return result;
}

}  // namespace palpate::app
