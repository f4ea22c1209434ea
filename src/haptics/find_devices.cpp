// SPDX-License-Identifier: Apache-2.0
#include "haptics/find_devices.hpp"

#include <fmt/format.h>

#include <charconv>

#include "core/error.hpp"

namespace palpate::haptics {

namespace {

int number_of(std::string_view text, std::string_view spec) {
  if (text.empty()) return 0;
  int n = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), n);
  if (error != std::errc{} || end != text.data() + text.size() || n < 0)
    throw InputError(fmt::format("device '{}': give a number from 0 after the colon", spec));
  return n;
}

std::unique_ptr<Device> open_first(const FindOptions& options) {
  std::string reasons;
  for (const DeviceFinding& f : list_devices(options)) {
    if (f.backend == "simulated") continue;
    if (f.usable) return open_device(f.backend, options);
    reasons += fmt::format("; {}: {}", f.backend, f.detail);
  }
  throw InputError("no haptic device was found" + reasons);
}

}  // namespace

std::string describe(const DeviceInfo& info) {
  std::string out =
      fmt::format("{:.1f} N, {:.1f} N/mm", info.limits.peak_force, info.limits.stiffness);
  if (!info.serial.empty()) out += ", serial " + info.serial;
  return out;
}

std::vector<DeviceFinding> list_devices(const FindOptions& options) {
  std::vector<DeviceFinding> all = {
      {"simulated", "simulated hand", true, "follows a path by itself; no hardware"}};
  for (auto* find : {find_force_dimension, find_inverse3, find_touch})
    for (DeviceFinding& f : find(options)) all.push_back(std::move(f));
  return all;
}

std::unique_ptr<Device> open_device(std::string_view spec, const FindOptions& options) {
  const std::size_t colon = spec.find(':');
  const std::string_view backend = spec.substr(0, colon);
  const std::string_view rest = colon == std::string_view::npos ? "" : spec.substr(colon + 1);
  if (backend == "auto") return open_first(options);
  if (backend == "force-dimension") return open_force_dimension(number_of(rest, spec), options);
  if (backend == "inverse3") return open_inverse3(std::string(rest), options);
  if (backend == "touch") return open_touch(std::string(rest), options);
  throw InputError(
      fmt::format("there is no device '{}'; give auto, force-dimension, inverse3 or touch", spec));
}

}  // namespace palpate::haptics
