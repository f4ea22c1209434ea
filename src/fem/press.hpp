// SPDX-License-Identifier: GPL-3.0-or-later
// A rigid indenter pressed into tissue with prescribed forces, its travel
// an unknown; or to a prescribed travel.
#pragma once
#include <span>
#include <string>

#include "fem/contact.hpp"
#include "fem/elastic_body.hpp"
#include "fem/newton.hpp"

namespace palpate::fem {

struct PressOptions {
  double relative_tolerance = 1e-4;  ///< [-] largest force left on a node, of the load; > 0
  int max_iterations = 60;           ///< Newton steps per load
  /// [mm] travel that the first load starts from; a good guess saves steps, nothing else.
  double first_guess = 0.2;
};
struct PressCurve {
  std::vector<double> travel;            ///< [mm] one per load that converged, rigid contact
  std::vector<double> penalised_travel;  ///< [mm] the same with the penalty's penetration in it
  Eigen::VectorXd last;                  ///< unknowns at the last converged load
  std::vector<Eigen::VectorXd> states;   ///< unknowns at each of them
  int iterations = 0;                    ///< over all loads
  int projections = 0;
  double residual = 0;    ///< [N] of the last load tried
  bool complete = false;  ///< all loads converged
  std::string failure;    ///< "" when complete, else the reason
};
/// The same by displacement control.
struct PressForces {
  std::vector<double> force;  ///< [N] one per travel that converged, rigid contact
  std::vector<double> penalised_force;
  Eigen::VectorXd last;
  int iterations = 0;
  bool complete = false;
  std::string failure;
};

/// Travel of a rigid contact from that of a penalised one, to first order in 1/penalty. With
/// Q = integral of p^2 over the contact, dPi/d(1/penalty) = -Q/2 at the minimum and d = -dPi/dF, so
///   d_rigid = d - (dQ/dF) / (2 penalty),
/// with dQ/dF from the neighbouring loads (Q ~ F^m; m = 4/3, Hertz, for a single load).
[[nodiscard]] std::vector<double> rigid_contact_travel(std::span<const double> forces,
                                                       std::span<const double> travel,
                                                       std::span<const double> squared_pressure,
                                                       double penalty);

/// Stationary points of E(u) + contact(u, d) - force * d for ascending forces, each started from an
/// extrapolation of those before.
/// @param body      rest geometry; its topology has contact faces
/// @param forces    [N] ascending, > 0
/// @param cholesky  analysed for the body's topology; one per thread
/// @note A load that does not converge ends the curve (`complete` is false); it does not throw.
[[nodiscard]] PressCurve press(const Body& body, const Contact& contact,
                               std::span<const double> forces, Cholesky& cholesky,
                               const PressOptions& options = {});

/// Displacement control: the forces that hold the indenter at ascending travels. The penalty is
/// taken out by F_rigid = F + (dQ/dd) / (2 penalty), the same argument with d prescribed.
/// @param travels  [mm] ascending, > 0
/// @note A travel that does not converge ends the list; it does not throw.
[[nodiscard]] PressForces press_to(const Body& body, const Contact& contact,
                                   std::span<const double> travels, Cholesky& cholesky,
                                   const PressOptions& options = {});

}  // namespace palpate::fem
