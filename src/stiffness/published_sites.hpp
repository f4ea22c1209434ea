// SPDX-License-Identifier: GPL-3.0-or-later
// The published recipe at chosen sites of a head, and what the map says at all its points.
#pragma once
#include <functional>

#include "stiffness/press_sites.hpp"
#include "stiffness/rows.hpp"
#include "stiffness/unstructured.hpp"

namespace palpate::stiffness {

/// One site: a force on node 0 of a piece of the head's own linear tetrahedra, along the inward
/// normal, each force from the undeformed state. Bone is held: against flesh that is 130 000 times
/// softer its own deformation is far below rounding.
/// @return `published` holds the loads up to the first that turns tissue inside out or does not
///         come to rest, `travel` all of them where there is no such load and each goes deeper
/// @param forces      [N] > 0, ascending
/// @param after_load  called after each; what it throws comes out
[[nodiscard]] SiteCurve press_as_published(const TissuePiece& piece, std::span<const double> forces,
                                           const std::function<void()>& after_load = {});

/// Brings the store's level `published` to hold a curve of each of the sites (of the shard's).
/// Meshes the head when there is anything to do.
/// @throws InputError, SolveError  the head cannot be meshed
/// @note A site's curve depends on no other site, nor on threads, shards or interruptions.
void press_published_sites(const Ground& ground, const SkullFit& skull,
                           std::span<const std::int32_t> sites, const Shard& shard,
                           Checkpoint& store, const Progress& progress, double from, double to);

/// solved, inverted, unsettled or failed.
[[nodiscard]] VertexStatus published_status(const SiteCurve& curve);

/// Rows of all spots: those of the sites, and of every other spot with tissue what the nearest site
/// (in space, lowest number on ties) lets it have: a blended curve, or the status of that site.
/// Counts the outcomes per force in `out.statistics` and says them in `out.warnings`.
[[nodiscard]] std::vector<Row> published_rows(const Ground& ground, const Checkpoint& store,
                                              std::span<const std::int32_t> tissue,
                                              std::span<const std::int32_t> sites, Sweep& out);

}  // namespace palpate::stiffness
