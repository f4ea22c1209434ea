// SPDX-License-Identifier: GPL-3.0-or-later
// Dead loads, the spring net, and the indenter by displacement control.
#include "fem/loads.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "core/error.hpp"
#include "fem/equilibrium.hpp"
#include "fem/press.hpp"
#include "fem/spring_net.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

const LameModuli kFlesh = lame_moduli(0.045658, 0.43);

/// The unit cube on its floor, with its top.
struct Block {
  TetMesh mesh;
  std::vector<std::uint8_t> held;
  FaceList top;
  explicit Block(ElementOrder order, int cells = 2)
      : mesh(scenes::in_order(scenes::cube(cells), order)) {
    for (const Vec3& p : mesh.nodes) held.push_back(p.z() < 1e-9);
    const FaceList all = boundary_faces(mesh);
    const int stride = face_nodes(order);
    for (std::size_t f = 0; f < all.size(); f += stride)
      if (mesh.nodes[all[f]].z() + mesh.nodes[all[f + 1]].z() + mesh.nodes[all[f + 2]].z() > 2.99)
        top.insert(top.end(), &all[f], &all[f] + stride);
  }
};

TEST(Loads, APressurePatchPushesWithOneNewtonThroughItsCentre) {
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const Block b(order, 4);
    const Vec3 centre(0.5, 0.5, 1);
    Vec3 sum = Vec3::Zero(), moment = Vec3::Zero();
    for (const NodalLoad& l :
         pressure_patch(b.top, order, b.mesh.nodes, centre, -Vec3::UnitZ(), 0.5)) {
      sum += l.force;
      moment += (b.mesh.nodes[l.node] - centre).cross(l.force);
    }
    EXPECT_LT((sum + Vec3::UnitZ()).norm(), 1e-12);
    EXPECT_LT(moment.norm(), 1e-2);
    EXPECT_THROW((void)pressure_patch(b.top, order, b.mesh.nodes, Vec3(9, 9, 1), -Vec3::UnitZ(), 1),
                 InputError);
  }
}

TEST(Loads, LoadUpFindsTheSameStatesAsOneSolve) {
  const Block b(ElementOrder::quadratic);
  const Topology t = make_topology(b.mesh, b.held);
  const auto loads =
      pressure_patch(b.top, b.mesh.order, b.mesh.nodes, Vec3(0.5, 0.5, 1), -Vec3::UnitZ(), 0.6);
  const ElasticBody body(t, b.mesh.nodes, neo_hookean(kFlesh));
  Cholesky cholesky(t.pattern);
  const std::vector<double> factors = {0.002, 0.005, 0.01};
  const LoadedStates up = load_up(body, load_vector(t, loads), factors, cholesky);
  ASSERT_EQ(up.failure, "");
  std::vector<HeldNode> held;
  for (std::size_t n = 0; n < b.held.size(); ++n)
    if (b.held[n]) held.push_back({static_cast<int>(n), Vec3::Zero()});
  std::vector<NodalLoad> last = loads;
  for (NodalLoad& l : last) l.force *= factors.back();
  const Equilibrium once = solve_equilibrium(b.mesh, neo_hookean(kFlesh), held, last, {1e-10, 60});
  for (std::size_t n = 0; n < b.held.size(); ++n)
    EXPECT_LT(
        (body.displacement(up.states.back(), static_cast<int>(n)) - once.displacement[n]).norm(),
        1e-6);
}

// A net under a force that folds it has no equilibrium that Newton can reach at once, or one with
// tissue inside out; the neo-Hookean body refuses to invert whatever the load.
TEST(Loads, NoLoadInvertsALawWithABarrier) {
  const Block b(ElementOrder::linear);
  const Topology t = make_topology(b.mesh, b.held);
  int node = 0;
  while (!(b.mesh.nodes[node] - Vec3(0.5, 0.5, 1)).isZero(1e-9)) ++node;
  const Eigen::VectorXd unit = load_vector(t, nodal_force(node, -Vec3::UnitZ()));
  Cholesky cholesky(t.pattern);
  const ElasticBody neo(t, b.mesh.nodes, neo_hookean(kFlesh)),
      kirchhoff(t, b.mesh.nodes, st_venant_kirchhoff(kFlesh));
  const std::vector<double> factors = {0.02, 0.1};
  const LoadedStates barrier = load_up(neo, unit, factors, cholesky),
                     none = load_up(kirchhoff, unit, factors, cholesky);
  ASSERT_EQ(barrier.states.size(), 2u) << barrier.failure;
  EXPECT_EQ(neo.inverted_tets(barrier.states.back()), 0);
  EXPECT_TRUE(!none.failure.empty() || kirchhoff.inverted_tets(none.states.back()) > 0);
}

