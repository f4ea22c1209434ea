// SPDX-License-Identifier: GPL-3.0-or-later
// The potential of a body under forces that do not turn with it.
#pragma once
#include <algorithm>

#include "fem/body.hpp"
#include "fem/newton.hpp"

namespace palpate::fem {

/// E(u) - force . u
class DeadLoaded final : public Potential {
 public:
  DeadLoaded(const Body& body, Eigen::VectorXd force) : body_(body), force_(std::move(force)) {}
  double value(const Eigen::VectorXd& x) const override { return body_.energy(x) - force_.dot(x); }
  Eigen::VectorXd gradient(const Eigen::VectorXd& x) const override {
    Eigen::VectorXd g = -force_;
    body_.add_derivatives(x, HessianKind::exact, &g, nullptr);
    return g;
  }
  void hessian(const Eigen::VectorXd& x, HessianKind kind,
               std::vector<double>& values) const override {
    std::fill(values.begin(), values.end(), 0.0);
    body_.add_derivatives(x, kind, nullptr, &values);
  }

 private:
  const Body& body_;
  Eigen::VectorXd force_;
};

}  // namespace palpate::fem
