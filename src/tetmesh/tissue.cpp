// SPDX-License-Identifier: GPL-3.0-or-later
// Source 4.4.1: tetrahedra in two layers, bone inside the adapted skull and flesh between skull and
// skin; the freedom of eyes, nose and lips, which other organs carry, is taken away.
// TetGen (Si 2015) runs as a program of its own (docs/decisions/0002-tetgen-as-a-process.md).
#include "tetmesh/tissue.hpp"

#include <fmt/format.h>

#include <array>
#include <cmath>

#include "core/organs.hpp"
#include "surface/query.hpp"
#include "tetmesh/process.hpp"
#include "tetmesh/seeds.hpp"
#include "tetmesh/surface_checks.hpp"
#include "tetmesh/tetgen_files.hpp"

namespace palpate::tetmesh {
namespace {

constexpr double kExpectedSeconds = 8;  ///< [s] a head of 500 k tetrahedra; for the progress only

void check_options(const TissueOptions& o) {
  const auto require = [](bool ok, const char* text) {
    if (!ok) throw InputError(text);
  };
  require(o.radius_edge_ratio >= 1.2 && o.radius_edge_ratio < 100,
          "radius_edge_ratio must be from 1.2 to 100");
  require(o.min_dihedral >= 0 && o.min_dihedral <= 18, "min_dihedral must be 0 to 18 degrees");
  require(o.max_volume > 0 && std::isfinite(o.max_volume), "max_volume must be > 0 mm^3");
  require(o.max_bone_volume > 0 && std::isfinite(o.max_bone_volume),
          "max_bone_volume must be > 0 mm^3");
  require(o.no_bone_beyond > 0, "no_bone_beyond must be > 0 mm");
  require(o.time_limit > 0, "time_limit must be > 0 s");
}

std::vector<RegionSeed> region_seeds(const SurfaceMesh& skull, const surface::SurfaceQuery& skin,
                                     const surface::SurfaceQuery& bone, const TissueOptions& o) {
  std::vector<RegionSeed> seeds;
  seeds.push_back({point_in_flesh(skin, bone), static_cast<int>(TissueLabel::flesh), o.max_volume});
  for (const SurfaceMesh& piece : connected_pieces(skull)) {
    if (!(signed_volume(piece) > 0))
      throw InputError("skull has a hollow inside (an inward surface); use its outer hull only");
    seeds.push_back({point_in_bone(piece), static_cast<int>(TissueLabel::bone), o.max_bone_volume});
  }
  return seeds;
}

/// What TetGen's exit codes say (tetgen.h, terminatetetgen).
std::string_view reason(int exit_code) {
  switch (exit_code) {
    case 1:
      return "out of memory";
    case 3:
      return "the surfaces meet each other or themselves";
    case 4:
      return "a very small feature in the surfaces";
    case 5:
      return "two facets lie too close to each other";
    case 10:
      return "it could not read its input";
    default:
      return "internal error";
  }
}

TetgenResult run_tetgen(const SurfaceMesh& skin, const SurfaceMesh& skull,
                        std::span<const RegionSeed> seeds, const TissueOptions& o,
                        const Progress& progress) {
  const TemporaryFolder folder;
  const auto poly = folder.path() / "head.poly";
  const std::array<const SurfaceMesh*, 2> surfaces = {&skin, &skull};
  write_poly(poly, surfaces, seeds);
  // p: facets bound the volume; Y: keep them as they are; q: shape; A, a: per-region label, volume;
  // B, F: no boundary markers, no face file.
  const std::string switches = fmt::format("-pYq{}/{}AaBF", o.radius_edge_ratio, o.min_dihedral);
  const ProcessResult run = run_process(o.mesher, {switches, poly.string()}, folder.path() / "log",
                                        o.time_limit, kExpectedSeconds, progress, "tissue mesh");
  if (!run.found)
    throw InputError(
        fmt::format("the mesher '{}' was not found; install it: apt install tetgen", o.mesher));
  if (run.timed_out)
    throw SolveError(fmt::format("the mesher did not end within {} s (last line: {})", o.time_limit,
                                 run.last_line));
  if (run.exit_code != 0)
    throw SolveError(fmt::format("the mesher failed with code {} ({}): {}", run.exit_code,
                                 reason(run.exit_code), run.last_line));
  return read_tetgen(folder.path() / "head.1.node", folder.path() / "head.1.ele");
}

/// The mesher must have kept our points; their numbers are taken from us, bit for bit.
void restore_points(TetgenResult& result, const SurfaceMesh& skin, const SurfaceMesh& skull) {
  const std::size_t given = skin.points.size() + skull.points.size();
  if (result.nodes.size() < given) throw SolveError("the mesher dropped points of the surfaces");
  for (std::size_t i = 0; i < given; ++i) {
    const bool on_skin = i < skin.points.size();
    const Vec3& ours = on_skin ? skin.points[i] : skull.points[i - skin.points.size()];
    if (!(result.nodes[i] - ours).isZero(1e-9))
      throw SolveError(fmt::format("the mesher moved point {} of the {}",
                                   on_skin ? i : i - skin.points.size(),
                                   on_skin ? "skin" : "skull"));
    result.nodes[i] = ours;
  }
}

std::vector<TissueLabel> labels(const std::vector<int>& numbers) {
  std::vector<TissueLabel> out;
  out.reserve(numbers.size());
  for (const int n : numbers) {
    if (n != static_cast<int>(TissueLabel::flesh) && n != static_cast<int>(TissueLabel::bone))
      throw SolveError(
          fmt::format("the mesher left a region (number {}) that is neither flesh nor "
                      "bone: the surfaces are nested more than twice",
                      n));
    out.push_back(static_cast<TissueLabel>(n));
  }
  return out;
}

void hold(TissueMesh& mesh, const HeadSurface& head, const surface::SurfaceQuery& bone,
          double no_bone_beyond) {
  mesh.held.assign(mesh.nodes.size(), 0);
  for (std::size_t t = 0; t < mesh.tets.size(); ++t)
    if (mesh.label[t] == TissueLabel::bone)
      for (const auto node : mesh.tets[t]) mesh.held[node] = 1;
  const auto normals = vertex_normals(head.skin);
  double organs = 0, boneless = 0;
  for (std::size_t i = 0; i < head.skin.points.size(); ++i) {
    const bool carried = !head.region.empty() && is_organ(head.region[i]);
    const bool far = normals[i].isZero() ||
                     !bone.cast(head.skin.points[i], -normals[i], no_bone_beyond).has_value();
    organs += carried;
    boneless += far;
    if (carried || far) mesh.held[i] = 1;
  }
  mesh.quality["skin_held_organ"] = organs;
  mesh.quality["skin_held_no_bone"] = boneless;
}

}  // namespace

TissueMesh make_tissue_mesh(const HeadSurface& head, const SkullFit& skull,
                            const TissueOptions& options, const Progress& progress) {
  check_options(options);
  if (!head.region.empty() && head.region.size() != head.skin.points.size())
    throw InputError("skin regions and skin points differ in number");
  progress.step("tissue mesh", 0);
  require_closed(head.skin, "skin");
  require_closed(skull.mesh, "skull");
  require_apart(head.skin, skull.mesh);
  progress.step("tissue mesh", 0);

  const surface::SurfaceQuery skin(head.skin), bone(skull.mesh);
  const auto seeds = region_seeds(skull.mesh, skin, bone, options);
  TetgenResult result = run_tetgen(head.skin, skull.mesh, seeds, options, progress);
  restore_points(result, head.skin, skull.mesh);

  TissueMesh mesh;
  mesh.label = labels(result.label);
  mesh.nodes = std::move(result.nodes);
  mesh.tets = std::move(result.tets);
  mesh.skin_points = head.skin.points.size();
  hold(mesh, head, bone, options.no_bone_beyond);
  measure_quality(mesh);
  mesh.quality["volume_inside_skull_mm3"] = signed_volume(skull.mesh);
  mesh.quality["volume_between_mm3"] = signed_volume(head.skin) - signed_volume(skull.mesh);
  progress.step("tissue mesh", 1);
  return mesh;
}

}  // namespace palpate::tetmesh