TEST(SpringNet, DerivativesMatchDifferences) {
  const Block b(ElementOrder::linear);
  const Topology t = make_topology(b.mesh, b.held);
  const SpringNet net(t, b.mesh.nodes, 0.045658);
  std::mt19937_64 random(4);
  std::uniform_real_distribution<double> d(-0.1, 0.1);
  Eigen::VectorXd x(t.unknowns()), direction(t.unknowns());
  for (double& v : x) v = d(random);
  for (double& v : direction) v = d(random);
  const auto gradient = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(at.size());
    net.add_derivatives(at, HessianKind::exact, &g, nullptr);
    return g;
  };
  std::vector<double> values(t.pattern.row.size(), 0.0);
  net.add_derivatives(x, HessianKind::exact, nullptr, &values);
  Eigen::VectorXd product = Eigen::VectorXd::Zero(x.size());
  for (int c = 0; c < t.pattern.size; ++c)
    for (int i = t.pattern.column_start[c]; i < t.pattern.column_start[c + 1]; ++i) {
      const int r = t.pattern.row[i];
      product[r] += values[i] * direction[c];
      if (r != c) product[c] += values[i] * direction[r];
    }
  constexpr double h = 1e-5;
  const auto slope = [&](double s) { return net.energy(x + s * h * direction); };
  EXPECT_NEAR((8 * (slope(1) - slope(-1)) - (slope(2) - slope(-2))) / (12 * h),
              gradient(x).dot(direction), 1e-6 * gradient(x).norm() * direction.norm());
  const Eigen::VectorXd curved =
      (gradient(x + h * direction) - gradient(x - h * direction)) / (2 * h);
  EXPECT_LT((curved - product).norm(), 1e-6 * product.norm());
}

// A bar of cubes pulled at both ends keeps its Young's modulus within the net's anisotropy.
TEST(SpringNet, IsAsStiffAsItsModulusRoughly) {
  const Block b(ElementOrder::linear, 4);
  const Topology t = make_topology(b.mesh, b.held);
  const SpringNet net(t, b.mesh.nodes, 0.045658);
  const auto loads =
      pressure_patch(b.top, b.mesh.order, b.mesh.nodes, Vec3(0.5, 0.5, 1), Vec3::UnitZ(), 100);
  Cholesky cholesky(t.pattern);
  const std::vector<double> factors = {4.5658e-4};  // one percent of the modulus
  const LoadedStates s = load_up(net, load_vector(t, loads), factors, cholesky);
  ASSERT_EQ(s.failure, "");
  double mean = 0;
  int count = 0;
  for (std::size_t n = 0; n < b.held.size(); ++n)
    if (b.mesh.nodes[n].z() > 0.99) {
      mean += net.displacement(s.states[0], static_cast<int>(n)).z();
      ++count;
    }
  EXPECT_NEAR(mean / count, 0.01, 0.004);
}

TEST(Press, DisplacementControlIsTheInverseOfLoadControl) {
  const Block b(ElementOrder::quadratic);
  const Topology t = make_topology(b.mesh, b.held, b.top);
  Indenter tool;
  tool.radius = 0.8;
  tool.start = Vec3(0.5, 0.5, 1.8);
  tool.penalty = 40;
  const ElasticBody body(t, b.mesh.nodes, neo_hookean(kFlesh));
  const Contact contact(t, b.mesh.nodes, tool);
  Cholesky cholesky(t.pattern);
  PressOptions options;
  options.first_guess = 0.02;
  options.relative_tolerance = 1e-8;
  const std::vector<double> forces = {0.001, 0.003, 0.01};
  const PressCurve loaded = press(body, contact, forces, cholesky, options);
  ASSERT_TRUE(loaded.complete) << loaded.failure;
  const PressForces driven = press_to(body, contact, loaded.penalised_travel, cholesky, options);
  ASSERT_TRUE(driven.complete) << driven.failure;
  for (std::size_t i = 0; i < forces.size(); ++i)
    EXPECT_NEAR(driven.penalised_force[i] / forces[i], 1, 1e-5);
}

}  // namespace
}  // namespace palpate::fem
