// SPDX-License-Identifier: Apache-2.0
// Force Dimension's omega, delta, sigma and lambda, and the Novint Falcon, through the vendor's DHD
// library. The prototypes below are our own, from the SDK's documentation; the device id is always
// given. The SDK's axes are +x out of the device towards the user, +y to the user's right, +z up,
// in metres.
#include <fmt/format.h>

#include <cctype>
#include <cmath>

#include "core/error.hpp"
#include "haptics/dynamic_library.hpp"
#include "haptics/find_devices.hpp"

namespace palpate::haptics {

namespace {

constexpr double kMillimetres = 1000;  // in one metre
constexpr int kOldestSdk = 3;
constexpr int kTimeguard = 1;  // dhdGetPosition: the last sample again, asked for too soon

struct Dhd {
  DynamicLibrary library;
  void (*version)(int*, int*, int*, int*) = nullptr;
  int (*device_count)() = nullptr;
  int (*open)(char) = nullptr;
  int (*close)(char) = nullptr;
  int (*position)(double*, double*, double*, char) = nullptr;
  int (*velocity)(double*, double*, double*, char) = nullptr;
  unsigned (*buttons)(char) = nullptr;
  int (*set_force)(double, double, double, char) = nullptr;
  int (*enable_force)(unsigned char, char) = nullptr;
  double (*max_force)(char) = nullptr;
  const char* (*system_name)(char) = nullptr;
  const char* (*last_error)() = nullptr;
  int (*serial)(unsigned short*, char) = nullptr;

  explicit Dhd(const FindOptions& options) : library(options.dhd_libraries) {
    library.take("dhdGetSDKVersion", version);
    library.take("dhdGetDeviceCount", device_count);
    library.take("dhdOpenID", open);
    library.take("dhdClose", close);
    library.take("dhdGetPosition", position);
    library.take("dhdGetLinearVelocity", velocity);
    library.take("dhdGetButtonMask", buttons);
    library.take("dhdSetForce", set_force);
    library.take("dhdEnableForce", enable_force);
    library.take("dhdGetMaxForce", max_force);
    library.take("dhdGetSystemName", system_name);
    library.take("dhdErrorGetLastStr", last_error);
    library.take_if_there("dhdGetSerialNumber", serial);
  }
  /// Empty, or why the library cannot be used.
  [[nodiscard]] std::string problem() const {
    if (std::string p = library.problem(); !p.empty())
      return p + "; install the Force Dimension SDK and put its lib folder on LD_LIBRARY_PATH";
    int major = 0, minor = 0, release = 0, revision = 0;
    version(&major, &minor, &release, &revision);
    if (major < kOldestSdk)
      return fmt::format("{} is SDK {}.{}.{}; version {} or later is needed", library.name(), major,
                         minor, release, kOldestSdk);
    return {};
  }
};

// The SDK's names differ in case and in the number of axes ("omega.7", "FALCON"): the family says
// the row. An unknown one gets the least of its maker's: sigma.7's.
DeviceLimits limits_of_model(std::string name) {
  for (char& c : name) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  for (const char* family : {"falcon", "omega", "delta", "sigma", "lambda"})
    if (name.find(family) != std::string::npos) return limits_of(family).value();
  return limits_of("sigma").value();
}

class ForceDimension final : public Device {
 public:
  ForceDimension(Dhd dhd, int index) : dhd_(std::move(dhd)) {
    const int opened = dhd_.open(static_cast<char>(index));
    if (opened < 0)
      throw InputError(
          fmt::format("force-dimension:{} does not open: {}; is it switched on, and may "
                      "this user open USB devices (udev rule)?",
                      index, dhd_.last_error()));
    id_ = static_cast<char>(opened);
    const char* name = dhd_.system_name(id_);
    info_.backend = "force-dimension";
    info_.name = name ? name : "Force Dimension device";
    if (dhd_.serial) {
      unsigned short number = 0;
      if (dhd_.serial(&number, id_) >= 0) info_.serial = std::to_string(number);
    }
    info_.limits = limits_of_model(info_.name);
    const double reported = dhd_.max_force(id_);
    if (std::isfinite(reported) && reported > 0) info_.limits.peak_force = reported;
    if (dhd_.enable_force(1, id_) < 0) {
      const std::string why = dhd_.last_error();
      dhd_.close(id_);
      throw InputError(fmt::format("force-dimension:{} does not enable its force: {}", index, why));
    }
  }
  ~ForceDimension() override {
    dhd_.set_force(0, 0, 0, id_);
    dhd_.enable_force(0, id_);
    dhd_.close(id_);
  }
  ForceDimension(const ForceDimension&) = delete;
  ForceDimension& operator=(const ForceDimension&) = delete;

  const DeviceInfo& info() const override { return info_; }

  DeviceStatus read(DeviceSample& sample) noexcept override {
    double x = 0, y = 0, z = 0;
    const int got = dhd_.position(&x, &y, &z, id_);
    if (got < 0) return DeviceStatus::lost;
    sample.position = kMillimetres * Vec3(y, z, x);
    sample.has_velocity = dhd_.velocity(&x, &y, &z, id_) >= 0;
    if (sample.has_velocity) sample.velocity = kMillimetres * Vec3(y, z, x);
    sample.buttons = dhd_.buttons(id_);
    if (got != kTimeguard) ++number_;
    sample.number = number_;
    return DeviceStatus::ok;
  }
  DeviceStatus write(const Vec3& f) noexcept override {
    return dhd_.set_force(f.z(), f.x(), f.y(), id_) < 0 ? DeviceStatus::lost : DeviceStatus::ok;
  }
  void release() noexcept override { dhd_.set_force(0, 0, 0, id_); }
  std::string trouble() const override {
    const char* text = dhd_.last_error();
    return text ? text : "";
  }

 private:
  Dhd dhd_;
  DeviceInfo info_;
  char id_ = 0;
  std::uint64_t number_ = 0;
};

}  // namespace

std::unique_ptr<Device> open_force_dimension(int index, const FindOptions& options) {
  Dhd dhd(options);
  if (const std::string problem = dhd.problem(); !problem.empty())
    throw InputError("force-dimension: " + problem);
  return std::make_unique<ForceDimension>(std::move(dhd), index);
}

std::vector<DeviceFinding> find_force_dimension(const FindOptions& options) {
  const std::string models = "Force Dimension omega, delta, sigma, lambda; Novint Falcon";
  const Dhd dhd(options);
  if (const std::string problem = dhd.problem(); !problem.empty())
    return {{"force-dimension", models, false, problem}};
  const int count = dhd.device_count();
  if (count <= 0)
    return {
        {"force-dimension", models, false,
         fmt::format("{} is there, but no device is connected{}; check power and USB cable",
                     dhd.library.name(), count < 0 ? fmt::format(" ({})", dhd.last_error()) : "")}};
  std::vector<DeviceFinding> found;
  for (int i = 0; i < count; ++i) {
    const std::string backend = fmt::format("force-dimension:{}", i);
    try {
      const auto device = open_force_dimension(i, options);
      found.push_back({backend, device->info().name, true, describe(device->info())});
    } catch (const InputError& e) {
      found.push_back({backend, models, false, e.what()});
    }
  }
  return found;
}

}  // namespace palpate::haptics
