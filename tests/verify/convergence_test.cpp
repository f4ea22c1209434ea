// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <cmath>

#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using fem::ElementOrder;

TEST(Convergence, LinearElementsAreOfSecondOrder) {
  const double order = std::log2(displacement_error(ElementOrder::linear, 8) /
                                 displacement_error(ElementOrder::linear, 16));
  std::printf("order %.3f\n", order);
  EXPECT_GE(order, 1.9);
}

TEST(Convergence, QuadraticElementsAreOfThirdOrder) {
  const double order = std::log2(displacement_error(ElementOrder::quadratic, 4) /
                                 displacement_error(ElementOrder::quadratic, 8));
  std::printf("order %.3f\n", order);
  EXPECT_GE(order, 2.8);
}

}  // namespace
}  // namespace palpate::verify
