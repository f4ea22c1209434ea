// SPDX-License-Identifier: GPL-3.0-or-later
#include "skull/skull_map.hpp"

namespace palpate::skull {

Vec3 SkullMap::shaped(const Vec3& x, const SplineWeights& weights) const {
  Vec3 u = Vec3::Zero();
  for (int c = 0; c < 64; ++c) u += weights.share[c] * control.row(weights.control[c]).transpose();
  return x + u;
}

Vec3 SkullMap::operator()(const Vec3& x) const {
  return linear * move_jaw(jaw, pose, shaped(x, lattice.weights(x)), jaw.weight(x)).position +
         translation;
}

Mat3 SkullMap::gradient(const Vec3& x) const {
  const SplineWeights w = lattice.weights(x);
  const Eigen::Matrix<double, 64, 3> g = lattice.gradients(x);
  Mat3 inner = Mat3::Identity();
  for (int c = 0; c < 64; ++c) inner += control.row(w.control[c]).transpose() * g.row(c);
  const JawMotion motion = move_jaw(jaw, pose, shaped(x, w), jaw.weight(x));
  return linear * (motion.turn * inner + motion.by_weight * jaw.weight_gradient(x).transpose());
}

}  // namespace palpate::skull
