// SPDX-License-Identifier: GPL-3.0-or-later
// A study with people: one loop takes what the pages say, passes time on and posts what they show.
// The participant's page gets a view made here field by field; nothing else goes to it.
#include <fmt/format.h>
#include <spawn.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <optional>
#include <thread>

#include "apps/study_session.hpp"
#include "apps/study_touch.hpp"
#include "apps/touch_session.hpp"
#include "core/error.hpp"
#include "haptics/find_devices.hpp"
#include "serve/access.hpp"
#include "serve/server.hpp"
#include "study/runner.hpp"

extern char** environ;  // for posix_spawnp

namespace palpate::app {
using nlohmann::json;
using study::Screen;
using study::ScreenKind;

namespace {

constexpr std::array kKinds = {"text",   "consent",  "question", "touch",
                               "choose", "finished", "excused"};
constexpr std::array kTypes = {"choice", "number", "text", "rating"};

std::unique_ptr<haptics::Device> open_study_device(const StudyOptions& o, double tool_radius) {
  if (!o.device.starts_with("simulated")) return haptics::open_device(o.device);
  haptics::SimulatedHandOptions options;
  options.rate_hz = o.rate_hz;
  options.repeat = true;
  const std::size_t colon = o.device.find(':');
  if (colon != std::string::npos) {
    const auto limits = haptics::limits_of(o.device.substr(colon + 1));
    if (!limits)
      throw InputError(fmt::format(
          "--device {}: no device of that name is known; try simulated:falcon", o.device));
    options.limits = *limits;
  }
  constexpr double kForce = 2, kRound = 6;  // [N], [s]
  return std::make_unique<haptics::SimulatedHand>(
      probing({}, tool_radius, kRound, kForce, options.stiffness), options);
}

json question_view(const study::Question& q) {
  json options = json::array();
  for (const study::Option& o : q.options) options.push_back({{"id", o.id}, {"text", o.text}});
  return {{"type", kTypes[static_cast<std::size_t>(q.type)]},
          {"text", q.text},
          {"options", options},
          {"least", q.least},
          {"most", q.most},
          {"step", q.step},
          {"low", q.low},
          {"high", q.high},
          {"optional", q.optional}};
}

/// All that a participant may know. No region, no factor, no part, no order.
json participant_view(const study::Runner& runner, bool simulated, const std::string& error) {
  const Screen& s = runner.screen();
  json view = {{"kind", kKinds[static_cast<std::size_t>(s.kind)]},
               {"number", runner.answers().size()},
               {"title", s.title},
               {"text", s.text},
               {"place", s.place},
               {"places", s.places},
               {"interval", s.interval},
               {"picture", s.head_visible},
               {"paused", runner.paused()},
               {"simulated", simulated},
               {"error", error}};
  if (s.kind == ScreenKind::question) view["question"] = question_view(s.question);
  if (s.kind == ScreenKind::choose) {
    view["choose"] = s.choose;
    view["barred"] = s.barred;
  }
  if (s.kind == ScreenKind::touch) {
    view["ready"] = runner.may_go_on();
    view["left_s"] =
        s.most_s > 0 ? json(std::ceil(std::max(0.0, s.most_s - runner.touched_s()))) : json();
  }
  return view;
}

void append_float(std::string& out, double value) {
  const auto narrow = static_cast<float>(value);
  char bytes[sizeof narrow];
  std::memcpy(bytes, &narrow, sizeof narrow);
  out.append(bytes, sizeof narrow);
}

/// Tool's place, pose of the head (columns: the user's axes in the head), pose's point, radius.
std::string frame_bytes(const haptics::CycleSnapshot& s, double tool_radius) {
  std::string out;
  for (int k = 0; k < 3; ++k) append_float(out, s.tool[k]);
  for (int column = 0; column < 3; ++column)
    for (int k = 0; k < 3; ++k) append_float(out, s.workspace.rotation(k, column));
  for (int k = 0; k < 3; ++k) append_float(out, s.workspace.at_head[k]);
  append_float(out, tool_radius);
  return out;
}

void open_pages(const std::string& url) {
  if (!std::getenv("DISPLAY") && !std::getenv("WAYLAND_DISPLAY")) return;
  std::string program = "xdg-open", address = url;
  char* arguments[] = {program.data(), address.data(), nullptr};
  pid_t child = 0;
  (void)posix_spawnp(&child, program.c_str(), nullptr, nullptr, arguments, environ);
}

class LiveStudy {
 public:
  LiveStudy(OpenStudy& study, const StudyOptions& options)
      : study_(study),
        options_(options),
        simulated_(options.device.starts_with("simulated")),
        device_(open_study_device(options, study.model.tool_radius)),
        touch_(study.model, *device_, options.rate_hz, options.priority),
        experimenter_(serve::new_token()) {}

