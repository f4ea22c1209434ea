// SPDX-License-Identifier: GPL-3.0-or-later
// What height-field patches could not do, pressed on pieces of the head's tetrahedra.
#pragma once
#include "stiffness/ground.hpp"

namespace palpate::stiffness {

/// Meshes the head when there is anything to do, then presses each site into the store's level
/// `unstructured`; a site that fails there too has an empty curve. A mesher that fails costs a
/// warning.
/// @note Minutes of one core per site; a site's curve depends on no other site.
void press_pieces(const Ground& ground, const SkullFit& skull, std::span<const std::int32_t> sites,
                  Checkpoint& store, const Progress& progress, std::vector<std::string>& warnings);

}  // namespace palpate::stiffness
