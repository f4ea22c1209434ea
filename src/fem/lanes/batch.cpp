// SPDX-License-Identifier: GPL-3.0-or-later
// Newton's method on all lanes in step, with the tissue's share of the Hessian kept for a while:
// its factorisation is nine tenths of a full step, the contact's share, eliminated last, a
// twentieth. There is no energy in single precision that could judge a
// step near the solution, so the line search looks for the zero of the slope along the step
// instead: a step is taken when the slope has lost at least half of its size and no element is
// inverted.
#include "fem/lanes/batch.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <string_view>

#include "core/error.hpp"
#include "fem/contact.hpp"
#include "fem/press.hpp"

namespace palpate::fem::lanes {
namespace {

using LaneValues = std::array<float, kLanes>;

// The slope left after a step, as a share of the first one, above which the step is cut. Skin that
// meets the sphere within a step makes it steep, and the next step mends that faster than a cut.
constexpr float kSlopeLeft = 2;
constexpr float kDeepestCut = 0.5f, kShallowestCut = 0.7f;  // [-] of the step
constexpr float kInvertedCut = 0.4f;                        // [-] of a step that inverts an element
constexpr int kMostCuts = 12;                               // then the lane has failed
constexpr float kFirstShift = 0.3f;  // [-] of mu: about the loss of stiffness that is met
constexpr float kShiftGrowth = 5;    // [-]
constexpr int kMostShifts = 6;
constexpr float kTravelStiffness = 2;  // [1/mm] of the load: half a millimetre back to the skin
// The tissue's part of the factor is taken anew for a load this many times that of the last one,
// and after so many steps; the contact's part is new in every step. Newton keeps its pace: the
// tissue changes little between loads, the contact much.
constexpr float kTissueGrowth = 1.4f;
constexpr int kTissueSteps = 8;
constexpr int kMostStates = 3;  // that an extrapolation goes through, with the state of rest

/// 64-byte aligned floats, kLanes per entry.
class LaneArray {
 public:
  explicit LaneArray(std::int64_t entries)
      : size_(entries * kLanes),
        data_(static_cast<float*>(std::aligned_alloc(64, size_ * sizeof(float)))) {
    if (!data_) throw std::bad_alloc();
    std::fill_n(data_.get(), size_, 0.0f);
  }
  float* data() { return data_.get(); }
  float& at(std::int64_t entry, int lane) { return data_.get()[entry * kLanes + lane]; }
  void zero() { std::fill_n(data_.get(), size_, 0.0f); }

 private:
  struct Free {
    void operator()(float* p) const { std::free(p); }
  };
  std::int64_t size_;
  std::unique_ptr<float[], Free> data_;
};

const Kernels& kernels_of(InstructionSet set) {
  switch (set) {
    case InstructionSet::avx512:
      return kAvx512;
    case InstructionSet::avx2:
      return kAvx2;
    case InstructionSet::baseline:
      break;
  }
  return kBaseline;
}

}  // namespace

InstructionSet best_instruction_set() {
  const char* wish = std::getenv("PALPATE_ISA");
  const std::string_view name = wish ? wish : "avx512";
  __builtin_cpu_init();
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma");
  const bool avx512 = avx2 && __builtin_cpu_supports("avx512f") &&
                      __builtin_cpu_supports("avx512vl") && __builtin_cpu_supports("avx512dq") &&
                      __builtin_cpu_supports("avx512bw");
  if (name == "avx512" && avx512) return InstructionSet::avx512;
  if (name != "baseline" && avx2) return InstructionSet::avx2;
  return InstructionSet::baseline;
}

struct BatchPress::Work {
  const Topology& topology;
  const Plan& plan;
  PlanView view;
  const Kernels& kernels;
  LaneArray tet_geometry, face_position, face_area, start, penalty;
  LaneArray factor, inverse_diagonal;
  LaneArray x_tissue;              // state at which the factor's tissue was linearised
  LaneArray tissue_on_contact;     // the contact's panels before the contact
  alignas(64) LaneValues shift{};  // of the tissue's Hessian, in units of mu
  float tissue_force = 0;          // load at which all lanes' tissue was linearised last
  LaneArray x, trial, gradient, trial_gradient, step;
  std::array<std::vector<float>, kMostStates> history;  // x of the last loads, newest last
  BatchView batch{};
  std::vector<LaneCurve> lanes;
  std::array<bool, kLanes> alive{};  // has converged at every load so far
  std::array<std::vector<double>, kLanes> travel, squared;

