// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/words.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "plot/svg_writer.hpp"

namespace palpate::report {
namespace {

struct Pair {
  std::string_view from, to;
};
constexpr std::array<Pair, 13> kUnits = {{{"_mm3", "[mm³]"},
                                          {"_mm2", "[mm²]"},
                                          {"_n_per_mm", "[N/mm]"},
                                          {"_mm", "[mm]"},
                                          {"_deg", "[°]"},
                                          {"_kpa", "[kPa]"},
                                          {"_mpa", "[MPa]"},
                                          {"_percent", "[%]"},
                                          {"_share", "[-]"},
                                          {"_rel", "[-]"},
                                          {"_seconds", "[s]"},
                                          {"_n", "[N]"},
                                          {"_s", "[s]"}}};
// The codes of data/tissue_depth.csv.
constexpr std::array<Pair, 31> kLandmarks = {{{"op", "opisthocranion"},
                                              {"v", "vertex"},
                                              {"g", "glabella"},
                                              {"n", "nasion"},
                                              {"mn", "mid-nasal"},
                                              {"rhi", "rhinion"},
                                              {"ss", "subspinale"},
                                              {"mp", "mid-philtrum"},
                                              {"pr", "prosthion"},
                                              {"id", "infradentale"},
                                              {"sm", "supramentale"},
                                              {"pg", "pogonion"},
                                              {"gn", "gnathion"},
                                              {"me", "menton"},
                                              {"mso", "mid-supraorbital"},
                                              {"mio", "mid-infraorbital"},
                                              {"ac", "alar curvature"},
                                              {"go", "gonion"},
                                              {"zy", "zygion"},
                                              {"sC", "supra-canine"},
                                              {"iC", "infra-canine"},
                                              {"sM2", "supra-M2"},
                                              {"iM2", "infra-M2"},
                                              {"mr", "mid-ramus"},
                                              {"mmb", "mid-mandibular border"},
                                              {"sg", "supraglabella"},
                                              {"fe", "frontal eminence"},
                                              {"lo", "lateral orbit"},
                                              {"im", "inferior malar"},
                                              {"sgl", "supraglenoid"},
                                              {"mm", "mid-masseter"}}};

}  // namespace

std::string grouped(std::size_t count) {
  std::string digits = std::to_string(count), out;
  for (std::size_t i = 0; i < digits.size(); ++i) {
    if (i && (digits.size() - i) % 3 == 0) out += "\u202f";
    out += digits[i];
  }
  return out;
}

std::string plain_words(std::string_view key) {
  std::string out(key);
  std::replace(out.begin(), out.end(), '_', ' ');
  return out;
}

std::string with_unit(std::string_view key) {
  for (const auto& [suffix, unit] : kUnits)
    if (key.size() > suffix.size() && key.ends_with(suffix))
      return plain_words(key.substr(0, key.size() - suffix.size())) + " " + std::string(unit);
  return plain_words(key);
}

std::string fixed(double value, int decimals) {
  if (!std::isfinite(value)) return "–";
  const std::string text = fmt::format("{:.{}f}", value, decimals);
  const bool zero = text.find_first_not_of("-0.") == std::string::npos;
  return zero && text[0] == '-' ? text.substr(1) : text;
}

std::string plain_value(const nlohmann::json& v) {
  if (v.is_null()) return "–";
  if (v.is_string()) return v.get<std::string>();
  if (v.is_boolean()) return v.get<bool>() ? "yes" : "no";
  if (v.is_number_integer()) return fmt::format("{}", v.get<long long>());
  if (v.is_number()) return plot::number_text(v.get<double>(), 5);
  std::string out;
  if (v.is_array())
    for (const auto& item : v) out += (out.empty() ? "" : ", ") + plain_value(item);
  else
    for (const auto& [key, item] : v.items())
      out += (out.empty() ? "" : "; ") + plain_words(key) + " " + plain_value(item);
  return out.empty() ? "–" : out;
}

std::string landmark_name(std::string_view code) {
  std::string_view plain = code, side;
  for (const std::string_view s : {"_left", "_right"})
    if (code.ends_with(s)) plain = code.substr(0, code.size() - s.size()), side = s.substr(1);
  for (const auto& [known, spoken] : kLandmarks)
    if (known == plain)
      return side.empty() ? fmt::format("{} ({})", spoken, plain)
                          : fmt::format("{}, {} ({})", spoken, side, plain);
  return std::string(code);
}

}  // namespace palpate::report
