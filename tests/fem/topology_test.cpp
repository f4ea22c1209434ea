// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/topology.hpp"

#include <gtest/gtest.h>

#include <random>

#include "core/error.hpp"
#include "fem/contact.hpp"
#include "fem/elastic_body.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

struct Scene {
  TetMesh mesh = to_quadratic(scenes::cube(2));
  Topology topology;
  std::shared_ptr<const EnergyDensity> law = neo_hookean(lame_moduli(0.045658, 0.43));
  Scene() {
    std::vector<std::uint8_t> held;
    for (const Vec3& p : mesh.nodes) held.push_back(p.z() < 1e-9);
    FaceList top;
    const FaceList all = boundary_faces(mesh);
    for (std::size_t f = 0; f < all.size(); f += 6)
      if (mesh.nodes[all[f]].z() > 0.99 && mesh.nodes[all[f + 1]].z() > 0.99 &&
          mesh.nodes[all[f + 2]].z() > 0.99)
        top.insert(top.end(), &all[f], &all[f] + 6);
    topology = make_topology(mesh, held, top);
  }
  Indenter tool() const {
    Indenter t;
    t.radius = 0.7;
    t.start = Vec3(0.45, 0.55, 1.7);
    return t;
  }
};

Eigen::VectorXd random_unknowns(const Topology& t, double size) {
  std::mt19937_64 random(2);
  std::uniform_real_distribution<double> d(-size, size);
  Eigen::VectorXd x(t.unknowns());
  for (double& v : x) v = d(random);
  return x;
}

Eigen::MatrixXd dense(const SparsePattern& p, const std::vector<double>& values) {
  Eigen::MatrixXd m = Eigen::MatrixXd::Zero(p.size, p.size);
  for (int c = 0; c < p.size; ++c)
    for (int i = p.column_start[c]; i < p.column_start[c + 1]; ++i)
      m(p.row[i], c) = m(c, p.row[i]) = values[i];
  return m;
}

// Gradient and Hessian of the assembled potential against differences of its energy.
TEST(Assembly, DerivativesOfBodyAndContactMatchDifferences) {
  const Scene s;
  const ElasticBody body(s.topology, s.mesh.nodes, s.law);
  const Contact contact(s.topology, s.mesh.nodes, s.tool());
  Eigen::VectorXd x = random_unknowns(s.topology, 0.01);
  x[s.topology.travel()] = 0.15;
  const auto energy = [&](const Eigen::VectorXd& at) {
    return body.energy(at) + contact.energy(at);
  };
  const auto gradient = [&](const Eigen::VectorXd& at) {
    Eigen::VectorXd g = Eigen::VectorXd::Zero(at.size());
    body.add_derivatives(at, HessianKind::exact, &g, nullptr);
    contact.add_derivatives(at, HessianKind::exact, &g, nullptr);
    return g;
  };
  std::vector<double> values(s.topology.pattern.row.size(), 0.0);
  body.add_derivatives(x, HessianKind::exact, nullptr, &values);
  contact.add_derivatives(x, HessianKind::exact, nullptr, &values);
  const Eigen::MatrixXd hessian = dense(s.topology.pattern, values);
  const Eigen::VectorXd g = gradient(x), direction = random_unknowns(s.topology, 1);
  constexpr double h = 1e-6;
  EXPECT_NEAR((energy(x + h * direction) - energy(x - h * direction)) / (2 * h), g.dot(direction),
              1e-6 * g.norm() * direction.norm());
  const Eigen::VectorXd curved =
      (gradient(x + h * direction) - gradient(x - h * direction)) / (2 * h);
  EXPECT_LT((curved - hessian * direction).norm(), 1e-6 * curved.norm());
}

TEST(Assembly, AreaOfAFullTouchIsTheFacesArea) {
  const Scene s;
  Indenter tool = s.tool();
  tool.radius = 100;
  tool.start = Vec3(0.5, 0.5, 101);
  const Contact contact(s.topology, s.mesh.nodes, tool);
  Eigen::VectorXd x = Eigen::VectorXd::Zero(s.topology.unknowns());
  const double depth = 2;
  x[s.topology.travel()] = depth;
  // 1 mm^2 pressed by about 2 mm: Q = penalty^2 * integral of gap^2.
  const double mean_gap_squared = contact.squared_pressure(x) / (tool.penalty * tool.penalty);
  EXPECT_NEAR(mean_gap_squared, 4, 0.01);
}

TEST(FirstContact, IsWhereASphereMeetsATiltedPlane) {
  Scene s;
  for (Vec3& p : s.mesh.nodes) p.z() += 0.3 * (p.x() - 0.5);  // slope 0.3
  const double radius = 0.2;
  const double offset = first_contact(s.topology.contact_faces, ElementOrder::quadratic,
                                      s.mesh.nodes, Vec3(0.5, 0.5, 1), -Vec3::UnitZ(), radius);
  EXPECT_NEAR(-offset, radius * std::sqrt(1 + 0.3 * 0.3), 1e-12);
}

TEST(FirstContact, IsAtAnEdgeOrCornerWhereOneStandsOut) {
  const std::vector<Vec3> roof = {{0, -1, 0}, {0, 1, 0}, {2, 0, -2}, {-2, 0, -2}};
  const FaceList faces = {0, 2, 1, 0, 1, 3};
  const auto at = [&](const Vec3& through) {
    return first_contact(faces, ElementOrder::linear, roof, through, -Vec3::UnitZ(), 1.0);
  };
  EXPECT_NEAR(at(Vec3(0, 0.2, 0)), -1, 1e-12);                      // on the ridge
  EXPECT_NEAR(at(Vec3(0.1, 0.2, 0)), -std::sqrt(1 - 0.01), 1e-12);  // beside it
  EXPECT_NEAR(at(Vec3(0, 1.6, 0)), -std::sqrt(1 - 0.36), 1e-12);    // off its end
  EXPECT_THROW((void)at(Vec3(0, 5, 0)), InputError);
}

}  // namespace
}  // namespace palpate::fem
