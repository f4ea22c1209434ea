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
struct BatchTool {
  double radius = 8;   ///< [mm] sphere, coming down along -z
  double penalty = 5;  ///< [MPa/mm]
};
/// One lane's result.
struct LaneCurve {
  std::vector<double> travel;  ///< [mm] one per load, rigid contact; empty where one failed
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

  /// The same equilibria as press() with neo-Hookean tissue and a sphere from its first contact,
  /// to about 1e-4 of the travel.
  /// @param patches  1 to 16 lists of rest positions [mm], one per node of the topology, straight
  ///                 sides, the site at the origin and the outward normal +z
  /// @param forces   [N] ascending, > 0
  /// @note A lane's result does not depend on the other lanes. A lane that does not converge has an
  /// empty curve; solve it in double precision.
  [[nodiscard]] std::vector<LaneCurve> press(std::span<const std::vector<Vec3>> patches,
                                             const LameModuli& moduli, const BatchTool& tool,
                                             std::span<const double> forces,
                                             const BatchOptions& options = {});

 private:
  struct Work;
  std::unique_ptr<Work> work_;
};

}  // namespace palpate::fem::lanes
