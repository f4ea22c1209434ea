// SPDX-License-Identifier: GPL-3.0-or-later
// What it costs to deform tissue: energy per rest volume as a function of the deformation gradient.
// A law is one file in energies/; it returns value, stress and tangent as pure functions of F.
#pragma once
#include <limits>
#include <memory>

#include "core/types.hpp"

namespace palpate::fem {

using Mat9 = Eigen::Matrix<double, 9, 9>;
using Vec9 = Eigen::Matrix<double, 9, 1>;

/// Column-major: entry i + 3 j of the vector is F(i, j).
[[nodiscard]] inline Vec9 vec(const Mat3& m) {
  return Eigen::Map<const Vec9>(m.data());
}
[[nodiscard]] inline Mat3 unvec(const Vec9& v) {
  return Eigen::Map<const Mat3>(v.data());
}

inline constexpr double kInadmissible = std::numeric_limits<double>::infinity();

/// Hyperelastic law psi(F). Stateless after construction; safe to call from many threads.
class EnergyDensity {
 public:
  virtual ~EnergyDensity() = default;
  /// psi [MPa]; 0 at F = I; kInadmissible where the law forbids the state (J <= 0 with a barrier).
  [[nodiscard]] virtual double value(const Mat3& F) const = 0;
  /// First Piola-Kirchhoff stress P = dpsi/dF [MPa]. F must be admissible.
  [[nodiscard]] virtual Mat3 stress(const Mat3& F) const = 0;
  /// dvec(P)/dvec(F) [MPa], symmetric. F must be admissible.
  [[nodiscard]] virtual Mat9 tangent(const Mat3& F) const = 0;
};

/// Small-strain moduli; lambda and mu are Lame's constants [MPa].
struct LameModuli {
  double lambda = 0;
  double mu = 0;
};
/// @throws InputError unless E > 0 and 0 <= nu < 0.5, naming the value
[[nodiscard]] LameModuli lame_moduli(double youngs_modulus, double poissons_ratio);

/// Nearest positive semidefinite matrix: negative eigenvalues become 0.
[[nodiscard]] Mat9 positive_part(const Mat9& symmetric);

/// psi = mu/2 (I1 - 3) - mu ln J + lambda/2 ln^2 J. Forbids J <= 0.
/// @cite Bonet & Wood 1997, "Nonlinear Continuum Mechanics for Finite Element Analysis", eq. 5.28
[[nodiscard]] std::unique_ptr<EnergyDensity> neo_hookean(const LameModuli& moduli);

/// psi = mu eps:eps + lambda/2 tr^2(eps), eps = sym(F - I). Not rotation invariant.
[[nodiscard]] std::unique_ptr<EnergyDensity> linear_elastic(const LameModuli& moduli);

/// psi = mu E:E + lambda/2 tr^2(E), E = (F'F - I)/2. Softens and collapses under compression;
/// kept because the source used it (thesis, eq. 3.9).
/// @param compression_resistance  c >= 0 [-] adds c E / (1 - 2 nu) (1 - J)^3 / 2592 where J < 1,
/// the
///   cubic wall of VEGA FEM's invertible materials (its usual value is 500). It stiffens a
///   collapsing element but forbids nothing; 0 leaves it out, as the source did.
/// @cite Barbic, Sin & Schroeder 2012, "Vega FEM Library"
[[nodiscard]] std::unique_ptr<EnergyDensity> st_venant_kirchhoff(const LameModuli& moduli,
                                                                 double compression_resistance = 0);

/// psi = mu |F - R|^2 + lambda/2 tr^2(R'F - I), R the rotation nearest to F.
/// @cite Stomakhin et al. 2012, "Energetically Consistent Invertible Elasticity", section 3
[[nodiscard]] std::unique_ptr<EnergyDensity> corotational(const LameModuli& moduli);

/// How the volume's share of the energy is written.
enum class VolumeTerm {
  log_squared,  ///< U = k ln^2 J: the source's
  quadratic     ///< U = k (J - 1)^2: CalculiX's, Abaqus' (k = 1/D1)
};

/// The source's hyperelastic law (thesis, eq. 3.16-3.20).
struct MooneyRivlin {
  double a = 0;  ///< [MPa] weight of (I1bar - 3)
  double b = 0;  ///< [MPa] weight of (I2bar - 3); small-strain mu = 2 (a + b)
  double k = 0;  ///< [MPa] weight of U; small-strain bulk modulus = 2 k
  VolumeTerm volume = VolumeTerm::log_squared;
  double fibre_modulus = 0;         ///< [MPa] F2 = fibre_modulus/2 (lambda^2 - 1)^2; 0: none
  Vec3 fibre_axis = Vec3::UnitX();  ///< [-] unit, rest frame
};
/// psi = F1 + U + F2 = a (I1bar - 3) + b (I2bar - 3) + U(J) + fibre, on Cbar = J^(-2/3) F'F.
/// Forbids J <= 0. b = 0 is the isochoric neo-Hookean law.
[[nodiscard]] std::unique_ptr<EnergyDensity> mooney_rivlin(const MooneyRivlin& parameters);
/// a = b = mu/4 and k = K/2, so that small strains agree with E and nu.
[[nodiscard]] MooneyRivlin mooney_rivlin_from(const LameModuli& moduli);

}  // namespace palpate::fem
