// SPDX-License-Identifier: Apache-2.0
#include "core/stiffness_map.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/error.hpp"

namespace palpate {
namespace {

TEST(StiffnessMap, PiecesMeetAtEverySample) {
  const std::vector<double> f = {0.5, 1, 2, 5};
  const std::vector<double> u = {0.4, 0.7, 1.1, 1.5};
  const auto c = stiffness_coefficients(f, u);
  EXPECT_EQ(c.b[0], 0);
  for (std::size_t i = 0; i < f.size(); ++i) {
    EXPECT_NEAR(c.k[i] * u[i] + c.b[i], f[i], 1e-14);
    if (i > 0) {
      EXPECT_NEAR(c.k[i] * u[i - 1] + c.b[i], f[i - 1], 1e-14);
    }
    EXPECT_NEAR(force_at(c, u, u[i]), f[i], 1e-14);
    EXPECT_NEAR(force_at(c, u, std::nextafter(u[i], 0)), f[i], 1e-12);
  }
  EXPECT_EQ(force_at(c, u, 0), 0);
  EXPECT_EQ(force_at(c, u, -1), 0);
  EXPECT_NEAR(force_at(c, u, 1.9), 5 + 0.4 * c.k[3], 1e-12);  // the last piece goes on
}

TEST(StiffnessMap, RefusesTravelsThatDoNotAscend) {
  const std::vector<double> f = {1, 2};
  EXPECT_THROW((void)stiffness_coefficients(f, std::vector<double>{0.5, 0.5}), InputError);
  EXPECT_THROW((void)stiffness_coefficients(f, std::vector<double>{0.5, std::nan("")}), InputError);
  EXPECT_THROW((void)stiffness_coefficients(f, std::vector<double>{0.5}), InputError);
}

}  // namespace
}  // namespace palpate
