// SPDX-License-Identifier: GPL-3.0-or-later
// Two fidelities (Kennedy & O'Hagan 2000, "Predicting the output from a complex computer code when
// fast approximations are available"): the coarse press carries what is particular about a place,
// and what the coarse mesh gets wrong varies slowly from place to place.
#include "stiffness/surrogate.hpp"

#include <algorithm>
#include <cmath>

#include "stiffness/press_sites.hpp"

namespace palpate::stiffness {
namespace {

/// The curve through few loads at all loads: ln u as a polynomial of ln f, or piecewise linear in
/// these where the polynomial does not ascend.
Eigen::VectorXd through(std::span<const double> at, std::span<const double> u,
                        std::span<const double> forces) {
  Eigen::VectorXd out(static_cast<Eigen::Index>(forces.size()));
  for (std::size_t i = 0; i < forces.size(); ++i) {
    double sum = 0;
    for (std::size_t a = 0; a < at.size(); ++a) {
      double weight = 1;
      for (std::size_t b = 0; b < at.size(); ++b)
        if (b != a) weight *= std::log(forces[i] / at[b]) / std::log(at[a] / at[b]);
      sum += weight * std::log(u[a]);
    }
    out[static_cast<Eigen::Index>(i)] = std::exp(sum);
  }
  bool ascends = out[0] > 0;
  for (Eigen::Index i = 1; i < out.size(); ++i) ascends = ascends && out[i] > out[i - 1];
  if (ascends) return out;
  for (std::size_t i = 0; i < forces.size(); ++i) {
    std::size_t a = 0;
    while (a + 2 < at.size() && forces[i] > at[a + 1]) ++a;
    const double t = std::log(forces[i] / at[a]) / std::log(at[a + 1] / at[a]);
    out[static_cast<Eigen::Index>(i)] = std::exp((1 - t) * std::log(u[a]) + t * std::log(u[a + 1]));
  }
  return out;
}

}  // namespace

SolveLevel full_level(const SweepOptions& options) {
  return options.mode == SweepMode::published ? SolveLevel::published : SolveLevel::full;
}

std::size_t dent_load(std::span<const double> forces) {
  constexpr double kForce = 2;  // [N]
  std::size_t best = 0;
  for (std::size_t i = 1; i < forces.size(); ++i)
    if (std::abs(forces[i] - kForce) < std::abs(forces[best] - kForce)) best = i;
  return best;
}

Surrogate::Surrogate(const Ground& ground, const Checkpoint& store,
                     std::span<const std::int32_t> sites)
    : ground_(ground), store_(store), coarse_forces_(coarse_forces(ground.forces)) {
  std::vector<Eigen::VectorXd> shapes, guesses;
  std::vector<std::int32_t> good;
  for (const std::int32_t s : sites) {
    const SiteCurve* full = store.find(full_level(ground.options), s);
    Eigen::VectorXd shape, guess;
    if (!full || full->travel.empty() || !look(s, shape, guess)) continue;
    good.push_back(s);
    shapes.push_back(shape);
    guesses.push_back(guess);
  }
  const auto n = static_cast<Eigen::Index>(good.size());
  if (n < 2) throw SolveError("fewer than two sites were solved; no map can be made");
  const auto loads = static_cast<Eigen::Index>(ground.forces.size());
  const std::size_t dent = dent_load(ground.forces);
  BlendInputs inputs{Eigen::MatrixXd(n, shapes[0].size()), Eigen::MatrixXd(n, 3),
                     Eigen::MatrixXd(n, guesses[0].size())};
  Eigen::MatrixXd travel(n, loads), dents;
  for (Eigen::Index i = 0; i < n; ++i) {
    const SiteCurve& full = *store.find(full_level(ground.options), good[i]);
    inputs.shape.row(i) = shapes[i];
    inputs.position.row(i) = ground.spots[good[i]].frame.origin / ground.options.tool_radius;
    inputs.guess.row(i) = guesses[i];
    travel.row(i) = Eigen::Map<const Eigen::VectorXd>(full.travel.data(), loads);
    const auto rings = static_cast<Eigen::Index>(full.sunk.size()) / loads;
    if (i == 0) dents.resize(n, rings);
    dents.row(i) = Eigen::Map<const Eigen::VectorXd>(
                       full.sunk.data() + static_cast<Eigen::Index>(dent) * rings, rings) /
                   full.travel[dent];
  }
  blend_ = std::make_unique<CurveBlend>(std::move(inputs), travel, dents);
}

bool Surrogate::look(std::int32_t spot, Eigen::VectorXd& shape, Eigen::VectorXd& guess) const {
  if (ground_.options.mode != SweepMode::fast) {
    shape = ground_.spots[spot].shape;
    guess.resize(0);
    return true;
  }
  const SiteCurve* coarse = store_.find(SolveLevel::coarse, spot);
  if (!coarse || coarse->travel.empty()) return false;
  const std::vector<double>& u = coarse->travel;
  for (std::size_t i = 0; i < u.size(); ++i)
    if (!(u[i] > (i > 0 ? u[i - 1] : 0))) return false;
  const Eigen::VectorXd& own = ground_.spots[spot].shape;
  shape.resize(own.size() + static_cast<Eigen::Index>(u.size()));
  shape.head(own.size()) = own;
  for (std::size_t i = 0; i < u.size(); ++i)
    shape[own.size() + static_cast<Eigen::Index>(i)] =
        std::log((i > 0 ? u[i] - u[i - 1] : u[i]) / ground_.options.tool_radius);
  guess = u.size() > 1 ? through(coarse_forces_, u, ground_.forces)
                       : Eigen::VectorXd::Constant(1, u[0]);
  return true;
}

std::optional<CurveBlend::Curve> Surrogate::at(std::int32_t spot) const {
  Eigen::VectorXd shape, guess;
  if (!look(spot, shape, guess)) return std::nullopt;
  return blend_->at(shape, ground_.spots[spot].frame.origin / ground_.options.tool_radius, guess);
}

void note_left_out_errors(const Surrogate& surrogate, std::map<std::string, double>& statistics) {
  const Eigen::MatrixXd& left_out = surrogate.left_out_errors();
  std::vector<double> miss(left_out.data(), left_out.data() + left_out.size());
  for (double& e : miss) e = std::abs(e);
  std::sort(miss.begin(), miss.end());
  statistics["blend_left_out_error_median"] = miss[miss.size() / 2];
  statistics["blend_left_out_error_p95"] = miss[miss.size() * 95 / 100];
  statistics["blend_left_out_error_max"] = miss.back();
}

}  // namespace palpate::stiffness
