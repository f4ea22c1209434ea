// SPDX-License-Identifier: Apache-2.0
// Haply Inverse3 through its maker's local service: WebSocket, JSON, metres, newtons. The service
// answers each message with exactly one state and sends nothing unasked, except a first message
// with the inventory; forces are not persistent; unknown keys are ignored without a word, so the
// force that the service reports back is compared with the one sent. Axes: +x right, +y away from
// the user, +z up.
//
// A thread of its own talks to the service; the loop sees the latest sample and leaves the latest
// force. Source: the maker's protocol documentation, version 3.5.
#include <fmt/format.h>

#include <atomic>
#include <cmath>
#include <deque>
#include <limits>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/error.hpp"
#include "haptics/find_devices.hpp"
#include "haptics/realtime.hpp"
#include "haptics/seqlock.hpp"
#include "haptics/service_channel.hpp"

namespace palpate::haptics {

namespace {

namespace asio = boost::asio;
using Json = nlohmann::json;

constexpr double kMillimetres = 1000;
constexpr std::int64_t kOldForce = 5'000'000;  // [ns] older forces are sent as zero
constexpr std::string_view kStopEvent = "device-safety-triggered";

Json parse(const std::string& text) {
  Json message = Json::parse(text, nullptr, false);
  if (message.is_discarded() || !message.is_object())
    throw InputError(
        "the service sent something that is not JSON; is it Haply's, version 3.1 or later?");
  return message;
}

std::string id_of(const Json& entry) {
  if (!entry.is_object()) return {};
  const auto id = entry.find("device_id");
  return id != entry.end() && id->is_string() ? id->get<std::string>() : std::string();
}

// Finds our device in a message of the service; null where it is not listed.
const Json* entry_of(const Json& message, const std::string& id) {
  const auto list = message.find("inverse3");
  if (list == message.end() || !list->is_array()) return nullptr;
  for (const Json& entry : *list) {
    const std::string name = id_of(entry);
    if (!name.empty() && (id.empty() || name == id)) return &entry;
  }
  return nullptr;
}

bool vector_of(const Json& state, const char* key, Vec3& out) {
  const auto v = state.find(key);
  if (v == state.end() || !v->is_object()) return false;
  int axis = 0;
  for (const char* name : {"x", "y", "z"}) {
    const auto c = v->find(name);
    if (c == v->end() || !(c->is_number() || c->is_null())) return false;
    // JSON has no NaN: writers put null, and the watchdog then sees what the device meant.
    out[axis++] = c->is_null() ? std::numeric_limits<double>::quiet_NaN() : c->get<double>();
  }
  return true;
}

// The buttons of the grip that is screwed to the arm: a is the main one, b the clutch.
std::uint32_t buttons_of(const Json& message) {
  std::uint32_t pressed = 0;
  const auto grips = message.find("wireless_verse_grip");
  if (grips == message.end() || !grips->is_array()) return 0;
  for (const Json& grip : *grips) {
    const auto path = Json::json_pointer("/state/buttons");
    if (!grip.contains(path)) continue;
    const Json& buttons = grip.at(path);
    std::uint32_t bit = 1;
    for (const char* name : {"a", "b", "c"}) {
      const auto b = buttons.find(name);
      if (b != buttons.end() && b->is_boolean() && b->get<bool>()) pressed |= bit;
      bit <<= 1U;
    }
  }
  return pressed;
}

Vec3 to_user(const Vec3& v) {
  return {v.x(), v.z(), -v.y()};
}
Vec3 to_service(const Vec3& v) {
  return {v.x(), -v.z(), v.y()};
}

/// Holds what was sent lately against what the service says that it applies.
class EchoCheck {
 public:
  /// Returns false once the force has been disregarded for kPatience answers in a row.
  bool agrees(const Vec3& sent, const Vec3& applied) {
    recent_.push_back(sent);
    if (recent_.size() > kLag) recent_.pop_front();
    bool near = false, strong = true;
    for (const Vec3& f : recent_) {
      near = near || (f - applied).norm() < 0.5 * f.norm() + kSmall;
      strong = strong && f.norm() > 3 * kSmall;
    }
    misses_ = near || !strong ? 0 : misses_ + 1;
    return misses_ < kPatience;
  }

