// SPDX-License-Identifier: GPL-3.0-or-later
// Presses at many sites: batches of sixteen in single precision, stragglers in double.
#pragma once
#include "stiffness/ground.hpp"
#include "stiffness/site.hpp"

namespace palpate::stiffness {

/// The part of the sites that this process solves: those of every count-th batch.
struct Shard {
  int index = 0;  ///< 0 <= index < count
  int count = 1;
};
/// Brings the store to hold a curve of each of the sites (of the shard's, where there are shards);
/// those that it holds already are not solved again.
/// @param sites  numbers of spots with tissue
/// @note A site's curve depends on no other site, nor on threads, shards or interruptions.
void press_sites(const Ground& ground, SolveLevel level, std::span<const std::int32_t> sites,
                 const Shard& shard, Checkpoint& store, const Progress& progress, double from,
                 double to);

/// The template that a depth asks for: smaller for thin tissue, three layers where it is thick.
[[nodiscard]] PatchRule rule_for_depth(double depth, double tool_radius);
/// [mm] distances from the site at which dents are noted, the middle first.
[[nodiscard]] std::vector<double> dent_radii(double tool_radius);
/// Loads that a coarse press takes: first, about two fifths, last.
[[nodiscard]] std::vector<double> coarse_forces(std::span<const double> forces);

}  // namespace palpate::stiffness
