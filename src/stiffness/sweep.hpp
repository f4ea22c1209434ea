// SPDX-License-Identifier: GPL-3.0-or-later
// A force-travel curve at every point of the skin.
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"
#include "core/stiffness_map.hpp"
#include "fem/published.hpp"
#include "stiffness/carriers.hpp"
#include "stiffness/tissue_model.hpp"

namespace palpate::stiffness {

/// exact: every point on tissue is pressed with every load; or `sites` of them, and the rest is
/// blended from these by what lies around. fast: a coarse
/// press everywhere, `sites` full ones, the rest learned with a predicted error; where that is
/// above `error_bound` the point is pressed in full. published: `sites` points by the recipe of the
/// source (fem/published.hpp) on the head's tetrahedra, the rest blended where the nearest site has
/// a curve.
enum class SweepMode { exact, fast, published };

/// What the published recipe is run on; other modes do not look at it.
struct PublishedPress {
  double reach = 25;  ///< [mm] > 0; tetrahedra with their centre within this of the site; 1000: all
  double max_volume = 10;  ///< [mm^3] tetmesh::TissueOptions'
};

struct SweepOptions {
  SweepMode mode = SweepMode::fast;
  double tool_radius = 8;  ///< [mm] sphere; > 0
  TissueModel tissue;      ///< what the flesh is made of
  int loads = 10;          ///< number of equal force steps up to max_force; >= 1
  double max_force = 5;    ///< [N]
  OrganOptions organs;     ///< what lies under eyes and nose; published mode holds them
  PublishedPress published;
  int sites = 0;  ///< points pressed in full; 0: 300 in fast mode, all in exact, 40 in published
  double error_bound = 0.03;   ///< [-] largest predicted error of a learned curve in fast mode
  double no_bone_beyond = 40;  ///< [mm] no curve where bone is farther along the normal
  std::uint64_t seed = 1;      ///< for the choice of sites
  int threads = 0;             ///< 0: all cores; the result does not depend on it

  // How a long run is cut; none of it changes the result.
  std::filesystem::path checkpoint;          ///< file to go on from and to write to; "": none
  std::vector<std::filesystem::path> parts;  ///< checkpoints of shards to take in
  int shard = 0;                             ///< this process' share: shard of shard_count
  int shard_count = 1;                       ///< > 1: only solves its share, makes no map
};

/// What the published recipe said at one site.
struct PublishedSite {
  std::int32_t point = 0;                     ///< of those asked for
  std::vector<fem::PublishedSample> samples;  ///< to the first bad force; empty: no flesh
};

/// Points asked for, head frame, [mm]; one region each.
struct SkinPoints {
  std::vector<Vec3> position;
  std::vector<SkinRegion> region;
};

struct Sweep {
  StiffnessMap map;                          ///< one row per point asked for; empty for a shard
  std::vector<std::int32_t> sites;           ///< points pressed in full, first of coinciding ones
  std::map<std::string, double> statistics;  ///< named figures, units in the names
  std::vector<PublishedSite> published;      ///< in published mode; empty for a shard
  std::vector<std::string> warnings;
  std::vector<std::string> notes;  ///< about this run alone, such as damage in a checkpoint
};

/// Presses a frictionless rigid sphere along the inward normal of the working skin nearest to each
/// point.
/// In published mode a force on the nearest free node of the skin takes the sphere's place.
/// Status: held in an organ's region (eye, nose, lips) where organs are held; no_bone on an ear,
/// farther than 4 mm from the working skin, where no bone lies within reach or the way to it leaves
/// the head; failed where no equilibrium was found. In published mode inverted where the recipe
/// turns tissue inside out and unsettled where it does not come to rest, each at one force or more;
/// a point that was not pressed takes the status of the nearest site, with method surrogate.
/// @throws SolveError  published mode: the head cannot be meshed
/// @throws InputError  names the option, key or file that cannot be used
/// @throws FileError   a full disk: what the checkpoint held stays good
/// @note Same bits for any thread count, number of shards and interruption, on one instruction set.
[[nodiscard]] Sweep sweep(const HeadSurface& head, const SkullFit& skull, const SkinPoints& points,
                          const SweepOptions& options = {}, const Progress& progress = {});
/// At the points of the working skin.
[[nodiscard]] Sweep sweep(const HeadSurface& head, const SkullFit& skull,
                          const SweepOptions& options = {}, const Progress& progress = {});

/// A map on the working skin carried to other points (a scan with many more vertices than the
/// working skin) by the closest point's barycentric weights; tissue depth is measured anew along
/// the smoothed inward normal. Corners without a curve are left out of the mix.
/// @param points  [mm] head frame
[[nodiscard]] StiffnessMap transfer(const StiffnessMap& map, const HeadSurface& head,
                                    const SkullFit& skull, const SkinPoints& points,
                                    const OrganOptions& organs = {});

}  // namespace palpate::stiffness
