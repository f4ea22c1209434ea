// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/dynamics.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "core/error.hpp"
#include "fem/loads.hpp"
#include "fem/published.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

struct Block {
  TetMesh mesh = scenes::cube(3);
  std::vector<std::uint8_t> held;
  Topology topology;
  int top = 0;  ///< a node near the middle of the top
  Block() {
    for (Vec3& p : mesh.nodes) p *= 10;
    for (const Vec3& p : mesh.nodes) held.push_back(p.z() < 1e-9);
    topology = make_topology(mesh, held);
    for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
      if ((mesh.nodes[n] - Vec3(5, 5, 10)).norm() < (mesh.nodes[top] - Vec3(5, 5, 10)).norm())
        top = static_cast<int>(n);
  }
};

TEST(Dynamics, TheMassMatrixHoldsTheBodysMass) {
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const TetMesh mesh = scenes::in_order(scenes::cube(2), order);
    const std::vector<std::uint8_t> held(mesh.nodes.size(), 0);
    const Topology t = make_topology(mesh, held);
    const std::vector<double> density(mesh.size(), 1.06e-9);
    const std::vector<double> mass = consistent_mass(t, mesh.nodes, density);
    double sum = 0;  // over one direction: every third row and column
    for (int c = 0; c < t.pattern.size; c += 3)
      for (int i = t.pattern.column_start[c]; i < t.pattern.column_start[c + 1]; ++i)
        if (t.pattern.row[i] % 3 == 0) sum += (t.pattern.row[i] == c ? 1 : 2) * mass[i];
    EXPECT_NEAR(sum, 1.06e-9, 1e-20);
  }
}

TEST(Dynamics, ComesToRestAtTheStaticEquilibrium) {
  const Block b;
  const ElasticBody body(b.topology, b.mesh.nodes, neo_hookean(lame_moduli(0.045658, 0.43)));
  const std::vector<double> density(b.mesh.size(), 1.06e-9);
  const auto mass = consistent_mass(b.topology, b.mesh.nodes, density);
  const Eigen::VectorXd force = 0.1 * load_vector(b.topology, nodal_force(b.top, -Vec3::UnitZ()));
  Cholesky cholesky(b.topology.pattern);
  const std::vector<double> one = {1};
  const LoadedStates rest = load_up(body, force, one, cholesky);
  ASSERT_EQ(rest.failure, "");
  DynamicsOptions options;
  options.rest_move = 1e-6;
  const RestState moved = step_to_rest(body, mass, force, cholesky, options);
  EXPECT_TRUE(moved.at_rest);
  EXPECT_LT((moved.x - rest.states[0]).lpNorm<Eigen::Infinity>(), 1e-5);
}

// Undamped, a body that is let go under a small force swings to twice its static displacement.
TEST(Dynamics, WithoutDampingItDoesNotSettle) {
  const Block b;
  const ElasticBody body(b.topology, b.mesh.nodes, linear_elastic(lame_moduli(0.045658, 0.43)));
  const std::vector<double> density(b.mesh.size(), 1.06e-9);
  const auto mass = consistent_mass(b.topology, b.mesh.nodes, density);
  const Eigen::VectorXd force = 0.01 * load_vector(b.topology, nodal_force(b.top, -Vec3::UnitZ()));
  Cholesky cholesky(b.topology.pattern);
  DynamicsOptions options;
  options.mass_damping = options.stiffness_damping = 0;
  options.time_step = 1e-3;
  options.max_steps = 100;
  EXPECT_FALSE(step_to_rest(body, mass, force, cholesky, options).at_rest);
}

TEST(Published, SmallForcesAreFineAndLargeOnesTurnTissueInsideOut) {
  const Block b;
  Cholesky cholesky(b.topology.pattern);
  const std::vector<double> forces = {0.01, 1.0, 5.0};
  const auto samples =
      press_published(b.topology, b.mesh.nodes, {}, b.top, -Vec3::UnitZ(), forces, cholesky);
  EXPECT_TRUE(samples[0].at_rest);
  EXPECT_EQ(samples[0].inverted_tets, 0);
  EXPECT_GT(samples[0].displacement, 0);
  EXPECT_GT(samples[2].inverted_tets, 0);
  EXPECT_THROW(
      (void)press_published(b.topology, b.mesh.nodes, {}, 0, -Vec3::UnitZ(), forces, cholesky),
      InputError);
}

TEST(Published, BoneDoesNotYield) {
  const Block b;
  Cholesky cholesky(b.topology.pattern);
  std::vector<std::uint8_t> bone(b.mesh.size(), 1);
  const std::vector<double> forces = {5.0};
  const auto samples =
      press_published(b.topology, b.mesh.nodes, bone, b.top, -Vec3::UnitZ(), forces, cholesky);
  EXPECT_TRUE(samples[0].at_rest);
  EXPECT_LT(samples[0].displacement, 1e-2);
}

}  // namespace
}  // namespace palpate::fem