  Work(const Topology& t, const Plan& p, InstructionSet set)
      : topology(t),
        plan(p),
        view(p.view()),
        kernels(kernels_of(set)),
        tet_geometry(static_cast<std::int64_t>(view.tets) * kTetGeometry),
        face_position(static_cast<std::int64_t>(view.faces) * kFaceNodes * 3),
        face_area(view.faces),
        start(1),
        penalty(1),
        factor(p.factor_entries),
        inverse_diagonal(p.unknowns),
        x_tissue(p.unknowns + 3),
        tissue_on_contact(p.factor_entries - p.contact_start()),
        x(p.unknowns + 3),
        trial(p.unknowns + 3),
        gradient(p.unknowns + 3),
        trial_gradient(p.unknowns + 3),
        step(p.unknowns + 3) {}

  int travel_slot() const { return plan.unknowns - 1; }
  float* contact_panels() { return &factor.at(plan.contact_start(), 0); }
  std::int64_t contact_entries() const {
    return (plan.factor_entries - plan.contact_start()) * kLanes;
  }
  void set_geometry(std::span<const BatchPatch> patches, double radius);
  void set_lane_geometry(int lane, const BatchPatch& patch, double radius);
  void watch(std::span<const std::vector<std::int32_t>> groups);
  LaneValues evaluate(LaneArray& at, LaneArray& out, float force, LaneValues& squared_pressure);
  LaneValues largest(LaneArray& a);
  LaneValues dot(LaneArray& a, LaneArray& b);
  void extrapolate(std::span<const double> forces, std::size_t load, std::size_t use,
                   LaneArray& out);
  void predict(std::span<const double> forces, std::size_t load);
  void linearise_tissue(int lane, float with_shift);
  void factorize(const std::array<bool, kLanes>& active, float force, bool tissue_too);
  void newton_step(const std::array<bool, kLanes>& active);
  void solve_load(std::span<const double> forces, std::size_t load, const BatchOptions& options);
  void line_search(const std::array<bool, kLanes>& active, float force,
                   LaneValues& squared_pressure);
};

void BatchPress::Work::set_lane_geometry(int lane, const BatchPatch& patch, double radius) {
  const std::vector<Vec3>& nodes = patch.nodes;
  for (int t = 0; t < view.tets; ++t) {
    const std::int32_t* n = &topology.tets[static_cast<std::size_t>(t) * kTetNodes];
    Mat3 edges;
    for (int m = 0; m < 3; ++m) edges.col(m) = nodes[n[m + 1]] - nodes[n[0]];
    const Mat3 inverse = edges.inverse();  // row m is the gradient of barycentric coordinate m + 1
    Eigen::Matrix<double, 4, 3> g;
    g.bottomRows<3>() = inverse;
    g.row(0) = -inverse.colwise().sum();
    for (int m = 0; m < 4; ++m)
      for (int i = 0; i < 3; ++i)
        tet_geometry.at(t * kTetGeometry + 3 * m + i, lane) = static_cast<float>(g(m, i));
    tet_geometry.at(t * kTetGeometry + 12, lane) = static_cast<float>(edges.determinant() / 6);
    const LameModuli& m = patch.moduli[patch.moduli.size() == 1 ? 0 : t];
    tet_geometry.at(t * kTetGeometry + 13, lane) = static_cast<float>(m.lambda);
    tet_geometry.at(t * kTetGeometry + 14, lane) = static_cast<float>(m.mu);
  }
  for (int f = 0; f < view.faces; ++f) {
    const std::int32_t* n = &topology.contact_faces[static_cast<std::size_t>(f) * kFaceNodes];
    for (int a = 0; a < kFaceNodes; ++a)
      for (int i = 0; i < 3; ++i)
        face_position.at((f * kFaceNodes + a) * 3 + i, lane) = static_cast<float>(nodes[n[a]][i]);
    face_area.at(f, lane) = static_cast<float>(
        0.5 * (nodes[n[1]] - nodes[n[0]]).cross(nodes[n[2]] - nodes[n[0]]).norm());
  }
  penalty.at(0, lane) = static_cast<float>(patch.penalty);
  start.at(0, lane) = static_cast<float>(-first_contact(
      topology.contact_faces, topology.order, nodes, Vec3::Zero(), -Vec3::UnitZ(), radius));
}

void BatchPress::Work::set_geometry(std::span<const BatchPatch> patches, double radius) {
  // Lanes without a patch repeat the first one; their results are dropped.
  for (int lane = 0; lane < kLanes; ++lane)
    set_lane_geometry(lane, patches[static_cast<std::size_t>(lane) < patches.size() ? lane : 0],
                      radius);
  batch.tet_geometry = tet_geometry.data();
  batch.face_position = face_position.data();
  batch.face_area = face_area.data();
  batch.start = start.data();
  batch.penalty = penalty.data();
  batch.radius = static_cast<float>(radius);
}

/// Notes how far each group's nodes have gone down at the load just solved.
void BatchPress::Work::watch(std::span<const std::vector<std::int32_t>> groups) {
  for (const std::vector<std::int32_t>& group : groups)
    for (int l = 0; l < kLanes; ++l) {
      double sum = 0;
      for (const std::int32_t node : group) sum -= x.at(plan.slot[node] + 2, l);
      lanes[l].sunk.push_back(sum / static_cast<double>(group.size()));
    }
}

/// Gradient of the total potential; returns admissible (1 or 0) per lane.
LaneValues BatchPress::Work::evaluate(LaneArray& at, LaneArray& out, float force,
                                      LaneValues& squared_pressure) {
  alignas(64) LaneValues admissible{}, q{};
  kernels.gradient(view, batch, at.data(), out.data(), admissible.data(), q.data());
  for (int l = 0; l < kLanes; ++l) {
    out.at(travel_slot(), l) -= force;
    for (int i = 0; i < 3; ++i) out.at(plan.unknowns + i, l) = 0;
  }
  squared_pressure = q;
  return admissible;
}

LaneValues BatchPress::Work::largest(LaneArray& a) {
  LaneValues m{};
  const float* p = a.data();
  for (int i = 0; i < plan.unknowns; ++i, p += kLanes)
    for (int l = 0; l < kLanes; ++l) m[l] = std::max(m[l], std::abs(p[l]));
  return m;
}

LaneValues BatchPress::Work::dot(LaneArray& a, LaneArray& b) {
  std::array<double, kLanes> sum{};
  const float *p = a.data(), *q = b.data();
  for (int i = 0; i < plan.unknowns; ++i, p += kLanes, q += kLanes)
    for (int l = 0; l < kLanes; ++l) sum[l] += static_cast<double>(p[l]) * q[l];
  LaneValues out;
  for (int l = 0; l < kLanes; ++l) out[l] = static_cast<float>(sum[l]);
  return out;
}

/// Polynomial through the last `use` states, that of rest at zero force included, in the root of
/// the force: the travel of a sphere goes with F^(1/2) on a thin layer and F^(2/3) on a deep one.
void BatchPress::Work::extrapolate(std::span<const double> forces, std::size_t load,
                                   std::size_t use, LaneArray& out) {
  const auto at = [&](std::size_t back) {
    return back > load ? 0.0 : std::sqrt(forces[load - back]);
  };
  out.zero();
  for (std::size_t i = 1; i <= use; ++i) {
    double weight = 1;
    for (std::size_t j = 1; j <= use; ++j)
      if (j != i) weight *= (at(0) - at(j)) / (at(i) - at(j));
    if (i > load) continue;  // the state of rest
    const std::vector<float>& state = history[history.size() - i];
    for (std::size_t k = 0; k < state.size(); ++k)
      out.data()[k] += static_cast<float>(weight) * state[k];
  }
}

/// x becomes, lane by lane, the extrapolation of highest order that inverts nothing.
void BatchPress::Work::predict(std::span<const double> forces, std::size_t load) {
  std::array<bool, kLanes> done{};
  LaneValues unused;
  for (std::size_t use = std::min<std::size_t>(kMostStates, load + 1); use > 1; --use) {
    extrapolate(forces, load, use, trial);
    const LaneValues fine = evaluate(trial, trial_gradient, 0, unused);
    for (int l = 0; l < kLanes; ++l) {
      if (done[l] || fine[l] == 0) continue;
      done[l] = true;
      for (int i = 0; i < plan.unknowns; ++i) x.at(i, l) = trial.at(i, l);
    }
  }
}

void BatchPress::Work::linearise_tissue(int lane, float with_shift) {
  shift[lane] = with_shift;
  for (int i = 0; i < plan.unknowns; ++i) x_tissue.at(i, lane) = x.at(i, lane);
}

/// The factor: of the tissue at x_tissue (`tissue_too`: there it becomes x) and of the contact at
/// x. Where a lane has no positive definite Hessian, first the contact loses its indefinite part,
/// then the tissue gets a shift, at x; where the largest does not help either, the lane dies. What
/// the other lanes get stays the same, bit by bit.
void BatchPress::Work::factorize(const std::array<bool, kLanes>& active, float force,
                                 bool tissue_too) {
  alignas(64) LaneValues tissue_positive{}, positive{}, convex{};
  if (tissue_too)
    for (int l = 0; l < kLanes; ++l)
      if (active[l]) linearise_tissue(l, 0);
  for (int attempt = 0; attempt <= kMostShifts; ++attempt) {
    if (tissue_too) {
      kernels.tissue_hessian(view, batch, x_tissue.data(), shift.data(), factor.data());
      kernels.factorize_tissue(view, factor.data(), inverse_diagonal.data(),
                               tissue_positive.data());
      std::copy_n(contact_panels(), contact_entries(), tissue_on_contact.data());
    } else {
      std::copy_n(tissue_on_contact.data(), contact_entries(), contact_panels());
      if (attempt == 0) tissue_positive.fill(1);
    }
    kernels.contact_hessian(view, batch, x.data(), convex.data(), factor.data());
    kernels.factorize_contact(view, factor.data(), inverse_diagonal.data(), positive.data());
    tissue_too = false;
    bool again = false;
    for (int l = 0; l < kLanes; ++l) {
      positive[l] = std::min(positive[l], tissue_positive[l]);
      if (!active[l] || positive[l] > 0) continue;
      again = true;
      if (tissue_positive[l] > 0 && convex[l] == 0) {
        convex[l] = kTravelStiffness * force;
        continue;
      }
      linearise_tissue(l, shift[l] > 0 ? shift[l] * kShiftGrowth : kFirstShift);
      tissue_too = true;
    }
    if (!again) break;
  }
  for (int l = 0; l < kLanes; ++l)
    if (active[l]) {
      lanes[l].shifts += shift[l] > 0;
      alive[l] = alive[l] && positive[l] > 0;
    }
}

/// step = -H^-1 gradient with the last factor; frozen lanes get no step.
void BatchPress::Work::newton_step(const std::array<bool, kLanes>& active) {
  std::copy_n(gradient.data(), static_cast<std::size_t>(plan.unknowns) * kLanes, step.data());
  kernels.solve(view, factor.data(), inverse_diagonal.data(), step.data());
  for (int i = 0; i < plan.unknowns; ++i)
    for (int l = 0; l < kLanes; ++l) {
      float& s = step.at(i, l);
      s = active[l] && alive[l] ? -s : 0;
    }
}

void BatchPress::Work::line_search(const std::array<bool, kLanes>& active, float force,
                                   LaneValues& squared_pressure) {
  const LaneValues slope = dot(gradient, step);
  LaneValues length, q;
  length.fill(1);
  std::array<bool, kLanes> open = active;
  for (int l = 0; l < kLanes; ++l)
    if (open[l] && !(alive[l] && slope[l] < 0)) open[l] = alive[l] = false;
  for (int cut = 0; cut <= kMostCuts && std::count(open.begin(), open.end(), true) > 0; ++cut) {
    for (int i = 0; i < plan.unknowns; ++i)
      for (int l = 0; l < kLanes; ++l) trial.at(i, l) = x.at(i, l) + length[l] * step.at(i, l);
    const LaneValues fine = evaluate(trial, trial_gradient, force, q);
    const LaneValues left = dot(trial_gradient, step);
    for (int l = 0; l < kLanes; ++l) {
      if (!open[l]) continue;
      if (fine[l] == 0 || !std::isfinite(left[l])) {
        length[l] *= kInvertedCut;
      } else if (left[l] > kSlopeLeft * -slope[l]) {
        length[l] *= std::clamp(slope[l] / (slope[l] - left[l]), kDeepestCut, kShallowestCut);
      } else {
        open[l] = false;
        squared_pressure[l] = q[l];
        for (int i = 0; i < plan.unknowns; ++i) {
          x.at(i, l) = trial.at(i, l);
          gradient.at(i, l) = trial_gradient.at(i, l);
        }
      }
    }
  }
  for (int l = 0; l < kLanes; ++l)
    if (open[l]) alive[l] = false;
}

void BatchPress::Work::solve_load(std::span<const double> forces, std::size_t load,
                                  const BatchOptions& options) {
  const auto force = static_cast<float>(forces[load]);
  // By the loads alone: what happens to one lane must not depend on the others.
  const bool grown = force >= kTissueGrowth * tissue_force;
  if (grown) tissue_force = force;
  LaneValues squared_pressure{};
  const LaneValues fine = evaluate(x, gradient, force, squared_pressure);
  for (int l = 0; l < kLanes; ++l) alive[l] = alive[l] && fine[l] > 0;
  for (int iteration = 0; iteration <= options.max_iterations; ++iteration) {
    const LaneValues residual = largest(gradient);
    std::array<bool, kLanes> active{};
    bool any_active = false;
    for (int l = 0; l < kLanes; ++l) {
      active[l] = alive[l] && !(residual[l] <= options.relative_tolerance * force);
      any_active = any_active || active[l];
      if (active[l] && iteration == options.max_iterations) alive[l] = false;
    }
    if (!any_active || iteration == options.max_iterations) break;
    for (int l = 0; l < kLanes; ++l) lanes[l].iterations += active[l];
    factorize(active, force, iteration == 0 ? grown : iteration % kTissueSteps == 0);
    newton_step(active);
    line_search(active, force, squared_pressure);
  }
  for (int l = 0; l < kLanes; ++l) {
    travel[l].push_back(x.at(travel_slot(), l));
    squared[l].push_back(squared_pressure[l]);
  }
}

BatchPress::BatchPress(const Topology& topology, const Plan& plan, InstructionSet set)
    : work_(std::make_unique<Work>(topology, plan, set)) {}
BatchPress::~BatchPress() = default;
BatchPress::BatchPress(BatchPress&&) noexcept = default;

std::vector<LaneCurve> BatchPress::press(std::span<const BatchPatch> patches, double tool_radius,
                                         std::span<const double> forces,
                                         std::span<const std::vector<std::int32_t>> watched,
                                         const BatchOptions& options) {
  Work& w = *work_;
  if (patches.empty() || patches.size() > kLanes) throw InputError("a batch holds 1 to 16 patches");
  w.set_geometry(patches, tool_radius);
  w.lanes.assign(kLanes, {});
  w.alive.fill(true);
  for (int l = 0; l < kLanes; ++l) w.travel[l].clear(), w.squared[l].clear();
  w.tissue_force = 0;
  w.x.zero();
  for (int l = 0; l < kLanes; ++l)
    w.x.at(w.travel_slot(), l) = static_cast<float>(options.first_guess);
  for (std::size_t load = 0; load < forces.size(); ++load) {
    if (load > 0) w.predict(forces, load);
    w.solve_load(forces, load, options);
    w.watch(watched);
    std::rotate(w.history.begin(), w.history.begin() + 1, w.history.end());
    w.history.back().assign(w.x.data(),
                            w.x.data() + static_cast<std::size_t>(w.plan.unknowns) * kLanes);
  }
  w.lanes.resize(patches.size());
  for (std::size_t l = 0; l < patches.size(); ++l)
    if (w.alive[l])
      w.lanes[l].travel =
          rigid_contact_travel(forces, w.travel[l], w.squared[l], patches[l].penalty);
  return w.lanes;
}

}  // namespace palpate::fem::lanes
