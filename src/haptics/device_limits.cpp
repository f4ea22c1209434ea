// SPDX-License-Identifier: Apache-2.0
#include "haptics/device_limits.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>

namespace palpate::haptics {

namespace {

// Peak force, stiffness and damping as the open drivers of the devices limit them; makers' data
// sheets where they agree. 1 N s/m = 0.001 N s/mm. The Falcon's maker states 8.9 N peak. The Touch
// holds 0.88 N continuously. The Inverse3 reports its limits at run time: 10 N is unverified, and
// its stiffness and damping are set to the Falcon-class values. The last column is the position's
// resolution as the makers state it (400, 450 and 1100 dpi for the Falcon, Touch and Touch X).
constexpr std::array<DeviceLimits, 8> kDevices = {{
    {"Novint Falcon", 8.0, 3.0, 0.020, 40, 0.0635},
    {"Force Dimension omega.3", 12.0, 5.0, 0.030, 75, 0.01},
    {"Force Dimension sigma.7", 12.0, 4.0, 0.030, 75, 0.0015},
    {"Force Dimension lambda.7", 12.0, 8.0, 0.030, 112, 0.0015},
    {"Force Dimension delta.3", 20.0, 5.0, 0.030, 150, 0.03},
    {"3D Systems Touch", 3.3, 0.4, 0.004, 75, 0.055},
    {"3D Systems Touch X", 7.9, 1.0, 0.005, 100, 0.023},
    {"Haply Inverse3", 10.0, 3.0, 0.020, 0, 0.01},
}};

std::string lower(std::string_view text) {
  std::string out(text);
  for (char& c : out) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return out;
}

}  // namespace

std::span<const DeviceLimits> known_devices() {
  return kDevices;
}

std::optional<DeviceLimits> limits_of(std::string_view name) {
  const std::string wanted = lower(name);
  const DeviceLimits* match = nullptr;
  for (const DeviceLimits& d : kDevices) {
    const std::string known = lower(d.name);
    if (known == wanted) return d;
    if (wanted.empty() || known.find(wanted) == std::string::npos) continue;
    if (match) return std::nullopt;
    match = &d;
  }
  return match ? std::optional(*match) : std::nullopt;
}

DeviceLimits published_preset() {
  DeviceLimits falcon = kDevices[0];
  falcon.name = "Novint Falcon (published)";
  falcon.peak_force = 8.7;
  return falcon;
}

DeviceLimits unlimited() {
  return {"none", 100, 100, 1, 0};
}

double force_scale(const TouchModel& model, const DeviceLimits& limits) {
  double stiffest = 0;
  for (const double k : region_stiffness(model))
    if (std::isfinite(k)) stiffest = std::max(stiffest, k);
  double scale = 1;
  if (stiffest > 0) scale = std::min(scale, limits.stiffness / stiffest);
  return std::min(scale, limits.peak_force / model.curves.force.back());
}

}  // namespace palpate::haptics
