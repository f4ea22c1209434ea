// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/equilibrium.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"
#include "scenes.hpp"

namespace palpate::fem {
namespace {

std::shared_ptr<const EnergyDensity> flesh() {
  return neo_hookean(lame_moduli(0.045658, 0.43));
}

std::vector<HeldNode> floor_of(const TetMesh& mesh) {
  std::vector<HeldNode> held;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n].z() < 1e-9) held.push_back({static_cast<int>(n), Vec3::Zero()});
  return held;
}

// One element under uniaxial strain has a closed form: P = mu (s - 1/s) + lambda ln(s) / s.
TEST(Equilibrium, UniaxialStrainMatchesTheClosedForm) {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  const TetMesh mesh = to_quadratic(scenes::cube(1));
  const double s = 0.6;
  std::vector<HeldNode> held;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (scenes::on_cube_surface(mesh.nodes[n]))
      held.push_back({static_cast<int>(n), Vec3(0, 0, (s - 1) * mesh.nodes[n].z())});
  const Equilibrium e = solve_equilibrium(mesh, flesh(), held, {}, {1e-13, 60});
  double pull = 0;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n].z() > 1 - 1e-9) pull += e.reaction[n].z();
  EXPECT_NEAR(pull, m.mu * (s - 1 / s) + m.lambda * std::log(s) / s, 1e-9);
}

TEST(Equilibrium, ReactionsBalanceTheLoads) {
  const TetMesh mesh = to_quadratic(scenes::cube(2));
  const Vec3 force(2e-4, -1e-4, -5e-4);
  std::vector<NodalLoad> loads;
  Vec3 applied = Vec3::Zero();
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n].z() > 1 - 1e-9) {
      loads.push_back({static_cast<int>(n), force});
      applied += force;
    }
  const Equilibrium e = solve_equilibrium(mesh, flesh(), floor_of(mesh), loads);
  Vec3 pushed = Vec3::Zero();
  for (const Vec3& r : e.reaction) pushed += r;
  EXPECT_LT((pushed + applied).norm(), 1e-6);
  EXPECT_LE(e.residual, 1e-6);
}

TEST(Equilibrium, NamesWhatIsWrong) {
  TetMesh mesh = scenes::cube(1);
  const std::vector<HeldNode> twice = {{0, Vec3::Zero()}, {0, Vec3::Zero()}};
  EXPECT_THROW((void)solve_equilibrium(mesh, flesh(), twice, {}), InputError);
  const std::vector<NodalLoad> nowhere = {{99, Vec3::UnitX()}};
  EXPECT_THROW((void)solve_equilibrium(mesh, flesh(), floor_of(mesh), nowhere), InputError);
  std::swap(mesh.tets[0], mesh.tets[1]);
  try {
    (void)solve_equilibrium(mesh, flesh(), floor_of(mesh), {});
    FAIL() << "an inverted tetrahedron went through";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("tetrahedron 0"), std::string::npos);
  }
}

// St. Venant-Kirchhoff loses its stiffness under compression: there is no equilibrium, and the
// solver says so instead of returning numbers.
TEST(Equilibrium, FailureIsTypedAndCarriesTheResidual) {
  const TetMesh mesh = to_quadratic(scenes::cube(1));
  std::vector<NodalLoad> loads;
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    if (mesh.nodes[n].z() > 1 - 1e-9) loads.push_back({static_cast<int>(n), Vec3(0, 0, -0.05)});
  try {
    (void)solve_equilibrium(mesh, flesh(), floor_of(mesh), loads, {1e-9, 2});
    FAIL() << "two Newton steps cannot have sufficed";
  } catch (const SolveError& e) {
    EXPECT_GT(e.residual, 1e-9);
    EXPECT_EQ(e.iterations, 2);
  }
}

}  // namespace
}  // namespace palpate::fem
