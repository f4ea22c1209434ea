// SPDX-License-Identifier: Apache-2.0
// What a touchable head carries at every vertex.
#pragma once
#include <array>
#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "core/regions.hpp"

namespace palpate {

/// inverted and unsettled are what the published recipe comes to where it turns tissue inside out
/// or does not come to rest at some force; in files by number, so new ones go to the end.
enum class VertexStatus : std::uint8_t {
  solved,
  blended,
  no_bone,
  held,
  failed,
  inverted,
  unsettled
};
inline constexpr std::array<std::string_view, 7> kVertexStatusNames = {
    "solved", "blended", "no_bone", "held", "failed", "inverted", "unsettled"};
[[nodiscard]] constexpr std::string_view name(VertexStatus s) {
  return kVertexStatusNames[static_cast<std::size_t>(s)];
}

/// How a vertex came by its curve: single precision in a batch of sixteen, double precision,
/// double precision on an unstructured patch (where the skin is no height field), learned from
/// other vertices, or pressed by the published recipe.
enum class SolveMethod : std::uint8_t {
  none,
  batch,
  in_double,
  unstructured,
  surrogate,
  published
};
inline constexpr std::array<std::string_view, 6> kSolveMethodNames = {
    "none", "batch", "double", "unstructured", "surrogate", "published"};
[[nodiscard]] constexpr std::string_view name(SolveMethod m) {
  return kSolveMethodNames[static_cast<std::size_t>(m)];
}

/// How far the skin around a pressed vertex goes down, as a share of the tool's travel.
struct Dents {
  double force = 0;           ///< [N] at which it was taken
  std::vector<double> radii;  ///< [mm] ascending, from the press axis; empty: no dents known
  std::vector<double> share;  ///< [-] n x radii.size(), mean around the axis; NaN where no curve
};

/// Force-travel samples per vertex. A row is NaN where there is no curve.
struct StiffnessMap {
  double tool_radius = 8;            ///< [mm] sphere that pressed; of the published recipe, which
                                     ///< has none: that it is played with
  std::vector<double> forces;        ///< [N] ascending, > 0
  std::vector<double> displacement;  ///< [mm] n x forces.size(), row by row: travel of the tool
                                     ///< along the inward normal from first contact
  std::vector<VertexStatus> status;  ///< n
  std::vector<double> error;         ///< [-] n, estimated relative error of u; NaN where none
  std::vector<double> depth;         ///< [mm] n, skin to bone; NaN where no bone
  std::vector<SkinRegion> region;    ///< n
  std::vector<SolveMethod> method;   ///< n, or empty where unknown
  Dents dents;

  [[nodiscard]] std::size_t size() const { return status.size(); }
  [[nodiscard]] std::span<const double> curve(std::size_t vertex) const {
    return {displacement.data() + vertex * forces.size(), forces.size()};
  }
  [[nodiscard]] bool has_curve(std::size_t vertex) const {
    return status[vertex] == VertexStatus::solved || status[vertex] == VertexStatus::blended;
  }
};

/// f = k u + b on each piece, continuous at the samples.
struct StiffnessCoefficients {
  std::vector<double> k;  ///< [N/mm]
  std::vector<double> b;  ///< [N]
};
/// k_1 = f_1/u_1, b_1 = 0; k_i = (f_i - f_(i-1)) / (u_i - u_(i-1)); b_i = f_i - k_i u_i. Piece i
/// holds for u_(i-1) <= u < u_i, the last one beyond u_n (docs/method/stiffness.md).
/// @param u  [mm] strictly ascending, > 0; as long as `forces`
/// @throws InputError where u does not ascend
[[nodiscard]] StiffnessCoefficients stiffness_coefficients(std::span<const double> forces,
                                                           std::span<const double> u);
/// Force [N] of the piecewise curve at travel u [mm]; 0 for u <= 0.
[[nodiscard]] double force_at(const StiffnessCoefficients& c, std::span<const double> u_samples,
                              double u);

}  // namespace palpate
