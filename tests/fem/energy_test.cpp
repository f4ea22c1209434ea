// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/energy.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <cmath>
#include <random>
#include <string_view>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

struct Law {
  const char* name;
  std::shared_ptr<const EnergyDensity> law;
};

std::vector<Law> all_laws() {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  MooneyRivlin fibre = mooney_rivlin_from(m);
  fibre.fibre_modulus = 0.02;
  fibre.fibre_axis = Vec3(1, 2, -0.5).normalized();
  MooneyRivlin quadratic = mooney_rivlin_from(m);
  quadratic.volume = VolumeTerm::quadratic;
  return {{"neo_hookean", neo_hookean(m)},
          {"linear", linear_elastic(m)},
          {"st_venant_kirchhoff", st_venant_kirchhoff(m)},
          {"st_venant_kirchhoff_wall", st_venant_kirchhoff(m, 500)},
          {"corotational", corotational(m)},
          {"mooney_rivlin_quadratic", mooney_rivlin(quadratic)},
          {"mooney_rivlin", mooney_rivlin(mooney_rivlin_from(m))},
          {"mooney_rivlin_fibre", mooney_rivlin(fibre)}};
}

Mat3 random_rotation(std::mt19937_64& random) {
  std::normal_distribution<double> d;
  return Eigen::Quaterniond(d(random), d(random), d(random), d(random))
      .normalized()
      .toRotationMatrix();
}

/// Random state with a volume ratio J between 0.3 and 3.
Mat3 random_state(std::mt19937_64& random) {
  std::uniform_real_distribution<double> stretch(std::log(0.6), std::log(1.6)),
      volume(std::log(0.3), std::log(3.0));
  Vec3 s(stretch(random), stretch(random), stretch(random));
  s.array() += (volume(random) - s.sum()) / 3;
  return random_rotation(random) * s.array().exp().matrix().asDiagonal() * random_rotation(random);
}

/// Fourth-order central difference of f at F along entry c.
template <class F>
auto difference(const F& f, const Mat3& state, int c) -> decltype(f(state)) {
  constexpr double h = 1e-3;  // error h^4: far below the bound
  const auto at = [&](double t) {
    Mat3 moved = state;
    moved.data()[c] += t * h;
    return f(moved);
  };
  return ((8 * (at(1) - at(-1)) - (at(2) - at(-2))) / (12 * h));
}

TEST(Energy, StressIsTheGradientAndTangentTheHessian) {
  std::mt19937_64 random(7);
  for (const Law& l : all_laws())
    for (int trial = 0; trial < 100; ++trial) {
      const Mat3 F = random_state(random);
      Mat3 stress;
      Mat9 tangent;
      for (int c = 0; c < 9; ++c) {
        stress.data()[c] = difference([&](const Mat3& x) { return l.law->value(x); }, F, c);
        tangent.col(c) =
            difference([&](const Mat3& x) -> Vec9 { return vec(l.law->stress(x)); }, F, c);
      }
      const Mat9 exact = l.law->tangent(F);
      EXPECT_LT((stress - l.law->stress(F)).norm(), 1e-6 * exact.norm()) << l.name;
      EXPECT_LT((tangent - exact).norm(), 1e-6 * exact.norm()) << l.name;
      EXPECT_LT((exact - exact.transpose()).norm(), 1e-12 * exact.norm()) << l.name;
    }
}

TEST(Energy, RestIsStressFreeWithHookesTangent) {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  const Mat9 hooke = linear_elastic(m)->tangent(Mat3::Identity());
  for (const Law& l : all_laws()) {
    if (std::string_view(l.name) == "mooney_rivlin_fibre") continue;
    EXPECT_NEAR(l.law->value(Mat3::Identity()), 0, 1e-15) << l.name;
    EXPECT_LT(l.law->stress(Mat3::Identity()).norm(), 1e-15) << l.name;
    EXPECT_LT((l.law->tangent(Mat3::Identity()) - hooke).norm(), 1e-12 * hooke.norm()) << l.name;
  }
}

