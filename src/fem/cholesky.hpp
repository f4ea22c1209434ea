// SPDX-License-Identifier: GPL-3.0-or-later
// Sparse Cholesky factorisation with a pattern that is analysed once.
#pragma once
#include <memory>
#include <span>

#include "fem/topology.hpp"

namespace palpate::fem {

/// Supernodal CHOLMOD, nested dissection ordering. One object per thread; a copy shares nothing but
/// is spared the analysis. Sets OpenBLAS to one thread for the process: the same bits for any
/// thread count, and sites, not matrices, are what runs in parallel.
class Cholesky {
 public:
  /// @param pattern  must outlive the object and its copies
  explicit Cholesky(const SparsePattern& pattern);
  Cholesky(const Cholesky& other);
  ~Cholesky();
  Cholesky& operator=(const Cholesky&) = delete;

  /// @param values  of the lower triangle, in the pattern's order
  /// @return false where the matrix is not positive definite; then solve() must not be called
  [[nodiscard]] bool factorize(std::span<const double> values);
  [[nodiscard]] Eigen::VectorXd solve(const Eigen::VectorXd& right_side) const;
  [[nodiscard]] const SparsePattern& pattern() const { return *pattern_; }
  /// Floating-point operations of one factorisation and entries of the factor.
  [[nodiscard]] double flops() const;
  [[nodiscard]] double fill() const;

 private:
  struct Impl;
  const SparsePattern* pattern_;
  std::unique_ptr<Impl> impl_;
};

}  // namespace palpate::fem