  void serve(const Say& say) {
    serve::PageFiles files = serve::load_page(page_folder());
    files["/study/skin.bin"] = {std::move(study_.skin), serve::content_type("skin.bin")};
    serve::ServerOptions server;
    server.address = options_.address;
    server.port = static_cast<unsigned short>(options_.port);
    server.token = options_.token;
    if (server.token.empty() && !serve::is_loopback(server.address))
      server.token = serve::new_token();
    post();
    server_ =
        std::make_unique<serve::Server>(server, std::move(files),
                                        serve::Channels{{"/study/participant", &participant_},
                                                        {"/study/experimenter", &experimenter_}});
    const std::string url = server_->url();
    const std::size_t path = url.find('/', std::strlen("http://")) + 1;
    const std::string front = url.substr(0, path), query = url.substr(path);
    const std::string experimenter =
        front + "study/experimenter.html" + query + "#key=" + experimenter_.key();
    say(fmt::format("device: {}", device_->info().name));
    say("participant " + front + "study/participant.html" + query);
    say("experimenter " + experimenter);
    if (options_.open_browser) open_pages(experimenter);
  }

  void step(double seconds) {
    while (const auto message = experimenter_.take()) obey(*message);
    while (const auto message = participant_.take()) hear(*message);
    pass(seconds);
    post();
  }
  [[nodiscard]] bool over() const { return over_; }

 private:
  void obey(const std::string& message) {
    const json m = json::parse(message, nullptr, false);
    if (!m.is_object()) return;
    const std::string what = m.value("do", ""), who = m.value("who", "");
    try {
      notice_.clear();
      if (what == "start" && !runner_) begin(enrol());
      if (what == "take-up" && !runner_) begin(who);
      if (what == "pause" && runner_) pause(!runner_->paused());
      if (what == "leave") leave();
      if (what == "go-on" && runner_ && runner_->screen().kind == ScreenKind::touch) answer("done");
      if (what == "withdraw") withdraw(who);
      if (what == "end") over_ = true;
    } catch (const InputError& error) {
      notice_ = error.what();
    } catch (const json::exception&) {
      notice_ = "that was not understood";
    }
  }

  void hear(const std::string& message) {
    const json m = json::parse(message, nullptr, false);
    if (!m.is_object() || !runner_) return;
    try {
      if (m.value("do", "") == "pause" && !runner_->paused()) return pause(true);
      // An answer to a screen that has gone by came twice.
      if (m.value("number", -1) != static_cast<int>(runner_->answers().size())) return;
      answer(m.value("value", ""));
    } catch (const json::exception&) {
    }
  }

  std::string enrol() {
    if (study_.store.next_order_index() >= study_.study.planned_participants)
      notice_ = "this one is more than the study planned";
    return study_.store
        .enrol(simulated_, draw_orders(study_.protocol, study_.study.regions, study_.study.seed,
                                       study_.store.next_order_index()))
        .pseudonym;
  }
  void begin(const std::string& who) {
    runner_.emplace(study_.store, study_.protocol, who);
    error_.clear();
  }
  void leave() {
    touch_.end();
    touched_.clear();
    runner_.reset();
    participant_.post_frame({});
  }
  void withdraw(const std::string& who) {
    if (runner_ && runner_->pseudonym() == who) leave();
    study_.store.withdraw(who);
    notice_ = fmt::format("{} has withdrawn; what came from them is deleted", who);
  }
  void pause(bool on) {
    runner_->pause(on);
    touch_.pause(on);
  }
  void answer(const std::string& value) {
    try {
      save_samples();
      runner_->answer(value);
      error_.clear();
    } catch (const InputError& error) {
      error_ = error.what();
    }
  }

  void save_samples() {
    const auto samples = touch_.drain();
    if (runner_) runner_->add_samples(samples);
  }

  void pass(double seconds) {
    if (!runner_) return;
    save_samples();
    if (runner_->screen().kind != ScreenKind::touch) return stop_touch();
    const Screen& screen = runner_->screen();
    if (touched_ != screen.key) {
      touch_.end();
      for (const study::StudyRegion& r : study_.study.regions)
        if (r.name == screen.region)
          touch_.begin(r, screen, largest_factor(study_.protocol, screen.part));
      touch_.pause(runner_->paused());
      touched_ = screen.key;
      seconds = 0;
    }
    (void)runner_->pass(seconds);
  }
  void stop_touch() {
    if (touched_.empty()) return;
    touch_.end();
    touched_.clear();
  }

