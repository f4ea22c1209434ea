// SPDX-License-Identifier: Apache-2.0
#include "io/assets.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

#include "core/error.hpp"
#include "io/csv.hpp"
#include "io/readers.hpp"
#include "io/text_cursor.hpp"

namespace palpate::io {
namespace fs = std::filesystem;

fs::path data_folder() {
  std::error_code ignored;
  if (const char* set = std::getenv("PALPATE_DATA"); set && *set) {
    if (fs::is_directory(set, ignored)) return set;
    throw InputError(fmt::format("PALPATE_DATA={} is not a folder; unset it or correct it", set));
  }
  const fs::path program = fs::read_symlink("/proc/self/exe", ignored);
  const fs::path installed = program.parent_path().parent_path() / "share" / "palpate";
  if (fs::is_directory(installed, ignored)) return installed;
  const fs::path built = PALPATE_SOURCE_DATA;
  if (fs::is_directory(built, ignored)) return built;
  throw InputError(fmt::format("{} and {} are not there; set PALPATE_DATA to the data folder",
                               installed.string(), built.string()));
}

namespace {

using nlohmann::json;

class TemplateReader {
 public:
  explicit TemplateReader(const fs::path& path) : source_{path.string(), {}, {}} {
    const std::string bytes = load_bytes(path);
    source_.bytes = bytes;
    try {
      json_ = json::parse(bytes);
    } catch (const json::exception& error) {
      fail("JSON", error.what());
    }
    if (!json_.is_object()) fail("JSON", "is not an object");
    if (json_.value("unit", json("mm")) != "mm") fail("unit", "is not mm");
  }

  void fill(SkullTemplate& skull) const {
    const auto name = json_.find("name");
    if (name == json_.end() || !name->is_string()) fail("name", "is missing");
    skull.name = name->get<std::string>();
    for (const auto& [code, entry] : object("landmarks").items()) {
      if (!entry.is_object()) fail(code, "is not an object");
      SkullLandmark landmark{vector(entry, "position", code), vector(entry, "normal", code)};
      if (std::abs(landmark.normal.norm() - 1) > 1e-3) fail(code, "its normal has not length 1");
      landmark.normal.normalize();
      skull.landmarks[code] = landmark;
    }
    const json& points = object("registration_points");
    for (const auto& item : points.items())
      skull.registration_points[item.key()] = vector(points, item.key(), "registration_points");
  }

 private:
  [[noreturn]] void fail(std::string_view where, std::string_view what) const {
    source_.fail(where, what, "rebuild the data with `make assets`");
  }
  const json& object(const char* key) const {
    const auto found = json_.find(key);
    if (found == json_.end() || !found->is_object()) fail(key, "is not an object");
    return *found;
  }
  Vec3 vector(const json& parent, const std::string& key, const std::string& where) const {
    const auto found = parent.find(key);
    if (found == parent.end() || !found->is_array() || found->size() != 3)
      fail(where, fmt::format("'{}' has not three numbers", key));
    Vec3 v;
    for (int k = 0; k < 3; ++k) {
      if (!(*found)[k].is_number()) fail(where, fmt::format("'{}' is not numeric", key));
      v[k] = (*found)[k].get<double>();
    }
    return v;
  }

  Source source_;
  json json_;
};

}  // namespace

SkullTemplate read_skull_template(const fs::path& ply) {
  const std::string bytes = load_bytes(ply);
  const Source source{ply.string(), bytes, ply.parent_path()};
  ParsedMesh parsed = parse_ply(source, "region");
  SkullTemplate skull;
  skull.mesh = std::move(parsed.mesh);
  for (std::size_t i = 0; i < parsed.property.size(); ++i) {
    const double r = parsed.property[i];
    if (!(r >= 0 && r < kSkullRegionNames.size()) || r != std::floor(r))
      source.fail(fmt::format("vertex {}", i), fmt::format("{} is not a skull region", r),
                  "rebuild the data with `make assets`");
    skull.region.push_back(static_cast<SkullRegion>(static_cast<int>(r)));
  }
  TemplateReader(fs::path(ply).replace_extension(".json")).fill(skull);
  return skull;
}

std::vector<TissueDepth> read_tissue_depths(const fs::path& csv) {
  const std::string bytes = load_bytes(csv);
  const Source source{csv.string(), bytes, {}};
  const std::vector<CsvRow> rows = parse_csv(source);
  const std::vector<std::string> header = {"code",  "landmark",   "mean_mm",
                                           "sd_mm", "population", "source"};
  if (rows.empty() || rows[0].cells != header)
    source.fail("line 1", "the header is not code,landmark,mean_mm,sd_mm,population,source",
                "restore the table");
  std::vector<TissueDepth> depths;
  for (std::size_t r = 1; r < rows.size(); ++r) {
    const std::string where = fmt::format("line {}", rows[r].line);
    const std::vector<std::string>& cell = rows[r].cells;
    if (cell.size() != header.size())
      source.fail(where, fmt::format("{} columns instead of {}", cell.size(), header.size()),
                  "complete the row");
    const auto mean = parse_number(cell[2]);
    const auto sd = cell[3].empty() ? std::optional(0.0) : parse_number(cell[3]);
    if (cell[0].empty() || !mean || !sd || !(*mean > 0 && *mean < 100) || !(*sd >= 0 && *sd < 100))
      source.fail(where, "code, mean_mm or sd_mm is missing or out of range (0 to 100 mm)",
                  "correct the row");
    const auto same = [&](const TissueDepth& d) { return d.code == cell[0]; };
    if (std::any_of(depths.begin(), depths.end(), same))
      source.fail(where, fmt::format("{} is there twice", in_quotes(cell[0])), "remove one");
    depths.push_back({cell[0], cell[1], *mean, *sd, cell[5]});
  }
  return depths;
}

}  // namespace palpate::io
