// SPDX-License-Identifier: GPL-3.0-or-later
// The template skull brought under one head's skin.
#pragma once
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/skull.hpp"

namespace palpate::skull {

enum class Method { depth, published };

struct FitOptions {
  Method method = Method::depth;
  double clearance = 2.5;  ///< [mm] least skin-bone distance where the table is thicker; > 0
  // further options of both methods are added by the stage's owner, each with unit and range
};

/// @param head    working skin with landmarks, head frame [mm]
/// @param depths  published soft-tissue depths
/// @throws InputError  a landmark that the fit needs is missing
/// @throws SolveError  the skull could not be kept inside the skin
/// @note Same bits for any thread count.
[[nodiscard]] SkullFit fit_skull(const HeadSurface& head, const SkullTemplate& skull,
                                 const std::vector<TissueDepth>& depths,
                                 const FitOptions& options = {}, const Progress& progress = {});

}  // namespace palpate::skull