 private:
  static constexpr std::size_t kLag = 8;  // answers by which the echo may trail
  static constexpr double kSmall = 0.1;   // [N] below it friction and rounding decide
  static constexpr int kPatience = 100;   // answers, about 0.1 s
  std::deque<Vec3> recent_;
  int misses_ = 0;
};

class Inverse3 final : public Device {
 public:
  Inverse3(std::string device_id, const FindOptions& options)
      : id_(std::move(device_id)),
        channel_(io_, options.inverse_host, options.inverse_port, options.timeout) {
    const Json inventory = parse(channel_.receive());
    const Json* entry = entry_of(inventory, id_);
    if (!entry)
      throw InputError(id_.empty() ? "the service runs, but lists no Inverse3; is it plugged in?"
                                   : fmt::format("the service lists no Inverse3 '{}'", id_));
    id_ = entry->at("device_id").get<std::string>();
    quoted_id_ = Json(id_).dump();
    info_.backend = "inverse3:" + id_;
    info_.name = "Haply Inverse3";
    info_.serial = id_;
    info_.limits = *limits_of("Haply Inverse3");
    // The middle of the arm's reach, as the maker's examples take it: 0, -0.12, 0.15 m.
    info_.center = kMillimetres * to_user(Vec3(0, -0.12, 0.15));
    listen_for_stops(options);
    thread_ = std::thread([this] { talk(); });
  }
  ~Inverse3() override {
    stop_ = true;
    thread_.join();
  }
  Inverse3(const Inverse3&) = delete;
  Inverse3& operator=(const Inverse3&) = delete;

  const DeviceInfo& info() const override { return info_; }
  DeviceStatus read(DeviceSample& sample) noexcept override {
    const DeviceStatus status = status_.load(std::memory_order_acquire);
    if (status == DeviceStatus::ok || status == DeviceStatus::ignored) sample = sample_.load();
    return status;
  }
  DeviceStatus write(const Vec3& force) noexcept override {
    force_.store({force, monotonic_ns()});
    return status_.load(std::memory_order_acquire);
  }
  void release() noexcept override { muted_at_.store(monotonic_ns(), std::memory_order_relaxed); }
  std::string trouble() const override {
    const std::lock_guard lock(trouble_mutex_);
    return trouble_;
  }

 private:
  struct TimedForce {
    Vec3 force = Vec3::Zero();
    std::int64_t time_ns = 0;
  };

  void note(const std::string& text) {
    const std::lock_guard lock(trouble_mutex_);
    trouble_ = text;
  }
  // Without events a stop shows in the state only; the device is used all the same.
  void listen_for_stops(const FindOptions& options) {
    try {
      events_ = std::make_unique<ServiceChannel>(io_, options.inverse_host,
                                                 options.inverse_event_port, options.timeout);
      events_->listen([this](const std::string& text) {
        if (text.find(kStopEvent) != std::string::npos) stopped_ = true;
      });
    } catch (const InputError& e) {
      note(fmt::format("the service's events are not heard ({})", e.what()));
    }
  }

