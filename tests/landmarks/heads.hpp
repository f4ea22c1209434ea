// SPDX-License-Identifier: GPL-3.0-or-later
// The bundled head as the tests of this folder use it: repaired once, turned as each test likes.
#pragma once
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <string>

#include "io/scan.hpp"
#include "landmarks/detect.hpp"
#include "surface/repair.hpp"

namespace palpate::landmarks {

struct KnownHead {
  SurfaceMesh scan;                   ///< [mm]
  SurfaceMesh skin;                   ///< [mm] working surface
  std::map<std::string, Vec3> truth;  ///< [mm]
};

inline const KnownHead& bundled_head() {
  static const KnownHead head = [] {
    const std::filesystem::path data = std::filesystem::path(PALPATE_SOURCE_DIR) / "data";
    KnownHead h;
    h.scan = io::read_scan(data / "head.ply").mesh;
    h.skin = surface::make_working_surface(h.scan).mesh;
    const auto doc = nlohmann::json::parse(std::ifstream(data / "head.json"));
    for (const auto& [name, p] : doc.at("landmarks").items()) {
      h.truth[name] = Vec3(p[0], p[1], p[2]);
    }
    return h;
  }();
  return head;
}

inline DetectOptions with_scan(const SurfaceMesh& scan) {
  DetectOptions options;
  options.scan = &scan;
  return options;
}

/// Largest error [mm] over the truth's points under x -> linear x + translation.
inline double largest_error(const Detection& found, const std::map<std::string, Vec3>& truth,
                            const Mat3& linear, const Vec3& translation) {
  double worst = 0;
  for (const auto& [name, p] : truth) {
    const auto at = found.landmarks.find(name);
    if (at == found.landmarks.end()) return 1e9;
    worst = std::max(worst, (at->second.position - (linear * p + translation)).norm());
  }
  return worst;
}

}  // namespace palpate::landmarks
