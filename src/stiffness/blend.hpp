// SPDX-License-Identifier: GPL-3.0-or-later
// Curves of solved sites carried to all points: Gaussian process regression on what the tool sees.
#pragma once
#include <Eigen/Dense>
#include <span>
#include <vector>

namespace palpate::stiffness {

/// A row of inputs per site.
struct BlendInputs {
  Eigen::MatrixXd shape;     ///< n x s numbers of comparable units
  Eigen::MatrixXd position;  ///< n x 3, in tool radii
  Eigen::MatrixXd guess;     ///< n x loads, a rough curve, rows ascending, > 0; or 0 x 0: none
};
/// Length scales of the kernel and the share of the variance that it cannot explain.
struct BlendKernel {
  double shape_scale = 1;       ///< [-] in standard deviations of the inputs
  double position_scale = 4;    ///< [-] in tool radii
  double position_share = 0.2;  ///< [-] of the variance carried by position alone
  double noise = 1e-4;          ///< [-] of the variance
};

/// Learns ln u_1 and ln(u_i - u_(i-1)) of the sites, or how far these are from the guess', so that
/// a blended curve ascends. The kernel is chosen by the leave-one-out error. Deterministic.
class CurveBlend {
 public:
  /// @param travel  n x loads [mm], rows ascending, > 0; n >= 2
  /// @param others  n x any: further numbers carried along with the same kernel
  CurveBlend(BlendInputs sites, const Eigen::MatrixXd& travel, const Eigen::MatrixXd& others = {});

  struct Curve {
    Eigen::VectorXd travel;  ///< [mm]
    Eigen::VectorXd others;
    double error = 0;  ///< [-] estimated relative error (one standard deviation over loads)
  };
  /// @param guess  as in the inputs; of size 0 where these had none
  [[nodiscard]] Curve at(const Eigen::VectorXd& shape, const Eigen::Vector3d& position,
                         const Eigen::VectorXd& guess = {}) const;

  /// Relative errors of leaving each site out: n x loads.
  [[nodiscard]] const Eigen::MatrixXd& left_out_errors() const { return left_out_; }
  [[nodiscard]] const BlendKernel& kernel() const { return kernel_; }

 private:
  [[nodiscard]] Eigen::VectorXd scaled_shape(const Eigen::VectorXd& shape) const;
  [[nodiscard]] Eigen::MatrixXd covariance(const BlendKernel& kernel) const;
  /// Solves for a kernel; returns the median relative left-out error.
  double fit(const BlendKernel& kernel);
  void choose_kernel();

  BlendInputs sites_;
  Eigen::MatrixXd travel_, target_;        // target: logarithms minus the guess' and minus trend
  Eigen::MatrixXd others_, others_alpha_;  // minus their means
  Eigen::RowVectorXd others_mean_;
  Eigen::VectorXd mean_, inverse_deviation_, weight_;  // of the shape numbers
  Eigen::MatrixXd trend_;                              // (1 + s) x loads
  BlendKernel kernel_;
  Eigen::LLT<Eigen::MatrixXd> factor_;
  Eigen::MatrixXd alpha_, left_out_;
  double calibration_ = 1;  // turns the process' deviation into a relative error of u
};

}  // namespace palpate::stiffness
