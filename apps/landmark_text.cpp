// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/landmark_text.hpp"

#include <fmt/format.h>

#include <locale>
#include <sstream>

#include "core/error.hpp"

namespace palpate::app {

std::string landmark_text(const LandmarkSet& landmarks, double unit_mm) {
  std::string out =
      "# Landmarks in the scan's own coordinates: state, name, x, y, z, confidence.\n"
      "# To move a point, change its numbers and its first word to \"fixed\", then run the same\n"
      "# command again. Lines that say \"found\" are found anew.\n";
  for (const auto& [name, mark] : landmarks) {
    const Vec3 p = mark.position / unit_mm;
    out += fmt::format("{} {} {} {} {} {:.2f}\n", mark.confidence >= 1 ? "fixed" : "found", name,
                       p.x(), p.y(), p.z(), mark.confidence);
  }
  return out;
}

std::map<std::string, Vec3> parse_landmark_text(const std::string& text, const std::string& name) {
  std::map<std::string, Vec3> fixed;
  std::istringstream lines(text);
  std::string line;
  for (int number = 1; std::getline(lines, line); ++number) {
    std::istringstream words(line);
    words.imbue(std::locale::classic());
    std::string state, mark;
    if (!(words >> state) || state[0] == '#') continue;
    Vec3 p;
    if ((state != "fixed" && state != "found") || !(words >> mark >> p.x() >> p.y() >> p.z()) ||
        !p.allFinite())
      throw InputError(
          fmt::format("{}: line {}: wanted \"fixed\" or \"found\", a name and three numbers; "
                      "correct it or delete the file",
                      name, number));
    if (state == "fixed") fixed[mark] = p;
  }
  return fixed;
}

}  // namespace palpate::app
