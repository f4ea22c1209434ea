// SPDX-License-Identifier: GPL-3.0-or-later
#include "apps/pipeline.hpp"

#include <fmt/format.h>

#include <tbb/global_control.h>
#include <utility>

#include <algorithm>
#include <cmath>
#include <limits>

#include "apps/describe.hpp"
#include "apps/survey.hpp"
#include "core/error.hpp"
#include "core/version.hpp"
#include "io/assets.hpp"
#include "landmarks/complete.hpp"
#include "landmarks/regions.hpp"
#include "stiffness/survey.hpp"
#include "surface/query.hpp"

namespace palpate::app {

/// The unit of that many millimetres; nothing for another number, such as 0.
static std::optional<LengthUnit> unit_of(double mm) {
  for (const LengthUnit u :
       {LengthUnit::mm, LengthUnit::cm, LengthUnit::dm, LengthUnit::m, LengthUnit::inch})
    if (mm == millimetres(u)) return u;
  return {};
}

/// Scales the scan to mm by its unit and makes the working surface.
static void repair(PreparedScan& scan, const PipelineOptions& options, const Progress& progress,
                   StageClock& clock) {
  scan.scan_mm =
      transformed(scan.scan.mesh, millimetres(scan.unit) * Mat3::Identity(), Vec3::Zero());
  scan.working = clock.run("repair", [&] {
    return surface::make_working_surface(scan.scan_mm, options.repair, progress);
  });
}

PreparedScan prepare_scan(const std::filesystem::path& path, const PipelineOptions& options,
                          const Progress& progress, StageClock& clock) {
  PreparedScan prepared;
  prepared.file_name = path.filename().string();
  prepared.scan = clock.run("read", [&] { return io::read_scan(path); });
  if (const auto said = unit_of(prepared.scan.unit_mm); said && options.unit.empty()) {
    prepared.unit = *said;
  } else if (options.unit.empty()) {
    const io::UnitGuess guess = io::guess_unit(prepared.scan.mesh);
    prepared.unit = guess.unit;
    prepared.unit_certain = guess.certain;
    prepared.other_unit = guess.other;
  } else {
    prepared.unit = length_unit(options.unit).value();  // checked by the command line
  }
  try {
    repair(prepared, options, progress, clock);
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
  return prepared;
}

/// Normals of the user's vertices: from their own triangles where these agree with the working
/// surface, else from the working surface (points without triangles, inverted winding).
static std::vector<Vec3> skin_normals(const std::vector<Vec3>& points,
                                      const std::vector<Triangle>& triangles,
                                      const HeadSurface& head) {
  std::vector<Vec3> own = vertex_normals({points, triangles});
  const std::vector<Vec3> working = vertex_normals(head.skin);
  const surface::SurfaceQuery query(head.skin);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const surface::ClosestPoint c = query.closest(points[i]);
    Vec3 n = Vec3::Zero();
    for (int k = 0; k < 3; ++k) n += c.barycentric[k] * working[head.skin.triangles[c.triangle][k]];
    if (own[i].dot(n) <= 0.5 * n.norm()) own[i] = n.normalized();
  }
  return own;
}

/// Finds the face; where there is no head behind it, completes the head and looks again.
static landmarks::Detection detect(const PreparedScan& scan, const landmarks::DetectOptions& detect,
                                   double edge, const Progress& progress,
                                   std::optional<landmarks::CompletedFace>& completed) {
  if (scan.known_skull) return landmarks::detect_landmarks(scan.working.mesh, detect, progress);
  landmarks::FoundFace face = landmarks::find_face(scan.working.mesh, detect, progress);
  if (!face.alone) return face.detection;
  const SurfaceMesh whole = io::read_scan(io::data_folder() / "head.ply").mesh;
  completed = landmarks::complete_face(scan.working.mesh, scan.working.filled, face.detection,
                                       whole, edge, progress);
  landmarks::Detection found = landmarks::detect_landmarks(completed->skin, detect, progress);
  landmarks::drop_unseen(found.landmarks, *completed);
  found.warnings.insert(
      found.warnings.begin(),
      fmt::format("the scan is a face without the back of its head: {:.0f} % of the skin was "
                  "completed from the bundled head, bent to this face; the bone there is a guess, "
                  "and vertices that feel it are marked",
                  100 * completed->completed_share));
  return found;
}

/// A wrap spans the eyes and the wings of the nose: what was found on it can be a finger's breadth
/// off without looking wrong.
static void warn_of_a_coarse_wrap(const surface::RepairReport& repair,
                                  std::vector<std::string>& warnings) {
  constexpr double kCoarse = 2;  // [mm]; other working surfaces lie within 0.3 to 0.7 mm
  if (repair.wrapped && repair.deviation_p95_mm > kCoarse)
    warnings.push_back(
        fmt::format("the scan passes through itself and could only be wrapped: its points lie up "
                    "to {:.1f} mm (95 %) off the skin that was used; check the landmarks",
                    repair.deviation_p95_mm));
}

/// What the search is told, in mm.
static landmarks::DetectOptions wanted_of(const PreparedScan& scan,
                                          const PipelineOptions& options) {
  landmarks::DetectOptions wanted = options.landmarks;
  for (auto& [name, position] : wanted.given) position *= millimetres(scan.unit);
  wanted.scan = &scan.scan_mm;
  return wanted;
}

/// A face can be told from no face, a unit's guess cannot: what has no face in one unit is looked
/// at in the next.
static landmarks::Detection detect_in_either_unit(
    PreparedScan& scan, const PipelineOptions& options, const Progress& progress, StageClock& clock,
    std::optional<landmarks::CompletedFace>& completed) {
  const auto look = [&] {
    return clock.run("landmarks", [&] {
      return detect(scan, wanted_of(scan, options), options.repair.target_edge, progress,
                    completed);
    });
  };
  try {
    return look();
  } catch (const InputError& error) {
    if (scan.other_unit) try {
        scan.unit = *std::exchange(scan.other_unit, std::nullopt);
        repair(scan, options, progress, clock);
        return look();
      } catch (const InputError&) {  // the likelier unit's reason is the one to tell
      }
    throw InputError(fmt::format("{}: {}", scan.file_name, error.what()));
  }
}

LocatedHead locate_head(PreparedScan& scan, const PipelineOptions& options,
                        const Progress& progress, StageClock& clock) {
  LocatedHead located;
  std::optional<landmarks::CompletedFace> completed;
  located.detection = detect_in_either_unit(scan, options, progress, clock, completed);
  const landmarks::DetectOptions wanted = wanted_of(scan, options);
  warn_of_a_coarse_wrap(scan.working.report, located.detection.warnings);
  for (const auto& [name, position] : wanted.given)  // to the last bit, whatever turned in between
    located.detection.landmarks[name] = {position, 1};
  const HeadFrame& frame = located.detection.frame;
  HeadSurface& head = located.head;
  head.skin = transformed(completed ? completed->skin : scan.working.mesh, frame.rotation,
                          -(frame.rotation * frame.origin));
  head.filled = completed ? completed->filled : scan.working.filled;
  head.mouth_opening = located.detection.mouth_opening;
  for (const auto& [name, mark] : located.detection.landmarks)
    head.landmarks[name] = {frame.to_head(mark.position), mark.confidence};
  head.region =
      landmarks::skin_regions(head.skin.points, vertex_normals(head.skin), head.landmarks);

  if (scan.known_skull)
    located.known_skull =
        transformed(*scan.known_skull, frame.rotation, -(frame.rotation * frame.origin));
  located.points.reserve(scan.scan_mm.points.size());
  for (const Vec3& p : scan.scan_mm.points) located.points.push_back(frame.to_head(p));
  located.normals = skin_normals(located.points, scan.scan_mm.triangles, head);
  located.region = landmarks::skin_regions(located.points, located.normals, head.landmarks);
  return located;
}

SkullTemplate load_template(const PipelineOptions& options) {
  return io::read_skull_template(options.skull_template.empty()
                                     ? io::data_folder() / "skull_template.ply"
                                     : options.skull_template);
}
std::vector<TissueDepth> load_depths(const PipelineOptions& options) {
  return io::read_tissue_depths(options.depth_table.empty() ? io::data_folder() / "tissue_depth.csv"
                                                            : options.depth_table);
}

/// A lab's own skull: any closed surface in the scan's frame, [mm]; no landmarks, so no depth rows.
static SkullFit own_skull(const LocatedHead& located, const PipelineOptions& options) {
  const io::Scan scan = io::read_scan(options.own_skull);
  const HeadFrame& frame = located.detection.frame;
  SkullFit fit;
  fit.mesh = transformed(scan.mesh, frame.rotation, -(frame.rotation * frame.origin));
  fit.region.assign(fit.mesh.points.size(), SkullRegion::none);
  fit.warnings.push_back(
      fmt::format("skull taken from {}, not fitted", options.own_skull.filename().string()));
  return fit;
}

/// Out of the image that the skin came from.
static SkullFit known_skull(const SurfaceMesh& mesh) {
  SkullFit fit;
  fit.mesh = mesh;
  fit.region.assign(mesh.points.size(), SkullRegion::none);
  fit.statistics["from_image"] = 1;
  return fit;
}

SkullFit make_skull(const LocatedHead& located, const PipelineOptions& options,
                    const Progress& progress, StageClock& clock) {
  return clock.run("skull", [&] {
    if (!options.own_skull.empty()) return own_skull(located, options);
    if (located.known_skull) return known_skull(*located.known_skull);
    return skull::fit_skull(located.head, load_template(options), load_depths(options), options.fit,
                            progress);
  });
}

/// Whether the map is made on the working skin and carried to the user's many vertices.
static bool carried(const LocatedHead& located, const PipelineOptions& options) {
  constexpr std::size_t kMany = 2;  // times the working skin's points: pressing each tells no more
  return options.sweep.mode == stiffness::SweepMode::fast &&
         located.points.size() > kMany * located.head.skin.points.size();
}

std::vector<double> depth_below(const LocatedHead& located, const SkullFit& skull,
                                const PipelineOptions& options, const Progress& progress) {
  const stiffness::SkinPoints points{located.points, located.region};
  const HeadSurface& head = located.head;
  if (!carried(located, options))
    return stiffness::survey(head, skull, points, options.sweep, progress).depth;
  const StiffnessMap coarse =
      stiffness::survey(head, skull, {head.skin.points, head.region}, options.sweep, progress);
  return stiffness::transfer(coarse, head, skull, points, options.sweep.organs).depth;
}

MappedHead make_map(const LocatedHead& located, const SkullFit& skull,
                    const PipelineOptions& options, const Progress& progress, StageClock& clock) {
  MappedHead mapped;
  const stiffness::SkinPoints points{located.points, located.region};
  stiffness::SweepOptions sweep = options.sweep;
  sweep.published.max_volume = options.tissue.max_volume;
  const bool published = sweep.mode == stiffness::SweepMode::published;
  const bool carry = carried(located, options);
  mapped.sweep = clock.run("sweep", [&] {
    return carry ? stiffness::sweep(located.head, skull, sweep, progress)
                 : stiffness::sweep(located.head, skull, points, sweep, progress);
  });
  if (options.sweep.shard_count > 1) return mapped;
  if (carry)
    mapped.map = clock.run("transfer", [&] {
      return stiffness::transfer(mapped.sweep.map, located.head, skull, points, sweep.organs);
    });
  else
    mapped.map = mapped.sweep.map;
  if (published) return mapped;  // the error bars are those of a sphere
  mapped.spread = clock.run("spread", [&] {
    return stiffness::map_spread(mapped.map, located.head, skull, located.points, options.spread,
                                 progress);
  });
  return mapped;
}

TouchableHead assemble(const PreparedScan& scan, const LocatedHead& located, const SkullFit& skull,
                       const MappedHead& mapped, const std::optional<TissueMesh>& tissue,
                       const PipelineOptions& options, const std::vector<std::string>& warnings) {
  const HeadFrame& frame = located.detection.frame;
  TouchableHead head;
  head.skin = scan.scan.mesh;
  head.unit_mm = millimetres(scan.unit);
  head.frame = frame;
  head.landmarks = located.detection.landmarks;
  head.skull = transformed(skull.mesh, frame.rotation.transpose(), frame.origin);
  head.skull_region = skull.region;
  head.skull_spread = skull.spread;
  head.spread = mapped.spread;
  head.completed = stiffness::rests_on_completed(mapped.map, located.head, located.points);
  head.depths = skull.depths;
  head.map = mapped.map;
  head.provenance = {
      {"palpate", kVersion},
      {"input",
       {{"file", scan.file_name},
        {"format", scan.scan.format},
        {"sha256", scan.scan.sha256},
        {"vertices", scan.scan.mesh.points.size()},
        {"triangles", scan.scan.mesh.triangles.size()},
        {"unit", std::string(name(scan.unit))},
        {"unit_given", !options.unit.empty()},
        {"unit_certain", scan.unit_certain}}},
      {"options", describe(options)},
      {"repair", describe(scan.working.report)},
      {"fit", skull.statistics},
      {"sweep", mapped.sweep.statistics},
      {"warnings", warnings},
  };
  if (!mapped.sweep.published.empty())
    head.provenance["published_sites"] = describe(mapped.sweep.published);
  if (tissue) head.provenance["tissue_mesh"] = tissue->quality;
  if (!scan.image_notes.empty()) head.provenance["image"] = scan.image_notes;
  return head;
}

}  // namespace palpate::app
