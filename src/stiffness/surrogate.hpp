// SPDX-License-Identifier: GPL-3.0-or-later
// Curves at places that were not pressed in full, learned from those that were: from the coarse
// presses in fast mode, from the surroundings alone where sites were chosen in the other modes.
#pragma once
#include <memory>

#include "stiffness/blend.hpp"
#include "stiffness/checkpoint.hpp"
#include "stiffness/ground.hpp"

namespace palpate::stiffness {

/// The load that is the nearest one to 2 N: where stiffness is compared and dents are taken.
[[nodiscard]] std::size_t dent_load(std::span<const double> forces);

/// Where the store keeps what a mode calls a full press.
[[nodiscard]] SolveLevel full_level(const SweepOptions& options);

class Surrogate {
 public:
  /// @param sites  pressed in full; those without a full or a coarse curve are left out
  /// @throws SolveError  fewer than two are left
  Surrogate(const Ground& ground, const Checkpoint& store, std::span<const std::int32_t> sites);

  /// Nothing where the coarse press failed.
  [[nodiscard]] std::optional<CurveBlend::Curve> at(std::int32_t spot) const;
  /// Relative errors of leaving each site out: sites x loads.
  [[nodiscard]] const Eigen::MatrixXd& left_out_errors() const { return blend_->left_out_errors(); }

 private:
  /// What the blend sees of a spot; false where the coarse press failed.
  bool look(std::int32_t spot, Eigen::VectorXd& shape, Eigen::VectorXd& guess) const;

  const Ground& ground_;
  const Checkpoint& store_;
  std::vector<double> coarse_forces_;
  std::unique_ptr<CurveBlend> blend_;
};

/// blend_left_out_error_median, _p95 and _max: relative errors of leaving each site out.
void note_left_out_errors(const Surrogate& surrogate, std::map<std::string, double>& statistics);

}  // namespace palpate::stiffness
