// SPDX-License-Identifier: Apache-2.0
// 3D Systems Touch and Touch X (formerly Phantom Omni and Desktop) through the vendor's HD library.
// Prototypes and numbers below are our own, from its documentation. The library runs a scheduler
// thread of its own at 1 kHz; the callback there exchanges the latest sample and the latest force
// with the loop. Its axes are the user's: +x right, +y up, +z towards the user, in mm.
#include <fmt/format.h>

#include <atomic>
#include <cmath>

#include "core/error.hpp"
#include "haptics/dynamic_library.hpp"
#include "haptics/find_devices.hpp"
#include "haptics/realtime.hpp"
#include "haptics/seqlock.hpp"

namespace palpate::haptics {

namespace {

using Handle = unsigned;  // HHD
constexpr Handle kInvalid = 0xffffffffU;
constexpr unsigned kButtons = 0x2000, kPosition = 0x2050, kVelocity = 0x2051;
constexpr unsigned kModel = 0x2501, kSerial = 0x2504;
constexpr unsigned kMaxStiffness = 0x2602, kMaxForce = 0x2603;
constexpr unsigned kForce = 0x2700, kForceOutput = 0x4000;
constexpr unsigned kContinue = 1;
constexpr unsigned short kPriority = 0x7fff;   // default of the library
constexpr std::int64_t kOldForce = 5'000'000;  // [ns] a force older than this is not put out

struct ErrorInfo {
  unsigned code;
  int internal;
  Handle handle;
};
using Callback = unsigned (*)(void*);

struct Hd {
  DynamicLibrary library;
  Handle (*init)(const char*) = nullptr;
  void (*disable)(Handle) = nullptr;
  void (*make_current)(Handle) = nullptr;
  void (*begin)(Handle) = nullptr;
  void (*end)(Handle) = nullptr;
  void (*get_doubles)(unsigned, double*) = nullptr;
  void (*get_integers)(unsigned, int*) = nullptr;
  const char* (*get_string)(unsigned) = nullptr;
  void (*set_doubles)(unsigned, const double*) = nullptr;
  void (*enable)(unsigned) = nullptr;
  ErrorInfo (*error)() = nullptr;
  const char* (*error_text)(unsigned) = nullptr;
  unsigned long (*schedule)(Callback, void*, unsigned short) = nullptr;
  void (*unschedule)(unsigned long) = nullptr;
  void (*start)() = nullptr;
  void (*stop)() = nullptr;

  explicit Hd(const FindOptions& options) : library(options.hd_libraries) {
    library.take("hdInitDevice", init);
    library.take("hdDisableDevice", disable);
    library.take("hdMakeCurrentDevice", make_current);
    library.take("hdBeginFrame", begin);
    library.take("hdEndFrame", end);
    library.take("hdGetDoublev", get_doubles);
    library.take("hdGetIntegerv", get_integers);
    library.take("hdGetString", get_string);
    library.take("hdSetDoublev", set_doubles);
    library.take("hdEnable", enable);
    library.take("hdGetError", error);
    library.take("hdGetErrorString", error_text);
    library.take("hdScheduleAsynchronous", schedule);
    library.take("hdUnschedule", unschedule);
    library.take("hdStartScheduler", start);
    library.take("hdStopScheduler", stop);
  }
  [[nodiscard]] std::string problem() const {
    const std::string p = library.problem();
    return p.empty() ? p : p + "; install 3D Systems' OpenHaptics and the Touch driver";
  }
};

class Touch final : public Device {
 public:
  Touch(Hd hd, const std::string& configuration) : hd_(std::move(hd)) {
    handle_ = hd_.init(configuration.empty() ? nullptr : configuration.c_str());
    const ErrorInfo failure = hd_.error();
    if (handle_ == kInvalid || failure.code != 0)
      throw InputError(fmt::format(
          "touch: the device does not open ({}); pair it with the vendor's set-up program",
          text_of(failure.code)));
    hd_.make_current(handle_);
    describe_device();
    hd_.enable(kForceOutput);
    job_ = hd_.schedule(&Touch::on_frame, this, kPriority);
    hd_.start();
    if (const ErrorInfo e = hd_.error(); e.code != 0) {
      close();
      throw InputError(fmt::format("touch: the scheduler does not start ({})", text_of(e.code)));
    }
  }
  ~Touch() override { close(); }
  Touch(const Touch&) = delete;
  Touch& operator=(const Touch&) = delete;

  const DeviceInfo& info() const override { return info_; }