TEST(Energy, NonlinearLawsDoNotFeelARotation) {
  std::mt19937_64 random(11);
  for (const Law& l : all_laws()) {
    if (std::string_view(l.name) == "linear") continue;
    for (int trial = 0; trial < 20; ++trial) {
      const Mat3 F = random_state(random), R = random_rotation(random);
      EXPECT_NEAR(l.law->value(R * F), l.law->value(F), 1e-12) << l.name;
      EXPECT_LT((l.law->stress(R * F) - R * l.law->stress(F)).norm(), 1e-11) << l.name;
    }
  }
}

TEST(Energy, BarrierForbidsInversion) {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  const Mat3 inverted = Vec3(-0.5, 1, 1).asDiagonal();
  EXPECT_EQ(neo_hookean(m)->value(inverted), kInadmissible);
  EXPECT_EQ(mooney_rivlin(mooney_rivlin_from(m))->value(inverted), kInadmissible);
  EXPECT_TRUE(std::isfinite(st_venant_kirchhoff(m)->value(inverted)));
}

// In uniaxial strain St. Venant-Kirchhoff carries at most (lambda + 2 mu) / (3 sqrt 3), at a
// stretch of 1 / sqrt 3; the neo-Hookean law has no such limit.
TEST(Energy, StVenantKirchhoffCollapsesUnderCompression) {
  const LameModuli m = lame_moduli(0.045658, 0.43);
  const auto svk = st_venant_kirchhoff(m), neo = neo_hookean(m);
  double most = 0, before = 0;
  for (double s = 1; s > 0.02; s -= 0.001) {
    const Mat3 F = Vec3(s, 1, 1).asDiagonal();
    most = std::max(most, -svk->stress(F)(0, 0));
    const double now = -neo->stress(F)(0, 0);
    EXPECT_GE(now, before);
    before = now;
  }
  EXPECT_NEAR(most, (m.lambda + 2 * m.mu) / (3 * std::sqrt(3.0)), 1e-4 * most);
}

// The wall of VEGA's invertible materials: c E / (1 - 2 nu) (1 - J)^3 / 2592 below J = 1, none
// above.
TEST(Energy, CompressionResistanceActsBelowTheRestVolumeOnly) {
  const double e = 0.045658, nu = 0.43, c = 500;
  const auto plain = st_venant_kirchhoff(lame_moduli(e, nu)),
             walled = st_venant_kirchhoff(lame_moduli(e, nu), c);
  const Mat3 pressed = Vec3(0.4, 1, 1).asDiagonal(), pulled = Vec3(1.4, 1, 1).asDiagonal();
  EXPECT_NEAR(walled->value(pressed) - plain->value(pressed),
              c * e / (1 - 2 * nu) * std::pow(0.6, 3) / 2592, 1e-12);
  EXPECT_EQ(walled->value(pulled), plain->value(pulled));
  EXPECT_THROW((void)st_venant_kirchhoff(lame_moduli(e, nu), -1), InputError);
}

TEST(Energy, ProjectionKeepsThePositivePart) {
  std::mt19937_64 random(3);
  const auto law = neo_hookean(lame_moduli(0.045658, 0.43));
  for (int trial = 0; trial < 50; ++trial) {
    const Mat9 A = law->tangent(random_state(random));
    const Mat9 P = positive_part(A);
    const Eigen::SelfAdjointEigenSolver<Mat9> eigen(P);
    EXPECT_GT(eigen.eigenvalues()[0], -1e-12);
    EXPECT_LT((positive_part(P) - P).norm(), 1e-12 * P.norm());
  }
}

TEST(Energy, RefusesModuliThatNoMaterialHas) {
  EXPECT_THROW((void)lame_moduli(0, 0.3), InputError);
  EXPECT_THROW((void)lame_moduli(-1, 0.3), InputError);
  EXPECT_THROW((void)lame_moduli(1, 0.5), InputError);
  EXPECT_THROW((void)lame_moduli(std::nan(""), 0.3), InputError);
}

}  // namespace
}  // namespace palpate::fem
