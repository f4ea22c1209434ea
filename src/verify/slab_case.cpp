// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/slab_case.hpp"

namespace palpate::verify {

SlabCase slab_case(fem::ElementOrder order, std::vector<double> forces) {
  constexpr double kPatchRadius = 8;  // [mm] a finger pad
  SlabRule rule;
  rule.rings = {2.5, 5, 8, 11, 16, 26, 42};
  rule.sectors = 10;
  rule.depths = graded_depths(12, 2, 1.3);
  rule.touch_radius = 1.5 * kPatchRadius;
  SlabCase scene{make_slab(rule, order), {}, {}, std::move(forces)};
  scene.topology = fem::make_topology(scene.slab.mesh, scene.slab.held);
  scene.unit = fem::pressure_patch(scene.slab.touchable, order, scene.slab.mesh.nodes, Vec3::Zero(),
                                   -Vec3::UnitZ(), kPatchRadius);
  return scene;
}

SlabFields solve_ours(const SlabCase& scene, const fem::TissueLaws& laws) {
  const fem::ElasticBody body(scene.topology, scene.slab.mesh.nodes, laws);
  fem::Cholesky cholesky(scene.topology.pattern);
  fem::LoadUpOptions tight;
  tight.relative_tolerance = 1e-10;
  const fem::LoadedStates s = fem::load_up(body, fem::load_vector(scene.topology, scene.unit),
                                           scene.forces, cholesky, tight);
  SlabFields out{{}, s.failure, s.reached};
  for (const Eigen::VectorXd& x : s.states) {
    Field field;
    for (std::size_t n = 0; n < scene.slab.mesh.nodes.size(); ++n)
      field.push_back(body.displacement(x, static_cast<int>(n)));
    if (out.first_inverted < 0 && body.inverted_tets(x) > 0)
      out.first_inverted = static_cast<int>(out.at.size());
    out.at.push_back(std::move(field));
  }
  return out;
}

double field_difference(const Field& ours, const Field& reference) {
  double difference = 0, size = 0;
  for (std::size_t n = 0; n < reference.size(); ++n) {
    difference = std::max(difference, (ours[n] - reference[n]).norm());
    size = std::max(size, reference[n].norm());
  }
  return difference / size;
}

}  // namespace palpate::verify