  Vec3 force_to_send() {
    const TimedForce wish = force_.load();
    const bool valid = monotonic_ns() - wish.time_ns < kOldForce &&
                       wish.time_ns > muted_at_.load(std::memory_order_relaxed);
    return valid && !stopped_ ? wish.force : Vec3::Zero();
  }
  void talk() {
    try {
      while (!stop_) exchange(force_to_send());
      exchange(Vec3::Zero());
    } catch (const std::exception& e) {
      note(e.what());
      status_.store(DeviceStatus::lost, std::memory_order_release);
      force_off();
    }
  }
  // A last word, should somebody still be there to hear it.
  void force_off() noexcept {
    try {
      channel_.send(command(Vec3::Zero()));
    } catch (const std::exception&) {
      // Nobody is: the service drops forces that are not renewed.
    }
  }
  std::string command(const Vec3& f) const {
    return fmt::format(
        R"({{"inverse3":[{{"device_id":{},"commands":{{"set_cursor_force":{{"vector":{{"x":{},"y":{},"z":{}}}}}}}}}]}})",
        quoted_id_, f.x(), f.y(), f.z());
  }
  // One message out, one state in.
  void exchange(const Vec3& force) {
    const Vec3 f = to_service(force);
    channel_.send(command(f));
    const Json message = parse(channel_.receive());
    const Json* entry = entry_of(message, id_);
    if (!entry) throw InputError("the device is no longer listed: unplugged or switched off");
    const auto state = entry->find("state");
    DeviceSample s;
    Vec3 position, velocity, applied;
    if (state == entry->end() || !vector_of(*state, "cursor_position", position))
      throw InputError(
          "the service's state has no cursor_position; version 3.1 or later is needed");
    s.position = kMillimetres * to_user(position);
    s.has_velocity = vector_of(*state, "cursor_velocity", velocity);
    if (s.has_velocity) s.velocity = kMillimetres * to_user(velocity);
    s.buttons = buttons_of(message);
    s.number = ++number_;
    sample_.store(s);
    DeviceStatus status = DeviceStatus::ok;
    if (vector_of(*state, "current_cursor_force", applied) && !echo_.agrees(f, applied)) {
      note("the service does not apply our forces; is another program using the device?");
      status = DeviceStatus::ignored;
    }
    if (stopped_) {
      note("the device's safety stop was triggered; clear it and open the device again");
      status = DeviceStatus::stopped;
    }
    status_.store(status, std::memory_order_release);
  }

  std::string id_, quoted_id_;
  asio::io_context io_;
  ServiceChannel channel_;
  std::unique_ptr<ServiceChannel> events_;
  DeviceInfo info_;
  EchoCheck echo_;
  std::uint64_t number_ = 0;
  bool stopped_ = false;
  SeqLock<DeviceSample> sample_;
  SeqLock<TimedForce> force_;
  std::atomic<std::int64_t> muted_at_{0};
  std::atomic<DeviceStatus> status_{DeviceStatus::waiting};
  std::atomic<bool> stop_{false};
  mutable std::mutex trouble_mutex_;
  std::string trouble_;
  std::thread thread_;
};

constexpr const char* kRemedy =
    "start Haply's inverse service (Haply Hub, or systemctl start haply-inverse-service)";

}  // namespace

std::unique_ptr<Device> open_inverse3(const std::string& device_id, const FindOptions& options) {
  try {
    return std::make_unique<Inverse3>(device_id, options);
  } catch (const InputError& e) {
    const std::string why = e.what();
    const bool unreachable = why.starts_with("cannot connect");
    throw InputError(fmt::format("inverse3: {} on {}:{}{}{}", why, options.inverse_host,
                                 options.inverse_port, unreachable ? "; " : "",
                                 unreachable ? kRemedy : ""));
  }
}

namespace {

// The service's first message is its whole inventory. Without an answer or a device: one empty id,
// whose opening tells what is missing.
std::vector<std::string> listed_ids(const FindOptions& options) {
  std::vector<std::string> ids;
  try {
    asio::io_context io;
    ServiceChannel channel(io, options.inverse_host, options.inverse_port, options.timeout);
    const Json inventory = parse(channel.receive());
    for (const Json& entry : inventory.value("inverse3", Json::array()))
      if (std::string id = id_of(entry); !id.empty()) ids.push_back(std::move(id));
  } catch (const std::exception&) {
    ids.clear();
  }
  if (ids.empty()) ids.emplace_back();
  return ids;
}

DeviceFinding find_one(const std::string& id, const FindOptions& options) {
  try {
    const auto device = open_inverse3(id, options);
    return {device->info().backend, device->info().name, true, describe(device->info())};
  } catch (const InputError& e) {
    std::string why = e.what();
    if (why.starts_with("inverse3: ")) why.erase(0, 10);
    return {id.empty() ? "inverse3" : "inverse3:" + id, "Haply Inverse3", false, why};
  }
}

}  // namespace

std::vector<DeviceFinding> find_inverse3(const FindOptions& options) {
  std::vector<DeviceFinding> found;
  for (const std::string& id : listed_ids(options)) found.push_back(find_one(id, options));
  return found;
}

}  // namespace palpate::haptics
