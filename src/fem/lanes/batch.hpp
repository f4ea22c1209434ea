// SPDX-License-Identifier: GPL-3.0-or-later
// Sixteen patches of one topology pressed at once, one per SIMD lane, in single precision.
#pragma once
#include <memory>
#include <span>
#include <vector>

#include "fem/energy.hpp"
#include "fem/lanes/plan.hpp"

namespace palpate::fem::lanes {

enum class InstructionSet { baseline, avx2, avx512 };
/// The best one of this machine; PALPATE_ISA=baseline|avx2|avx512 in the environment lowers it.
[[nodiscard]] InstructionSet best_instruction_set();

struct BatchOptions {
  double relative_tolerance = 1e-3;  ///< [-] largest force left on a node, of the load; > 0
  int max_iterations = 40;           ///< Newton steps per load
  double first_guess = 0.2;          ///< [mm] travel that the first load starts from
};
/// One site's tissue.
struct BatchPatch {
  std::vector<Vec3> nodes;  ///< rest positions [mm], one per node of the topology, straight sides,
                            ///< the site at the origin and the outward normal +z
  std::vector<LameModuli> moduli;  ///< one per tetrahedron, or one for all
  double penalty = 5;              ///< [MPa/mm] default_penalty() of the top layer
};
/// One lane's result.
struct LaneCurve {
  std::vector<double> travel;  ///< [mm] one per load, rigid contact; empty where one failed
  std::vector<double> sunk;    ///< [mm] loads x groups: mean way down of each watched group's nodes
  int iterations = 0;          ///< Newton steps in which the lane took part
  int shifts = 0;              ///< steps that needed a shifted Hessian
};

/// Workspace of one thread: about 64 bytes per entry of the factor.
class BatchPress {
 public:
  /// @param topology  quadratic, with travel; plan made from it; both must outlive the object
  BatchPress(const Topology& topology, const Plan& plan, InstructionSet set);
  ~BatchPress();
  BatchPress(BatchPress&&) noexcept;

  /// The same equilibria as press() with neo-Hookean tissue and a sphere that comes down along -z
  /// from its first contact, to about 1e-4 of the travel.
  /// @param patches      1 to 16
  /// @param tool_radius  [mm]
  /// @param forces       [N] ascending, > 0
  /// @param watched      groups of nodes of the topology; may be empty
  /// @note A lane's result does not depend on the other lanes. A lane that does not converge has an
  /// empty curve; solve it in double precision.
  [[nodiscard]] std::vector<LaneCurve> press(
      std::span<const BatchPatch> patches, double tool_radius, std::span<const double> forces,
      std::span<const std::vector<std::int32_t>> watched = {}, const BatchOptions& options = {});

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpate::fem::lanes