  void post() {
    const json mine = runner_ ? participant_view(*runner_, simulated_, error_)
                              : json{{"kind", "waiting"}, {"simulated", simulated_}};
    post_new(participant_, last_participant_, mine);
    post_new(experimenter_, last_experimenter_, experimenter_view());
    if (runner_ && touch_.touching() && runner_->screen().head_visible)
      participant_.post_frame(frame_bytes(touch_.latest(), study_.model.tool_radius));
  }
  static void post_new(serve::Channel& channel, std::string& last, const json& view) {
    std::string text = view.dump();
    if (text == last) return;
    last = text;
    channel.post(std::move(text));
  }

  json experimenter_view() {
    if (const auto changed = people_key(); changed != people_known_) {
      people_known_ = changed;
      people_ = json::array();
      for (const study::Participant& p : study_.store.participants())
        people_.push_back({{"pseudonym", p.pseudonym},
                           {"state", std::string(name(p.state))},
                           {"simulated", p.simulated}});
    }
    json view = {{"title", study_.study.title},
                 {"protocol", study_.study.protocol_name},
                 {"head", study_.study.head_name},
                 {"file", options_.output.filename().string()},
                 {"planned", study_.study.planned_participants},
                 {"device", device_->info().name},
                 {"simulated", simulated_},
                 {"people", people_},
                 {"pages", participant_.pages()},
                 {"notice", notice_},
                 {"current", json()}};
    if (!runner_) return view;
    const Screen& s = runner_->screen();
    view["current"] = {{"pseudonym", runner_->pseudonym()},
                       {"key", s.key},
                       {"kind", kKinds[static_cast<std::size_t>(s.kind)]},
                       {"title", s.title},
                       {"asks", s.kind == ScreenKind::question ? s.question.text : s.text},
                       {"region", s.region},
                       {"factor", s.factor},
                       {"place", s.place},
                       {"places", s.places},
                       {"touched_s", std::floor(runner_->touched_s())},
                       {"least_s", s.least_s},
                       {"most_s", s.most_s},
                       {"paused", runner_->paused()},
                       {"answers", runner_->answers().size()},
                       {"dropped", touch_.dropped()}};
    if (touch_.touching()) {
      const haptics::CycleSnapshot now = touch_.latest();
      view["current"]["device"] = std::string(name(now.device));
      view["current"]["watchdog"] = std::string(name(now.trip));
      view["current"]["force_n"] = std::round(10 * now.out.force.norm()) / 10;
    }
    return view;
  }
  /// Changes whenever somebody's state may have.
  [[nodiscard]] std::string people_key() const {
    return fmt::format("{}/{}/{}/{}", study_.store.next_order_index(),
                       runner_ ? runner_->pseudonym() : "", runner_ && runner_->over(), notice_);
  }

  OpenStudy& study_;
  const StudyOptions& options_;
  bool simulated_;
  std::unique_ptr<haptics::Device> device_;
  StudyTouch touch_;
  serve::Channel participant_, experimenter_;
  std::unique_ptr<serve::Server> server_;
  std::optional<study::Runner> runner_;
  std::string touched_;  // key of the screen that is being touched
  std::string error_, notice_, last_participant_, last_experimenter_, people_known_ = "?";
  json people_ = json::array();
  bool over_ = false;
};

}  // namespace

json run_live(OpenStudy& study, const StudyOptions& options, const Progress& stop, const Say& say) {
  using clock = std::chrono::steady_clock;
  LiveStudy live(study, options);
  live.serve(say);
  const auto start = clock::now();
  auto last = start;
  try {
    while (!live.over() &&
           (options.seconds <= 0 ||
            clock::now() - start < std::chrono::duration<double>(options.seconds))) {
      stop.step("study", 0);
      const auto now = clock::now();
      live.step(std::chrono::duration<double>(now - last).count());
      last = now;
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    }
  } catch (const Cancelled&) {
    // Ctrl-C is how a day of a study ends; all answers are in the file.
  }
  int finished = 0;
  for (const study::Participant& p : study.store.participants())
    finished += p.state == study::ParticipantState::finished;
  return {{"study", options.output.string()}, {"finished", finished}};
}

}  // namespace palpate::app