  DeviceStatus read(DeviceSample& sample) noexcept override {
    if (error_.load(std::memory_order_relaxed) != 0) return DeviceStatus::lost;
    if (sample_.number() < 2) return DeviceStatus::waiting;
    sample = sample_.load();
    return DeviceStatus::ok;
  }
  DeviceStatus write(const Vec3& force) noexcept override {
    force_.store({force, monotonic_ns()});
    return error_.load(std::memory_order_relaxed) != 0 ? DeviceStatus::lost : DeviceStatus::ok;
  }
  void release() noexcept override { muted_at_.store(monotonic_ns(), std::memory_order_relaxed); }
  std::string trouble() const override {
    const unsigned e = error_.load();
    return e ? text_of(e) : std::string();
  }

 private:
  struct TimedForce {
    Vec3 force = Vec3::Zero();
    std::int64_t time_ns = 0;
  };

  std::string text_of(unsigned code) const {
    const char* text = hd_.error_text(code);
    return fmt::format("{} [0x{:04x}]", text ? text : "error", code);
  }
  void describe_device() {
    const char* model = hd_.get_string(kModel);
    const char* serial = hd_.get_string(kSerial);
    info_.backend = "touch";
    info_.name = model ? model : "3D Systems Touch";
    info_.serial = serial ? serial : "";
    const bool strong = info_.name.find("Touch X") != std::string::npos ||
                        info_.name.find("Desktop") != std::string::npos;
    info_.limits = *limits_of(strong ? "3D Systems Touch X" : "3D Systems Touch");
    double reported = 0;
    hd_.get_doubles(kMaxForce, &reported);
    if (std::isfinite(reported) && reported > 0) info_.limits.peak_force = reported;
    reported = 0;
    hd_.get_doubles(kMaxStiffness, &reported);
    if (std::isfinite(reported) && reported > 0) info_.limits.stiffness = reported;
    (void)hd_.error();  // a model that does not tell its limits keeps the table's
  }

  // The library's thread, once per frame.
  static unsigned on_frame(void* self) {
    static_cast<Touch*>(self)->frame();
    return kContinue;
  }
  void frame() {
    hd_.begin(handle_);
    double p[3] = {}, v[3] = {};
    int buttons = 0;
    hd_.get_doubles(kPosition, p);
    hd_.get_doubles(kVelocity, v);
    hd_.get_integers(kButtons, &buttons);
    const TimedForce wish = force_.load();
    const bool valid = monotonic_ns() - wish.time_ns < kOldForce &&
                       wish.time_ns > muted_at_.load(std::memory_order_relaxed);
    const Vec3 f = valid ? wish.force : Vec3::Zero();
    const double force[3] = {f.x(), f.y(), f.z()};
    hd_.set_doubles(kForce, force);
    hd_.end(handle_);
    if (const ErrorInfo e = hd_.error(); e.code != 0) {
      // 0x02xx are warnings of force and temperature: the library has cut the force itself.
      if ((e.code & 0xff00U) != 0x0200U) error_.store(e.code, std::memory_order_relaxed);
      return;
    }
    DeviceSample s;
    s.position = Vec3(p[0], p[1], p[2]);
    s.velocity = Vec3(v[0], v[1], v[2]);
    s.has_velocity = true;
    s.buttons = static_cast<std::uint32_t>(buttons);
    s.number = ++frames_;
    sample_.store(s);
  }
  void close() {
    hd_.stop();
    hd_.unschedule(job_);
    hd_.disable(handle_);
  }

  Hd hd_;
  DeviceInfo info_;
  Handle handle_ = kInvalid;
  unsigned long job_ = 0;
  std::uint64_t frames_ = 0;
  SeqLock<DeviceSample> sample_;
  SeqLock<TimedForce> force_;
  std::atomic<std::int64_t> muted_at_{0};
  std::atomic<unsigned> error_{0};
};

}  // namespace

std::unique_ptr<Device> open_touch(const std::string& configuration, const FindOptions& options) {
  Hd hd(options);
  if (const std::string problem = hd.problem(); !problem.empty())
    throw InputError("touch: " + problem);
  return std::make_unique<Touch>(std::move(hd), configuration);
}

std::vector<DeviceFinding> find_touch(const FindOptions& options) {
  try {
    const auto device = open_touch("", options);
    return {{"touch", device->info().name, true, describe(device->info())}};
  } catch (const InputError& e) {
    std::string why = e.what();
    if (why.starts_with("touch: ")) why.erase(0, 7);
    return {{"touch", "3D Systems Touch, Touch X", false, why}};
  }
}

}  // namespace palpate::haptics
