// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/fallback.hpp"

#include <fmt/format.h>

#include "stiffness/press_sites.hpp"
#include "stiffness/unstructured.hpp"
#include "tetmesh/tissue.hpp"

namespace palpate::stiffness {
namespace {

SiteCurve press_piece(const Ground& ground, const TissueCutter& cutter, const Spot& spot,
                      std::span<const double> radii) {
  const double radius = ground.options.tool_radius;
  const surface::ClosestPoint at = ground.skin.closest(spot.frame.origin);
  const SkinSpot skin{at.triangle, at.barycentric};
  PatchGeometry middle;
  middle.spot = {skin};
  try {
    return press_unstructured(
        cutter.cut(spot.frame, radius), ground.flesh.law_at(skin),
        {radius, fem::default_penalty(ground.flesh.surface_modulus(middle), radius)}, ground.forces,
        radii);
  } catch (const SolveError&) {
    return {};  // no flesh there: the curve stays empty, the site counts as failed
  } catch (const InputError&) {
    return {};  // the tool's path misses the piece's skin
  }
}

}  // namespace

void press_pieces(const Ground& ground, const SkullFit& skull, std::span<const std::int32_t> sites,
                  Checkpoint& store, const Progress& progress, std::vector<std::string>& warnings) {
  std::vector<std::int32_t> open;
  for (const std::int32_t s : sites)
    if (!store.find(SolveLevel::unstructured, s)) open.push_back(s);
  if (open.empty()) return;
  TissueMesh tissue;
  try {
    tissue = tetmesh::make_tissue_mesh(ground.head, skull, {}, progress);
  } catch (const InputError& error) {
    warnings.push_back(fmt::format("no unstructured presses: {}", error.what()));
    return;
  } catch (const SolveError& error) {
    warnings.push_back(fmt::format("no unstructured presses: {}", error.what()));
    return;
  }
  const TissueCutter cutter(tissue);
  const std::vector<double> radii = dent_radii(ground.options.tool_radius);
  parallel(static_cast<int>(open.size()), ground.options, progress, 0.98, 1, [&](int i) {
    const SiteCurve curve = press_piece(ground, cutter, ground.spots[open[i]], radii);
    store.put(SolveLevel::unstructured, std::span(&open[i], 1), std::span(&curve, 1));
  });
}

}  // namespace palpate::stiffness
