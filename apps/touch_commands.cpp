// SPDX-License-Identifier: GPL-3.0-or-later
// Touching a finished head: touch, view, feel, devices, replay.
#include <fmt/format.h>

#include <sstream>

#include "apps/command_line.hpp"
#include "apps/terminal_progress.hpp"
#include "apps/touch_session.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "haptics/find_devices.hpp"
#include "haptics/recording.hpp"
#include "io/head_file.hpp"
#include "serve/live.hpp"

namespace palpate::app {
namespace {

using nlohmann::json;
namespace fs = std::filesystem;

constexpr const char* kHeadHelp = "touchable head, .glb, as `palpate build` writes it";

/// Settings of touch and view beside those that every command has.
struct TouchCommand {
  TouchOptions options;
  std::string scaling = "ratio";
  bool no_passivity = false;
  bool no_open = false;
  bool no_page = false;
  bool report = false;
};

void run_session(const Command& c, TouchCommand& t) {
  TouchOptions& o = t.options;
  o.head = c.input;
  o.tick.scaling = t.scaling == "none" ? haptics::Scaling::none : haptics::Scaling::ratio;
  o.tick.passivity = !t.no_passivity;
  o.open_browser = !t.no_open;
  o.page = !t.no_page;
  if (!o.record.empty()) check_writable(o.record);
  const auto stop = make_terminal_progress(true);
  const auto say = [&](const std::string& line) {
    // A script needs the address while the command runs; people need all lines.
    if (c.json && line.starts_with("open "))
      fmt::print("{}\n", json{{"url", line.substr(5)}}.dump());
    else if (!c.quiet)
      fmt::print(c.json ? stderr : stdout, "{}\n", line);
    std::fflush(stdout);
  };
  const json result = run_touch(o, *stop, say);
  if (c.json)
    fmt::print("{}\n", result.dump());
  else if (t.report)
    fmt::print("{}", result["loop"]["text"].get<std::string>());
  if (result.contains("recording") && !c.json && !c.quiet)
    fmt::print("recorded {} ticks in {}\n", result["recording"]["ticks"].get<std::uint64_t>(),
               o.record.string());
}

void add_page_options(CLI::App* sub, const std::shared_ptr<TouchCommand>& t) {
  TouchOptions& o = t->options;
  sub->add_option("--port", o.port, "port of the page; 0: 8733, or a free one where that is taken")
      ->check(CLI::Range(0, 65535));
  sub->add_option("--listen", o.address,
                  "numeric address to serve at; beyond 127.0.0.1 a token guards the page")
      ->capture_default_str();
  sub->add_option(
      "--token", o.token,
      "secret in the page's address, 8 or more letters, digits, - and _; made up where needed");
  sub->add_flag("--no-open", t->no_open, "do not open a browser");
  sub->add_option("--seconds", o.seconds, "[s] end by itself; 0: at Ctrl-C")
      ->check(CLI::Range(0.0, 86400.0));
}

void add_loop_options(CLI::App* sub, const std::shared_ptr<TouchCommand>& t) {
  TouchOptions& o = t->options;
  sub->add_option("--device", o.device,
                  "auto, pointer (the mouse on the page), simulated[:falcon], "
                  "force-dimension[:n], inverse3[:id], touch[:name]")
      ->capture_default_str();
  sub->add_option("--rate", o.rate_hz, "[Hz] of the loop")
      ->check(CLI::Range(100.0, 4000.0))
      ->capture_default_str();
  sub->add_option("--priority", o.priority, "real-time priority, 1 to 99; 0 asks for none")
      ->check(CLI::Range(0, 99))
      ->capture_default_str();
  sub->add_option(
      "--region", o.region,
      "turn the head so that this region lies under the device, or shows on the page; the "
      "simulated hand stays on it. Also on the page");
  sub->add_option("--preset", o.preset,
                  "published: the Falcon as in the published study, at most 8.7 N")
      ->check(CLI::IsMember({"default", "published"}))
      ->capture_default_str();
  sub->add_option("--workspace-scale", o.workspace_scale, "mm of head per mm of device")
      ->check(CLI::Range(0.1, 10.0))
      ->capture_default_str();
  sub->add_option("--scaling", t->scaling,
                  "ratio: a weak device gets all forces smaller; none: forces as mapped, clipped")
      ->check(CLI::IsMember({"ratio", "none"}))
      ->capture_default_str();
  sub->add_flag("--no-passivity", t->no_passivity, "switch the passivity controller off");
  sub->add_option("--record", o.record, "write every tick to this file; see `palpate replay`");
  sub->add_flag("--report", t->report,
                "at the end, how late the loop was, how long ticks took, and what watchdog and "
                "passivity controller did");
  sub->add_flag("--no-page", t->no_page, "no server; the device alone");
}

void add_touch(CLI::App& app) {
  auto c = std::make_shared<Command>();
  auto t = std::make_shared<TouchCommand>();
  CLI::App* sub = add_subcommand(
      app, "touch", "feel a head: 1 kHz loop, device, page",
      "Examples:\n"
      "  palpate touch head.glb                      first device found, else the mouse\n"
      "  palpate touch head.glb --device simulated --seconds 60 --report --no-page\n"
      "  palpate touch head.glb --device force-dimension --region cheek --record visit.touch\n"
      "Ctrl-C ends it. `palpate devices` says what is there and what is missing.",
      c, [t](Command& command) { run_session(command, *t); });
  sub->add_option("HEAD", c->input, kHeadHelp)->required();
  add_loop_options(sub, t);
  add_page_options(sub, t);
  sub->add_option("--tool-radius", t->options.tool_radius,
                  "[mm] of the tool; default: that of the map")
      ->check(CLI::Range(0.5, 30.0));
}

void add_view(CLI::App& app) {
  auto c = std::make_shared<Command>();
  auto t = std::make_shared<TouchCommand>();
  t->options.device = "pointer";
  CLI::App* sub = add_subcommand(
      app, "view", "look at a head in the browser and press it with the mouse",
      "Example:  palpate view head.glb\n"
      "Hold the left button on the skin and drag down to press deeper. [Move points] corrects the\n"
      "landmarks: it writes head.landmarks.txt beside the head and fits the skull again. Ctrl-C "
      "ends it.",
      c, [t](Command& command) { run_session(command, *t); });
  sub->add_option("HEAD", c->input, kHeadHelp)->required();
  add_page_options(sub, t);
}

// --- feel
// -----------------------------------------------------------------------------------------

struct FeelCommand {
  std::vector<double> at;
  double depth = 2;
  int vertex = -1;
};

void run_feel(const Command& c, const FeelCommand& f) {
  const TouchableHead head = io::read_head(c.input);
  const haptics::TouchModel model = haptics::make_touch_model(head);
  Vec3 picked = Vec3::Zero();
  if (f.vertex >= 0) {
    if (static_cast<std::size_t>(f.vertex) >= head.skin.points.size())
      throw InputError(fmt::format("--vertex {}: the head has vertices 0 to {}", f.vertex,
                                   head.skin.points.size() - 1));
    picked =
        head.frame.to_head(head.unit_mm * head.skin.points[static_cast<std::size_t>(f.vertex)]);
  } else if (f.at.size() == 3) {
    picked = Vec3(f.at[0], f.at[1], f.at[2]);
  } else {
    throw InputError("feel: say where, with --at x,y,z or --vertex N");
  }
  const auto place = serve::press_place(model, picked);
  if (!place) throw InputError("feel: there is no skin within 20 mm of that point");
  // As the page presses: the tool comes from outside along the normal.
  haptics::ProxyState proxy;
  (void)haptics::find_contact(model.mesh, model.tool_radius, place->center(model.tool_radius, -1),
                              proxy);
  const haptics::Contact contact = haptics::find_contact(
      model.mesh, model.tool_radius, place->center(model.tool_radius, f.depth), proxy);
  if (contact.count == 0) throw InputError("feel: the tool does not touch the skin there");
  double force = 0, stiffness = 0;
  for (int i = 0; i < contact.count; ++i) {
    const auto& p = contact.points[static_cast<std::size_t>(i)];
    const auto value =
        model.curves.blend_force(model.mesh.triangles[static_cast<std::size_t>(p.at.triangle)],
                                 p.at.on.barycentric, contact.depth);
    force += p.weight * value.force;
    stiffness += p.weight * value.stiffness;
  }
  const auto& at = contact.points[0].at;
  const auto region = name(model.region_at(at));
  print_result(c,
               {{"force_n", force},
                {"depth_mm", contact.depth},
                {"stiffness_n_mm", stiffness},
                {"region", region},
                {"point_mm", {at.on.point.x(), at.on.point.y(), at.on.point.z()}},
                {"normal", {contact.normal.x(), contact.normal.y(), contact.normal.z()}}},
               fmt::format("{:.3f} N at {:.3f} mm, {:.3f} N/mm there, {}\n", force, contact.depth,
                           stiffness, region));
}

void add_feel(CLI::App& app) {
  auto c = std::make_shared<Command>();
  auto f = std::make_shared<FeelCommand>();
  CLI::App* sub = add_subcommand(
      app, "feel", "the force at one place and depth, without a loop",
      "Example:  palpate feel head.glb --at 35,-40,70 --depth 4\n"
      "The place is in the head frame: mm, +x to the subject's left, +y up, +z out of the face.",
      c, [f](Command& command) { run_feel(command, *f); });
  sub->add_option("HEAD", c->input, kHeadHelp)->required();
  sub->add_option("--at", f->at, "[mm] x,y,z in the head frame; the nearest skin is pressed")
      ->delimiter(',')
      ->expected(3)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  sub->add_option("--vertex", f->vertex, "vertex of the scan instead of a place");
  sub->add_option("--depth", f->depth, "[mm] the tool's depth below first contact")
      ->check(CLI::Range(0.001, 60.0))
      ->capture_default_str();
}

// --- devices and replay
// ---------------------------------------------------------------------------

void run_devices(const Command& c) {
  json all = json::array();
  std::string text;
  for (const haptics::DeviceFinding& d : haptics::list_devices()) {
    all.push_back(
        {{"device", d.backend}, {"name", d.name}, {"usable", d.usable}, {"detail", d.detail}});
    text += fmt::format("{:<4} {:<16} {}\n{:22}{}\n", d.usable ? "yes" : "no", d.backend, d.name,
                        "", d.detail);
  }
  print_result(c, all, text);
}

struct ReplayCommand {
  fs::path head;
  fs::path csv;
};

void run_replay(const Command& c, const ReplayCommand& r) {
  if (!r.csv.empty()) check_writable(r.csv);
  const haptics::Recording recording = haptics::read_recording(c.input);
  const std::size_t ticks = recording.tick_count();
  json result = {{"device", recording.header.device},
                 {"rate_hz", recording.header.rate_hz},
                 {"tool_radius_mm", recording.header.tool_radius},
                 {"ticks", ticks},
                 {"ending", recording.ending}};
  std::string text = fmt::format("{} ticks ({:.1f} s at {:.0f} Hz), {}\n", ticks,
                                 static_cast<double>(ticks) / recording.header.rate_hz,
                                 recording.header.rate_hz, recording.header.device);
  if (!recording.ending.empty()) text += "cut short: " + recording.ending + "\n";
  if (!r.csv.empty()) {
    std::ostringstream out;
    haptics::write_csv(recording, out);
    write_file(r.csv, out.str());
    text += r.csv.string() + "\n";
    result["csv"] = r.csv.string();
  }
  if (!r.head.empty()) {
    haptics::TouchModelOptions options;
    options.tool_radius = recording.header.tool_radius;
    const auto model = haptics::make_touch_model(io::read_head(r.head), options);
    const haptics::ReplayResult same = haptics::replay(recording, model);
    result["replay"] = {{"ticks", same.ticks},
                        {"different", same.different},
                        {"largest_difference_n", same.largest_difference},
                        {"gaps", same.gaps},
                        {"passivity_ticks", same.damped},
                        {"passivity_removed_n_mm", same.removed}};
    text += fmt::format("{} of {} forces differ in a bit{}\n", same.different, same.ticks,
                        same.different ? fmt::format(", first at tick {}, at most {:.3g} N",
                                                     same.first_different, same.largest_difference)
                                       : "");
    text += fmt::format("the passivity controller acted in {} ticks and took out {:.2f} N mm\n",
                        same.damped, same.removed);
  }
  print_result(c, result, text);
}

void add_devices_and_replay(CLI::App& app) {
  auto c = std::make_shared<Command>();
  add_subcommand(app, "devices", "haptic devices that are here, and what is missing for the others",
                 "Example:  palpate devices\nThe second column goes into `palpate touch --device`.",
                 c, [](Command& command) { run_devices(command); });

  c = std::make_shared<Command>();
  auto r = std::make_shared<ReplayCommand>();
  CLI::App* sub = add_subcommand(
      app, "replay", "a recorded touch again, bit for bit; or as CSV",
      "Examples:\n"
      "  palpate replay visit.touch --head head.glb   runs every tick again, compares the forces\n"
      "  palpate replay visit.touch --csv visit.csv   one line per tick",
      c, [r](Command& command) { run_replay(command, *r); });
  sub->add_option("RECORDING", c->input, "file of `palpate touch --record`")->required();
  sub->add_option("--head", r->head, "the head that was touched; runs the forces again");
  sub->add_option("--csv", r->csv, "seconds, position, velocity, force, depth, contact, region");
}

}  // namespace

void add_touch_commands(CLI::App& app) {
  add_touch(app);
  add_view(app);
  add_feel(app);
  add_devices_and_replay(app);
}

}  // namespace palpate::app
