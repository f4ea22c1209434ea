// SPDX-License-Identifier: GPL-3.0-or-later
// Indentation of a thin elastic layer, against the exact solution.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::verify {

/// One row of the reference table: a frictionless indenter on a linear elastic layer of thickness h
/// bonded to a rigid base.
struct ExactRow {
  bool sphere = false;  ///< else a flat punch
  double nu = 0;        ///< [-]
  double a_over_h = 0;  ///< [-] contact radius over thickness
  double chi = 0;       ///< [-] travel * R / a^2 of the sphere; NaN for the punch
  double kappa = 0;     ///< [-] P (1 - nu^2) / (2 a E travel)
};
/// @throws InputError  names the file and line
[[nodiscard]] std::vector<ExactRow> read_exact_rows(const std::filesystem::path& csv);

enum class LayerMesh { standard, refined };
struct LayerResult {
  double error = 0;  ///< [-] of the force at the prescribed travel
  int unknowns = 0;
  double seconds = 0;
};
/// Small strains, quadratic elements, travel prescribed, force compared.
///
/// The standard mesh: under a sphere four rings a contact radius, none wider than a quarter of the
/// thickness; under a punch rings that close in on the edge from both sides down to 1 % of the
/// radius, where the pressure is singular; twelve sectors; levels that grow downwards from a
/// quarter of the contact radius (punch: 1 %). The refined mesh has twice the rings, 0.3 % at the
/// punch's edge and twenty sectors. Where nu > 0.44 the volume's energy is integrated at the
/// elements' centres (TissueLaws).
/// @throws SolveError  the contact did not converge
[[nodiscard]] LayerResult press_layer(const ExactRow& row, LayerMesh mesh);

}  // namespace palpate::verify
