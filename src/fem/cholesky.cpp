// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/cholesky.hpp"

#include <cholmod.h>

#include <cstring>

#include "core/error.hpp"

extern "C" void openblas_set_num_threads(int);
extern "C" void omp_set_max_active_levels(int);

namespace palpate::fem {

struct Cholesky::Impl {
  cholmod_common common;
  cholmod_sparse* matrix = nullptr;
  cholmod_factor* factor = nullptr;

  Impl() {
    openblas_set_num_threads(1);
    cholmod_start(&common);
    common.supernodal = CHOLMOD_SUPERNODAL;
    common.nmethods = 1;
    common.method[0].ordering = CHOLMOD_METIS;
    common.postorder = 1;
    common.print = 0;
    common.quick_return_if_not_posdef = 1;
  }
  ~Impl() {
    cholmod_free_factor(&factor, &common);
    cholmod_free_sparse(&matrix, &common);
    cholmod_finish(&common);
  }
  Impl(const Impl&) = delete;
  Impl& operator=(const Impl&) = delete;
};

Cholesky::Cholesky(const SparsePattern& p) : pattern_(&p), impl_(std::make_unique<Impl>()) {
  cholmod_common& c = impl_->common;
  const std::size_t entries = p.row.size();
  impl_->matrix = cholmod_allocate_sparse(p.size, p.size, entries, 1, 1, -1, CHOLMOD_REAL, &c);
  std::copy(p.column_start.begin(), p.column_start.end(), static_cast<int*>(impl_->matrix->p));
  std::copy(p.row.begin(), p.row.end(), static_cast<int*>(impl_->matrix->i));
  std::fill_n(static_cast<double*>(impl_->matrix->x), entries, 0.0);
  impl_->factor = cholmod_analyze(impl_->matrix, &c);
  if (!impl_->factor) throw SolveError("the sparse factorisation could not be analysed");
}

Cholesky::Cholesky(const Cholesky& other)
    : pattern_(other.pattern_), impl_(std::make_unique<Impl>()) {
  impl_->matrix = cholmod_copy_sparse(other.impl_->matrix, &impl_->common);
  impl_->factor = cholmod_copy_factor(other.impl_->factor, &impl_->common);
  if (!impl_->factor) throw SolveError("the sparse factorisation could not be copied");
}

Cholesky::~Cholesky() = default;

bool Cholesky::factorize(std::span<const double> values) {
  std::memcpy(impl_->matrix->x, values.data(), values.size_bytes());
  // CHOLMOD asks OpenMP for four threads for each large column block; they would spin beside the
  // sweep's own, a fifth of the processors' time.
  omp_set_max_active_levels(0);
  cholmod_factorize(impl_->matrix, impl_->factor, &impl_->common);
  return impl_->common.status == CHOLMOD_OK;
}

Eigen::VectorXd Cholesky::solve(const Eigen::VectorXd& right_side) const {
  cholmod_common& c = impl_->common;
  Eigen::VectorXd copy = right_side;
  cholmod_dense b{};
  b.nrow = b.nzmax = b.d = copy.size();
  b.ncol = 1;
  b.x = copy.data();
  b.xtype = CHOLMOD_REAL;
  b.dtype = CHOLMOD_DOUBLE;
  cholmod_dense* x = cholmod_solve(CHOLMOD_A, impl_->factor, &b, &c);
  if (!x) throw SolveError("the sparse solve failed");
  const Eigen::VectorXd out =
      Eigen::Map<const Eigen::VectorXd>(static_cast<const double*>(x->x), copy.size());
  cholmod_free_dense(&x, &c);
  return out;
}

double Cholesky::flops() const {
  return impl_->common.fl;
}
double Cholesky::fill() const {
  return impl_->common.lnz;
}

}  // namespace palpate::fem
