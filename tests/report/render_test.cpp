// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/render.hpp"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <numeric>

#include "core/error.hpp"
#include "report/png.hpp"
#include "scenes.hpp"

namespace palpate::report {
namespace {

/// Covered area of the image plane [mm^2].
double covered(const Image& image, const Camera& c) {
  double alpha = 0;
  for (std::size_t i = 3; i < image.rgba.size(); i += 4) alpha += image.rgba[i] / 255.0;
  const Eigen::Vector2d size = c.high - c.low;
  return alpha * size.x() * size.y() / (static_cast<double>(c.width) * c.height);
}

Camera window(double half, double distance) {
  Camera c;
  c.distance = distance;
  c.low = {-half, -half};
  c.high = {half, half};
  c.width = c.height = 300;
  return c;
}

TEST(Renderer, SilhouetteOfASphereHasTheClosedFormArea) {
  constexpr double kR = 50;
  const Renderer mesh({scenes::sphere(kR, 96)}), nothing({});
  for (const double distance : {0.0, 150.0}) {
    // Parallel rays: pi r^2. From a point at distance d the tangent cone cuts the plane through the
    // centre in a circle of radius r d / sqrt(d^2 - r^2).
    const double r = distance > 0 ? kR * distance / std::sqrt(distance * distance - kR * kR) : kR;
    const double area = std::numbers::pi * r * r;
    const Camera c = window(70, distance);
    EXPECT_NEAR(covered(mesh.picture(c, {Look{}}), c) / area, 1, 0.01) << distance;
    EXPECT_NEAR(covered(nothing.picture(c, {}, {{Vec3::Zero(), kR, {1, 0, 0}}}), c) / area, 1, 0.01)
        << distance;
  }
}

TEST(Renderer, AreaDoesNotDependOnTheDirection) {
  const SurfaceMesh ball = scenes::sphere(40, 96, {3, -200, 70});
  const Renderer renderer({ball});
  for (const Vec3& eye : {Vec3(0, 0, 1), Vec3(1, 0.1, 0), Vec3(-0.5, 0.3, -0.7)}) {
    const Camera c = frame_points(ball.points, eye, Vec3::UnitY(), 0, 300);
    EXPECT_NEAR(covered(renderer.picture(c, {Look{}}), c) / (std::numbers::pi * 1600), 1, 0.01);
  }
}

TEST(Renderer, ProjectFindsThePixelOfAPoint) {
  const Renderer nothing({});
  const Camera c =
      frame_points(scenes::sphere(80, 8).points, Vec3(0.6, 0.1, 0.7), Vec3::UnitY(), 5, 400);
  const Vec3 p(20, -35, 41);
  const Image image = nothing.picture(c, {}, {{p, 2.5, {1, 1, 1}}});
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double a = image.rgba[(static_cast<std::size_t>(y) * image.width + x) * 4 + 3];
      sum += a * Eigen::Vector3d(x + 0.5, y + 0.5, 1);
    }
  ASSERT_GT(sum.z(), 0);
  EXPECT_NEAR(sum.x() / sum.z(), c.project(p).x(), 0.3);
  EXPECT_NEAR(sum.y() / sum.z(), c.project(p).y(), 0.3);
}

TEST(Renderer, SameBitsForAnyNumberOfThreads) {
  const auto shoot = [] {
    const SurfaceMesh ball = scenes::sphere(40, 30);
    Look glass;
    glass.opacity = 0.3;
    return Renderer({ball, scenes::sphere(25, 20)}).picture(window(50, 200), {glass, Look{}}).rgba;
  };
  std::vector<std::uint8_t> one, two;
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
    one = shoot();
  }
  {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 2);
    two = shoot();
  }
  EXPECT_EQ(one, two);
}

TEST(Renderer, WindingDoesNotMatter) {
  SurfaceMesh ball = scenes::sphere(40, 20);
  const Camera c = window(50, 0);
  const Image a = Renderer({ball}).picture(c, {Look{}});
  for (Triangle& t : ball.triangles) std::swap(t[1], t[2]);
  EXPECT_EQ(a.rgba, Renderer({ball}).picture(c, {Look{}}).rgba);
}

TEST(Renderer, WhatIsBehindGlassShowsThroughAndWhatIsBehindPlasterDoesNot) {
  const Renderer renderer({scenes::sphere(40, 30), scenes::sphere(20, 20)});
  const Camera c = window(50, 0);
  Look shell, core;
  shell.base = {1, 1, 1};
  core.base = {1, 0, 0};
  const std::size_t middle = (150UL * 300 + 150) * 4;
  const Image solid = renderer.picture(c, {shell, core});
  EXPECT_NEAR(solid.rgba[middle], solid.rgba[middle + 1], 2);  // white
  shell.opacity = 0.2;
  const Image glass = renderer.picture(c, {shell, core});
  EXPECT_GT(glass.rgba[middle], glass.rgba[middle + 1] + 40);  // reddish
  EXPECT_EQ(glass.rgba[middle + 3], 255);
  core.visible = false;
  EXPECT_LT(renderer.picture(c, {shell, core}).rgba[middle + 3], 128);
}

TEST(Renderer, NearestPaintingMixesNoCategories) {
  const SurfaceMesh ball = scenes::sphere(40, 12);
  Look look;
  look.relief = 0;
  look.nearest = true;
  for (std::size_t i = 0; i < ball.points.size(); ++i)
    look.colors.push_back(i % 2 ? Rgb{1, 0, 0} : Rgb{0, 0, 1});
  const Image image = Renderer({ball}).picture(window(20, 0), {look});
  std::size_t pure = 0, all = 0;
  for (std::size_t i = 0; i < image.rgba.size(); i += 4, ++all)
    pure += (image.rgba[i] == 255) != (image.rgba[i + 2] == 255);
  EXPECT_GT(static_cast<double>(pure) / static_cast<double>(all), 0.9);  // but for edges
}

TEST(Renderer, RefusesWhatDoesNotFit) {
  SurfaceMesh broken = scenes::sphere(1, 4);
  broken.triangles[3][1] = 4000;
  EXPECT_THROW(Renderer({broken}), InputError);
  const Renderer renderer({scenes::sphere(1, 4)});
  EXPECT_THROW((void)renderer.picture(Camera{}, {}), InputError);
  Look look;
  look.colors.resize(3);
  EXPECT_THROW((void)renderer.picture(Camera{}, {look}), InputError);
}

TEST(Renderer, EmptyMeshesAreNothing) {
  const Renderer renderer({SurfaceMesh{}});
  const Image image = renderer.picture(window(10, 0), {Look{}});
  EXPECT_EQ(std::accumulate(image.rgba.begin(), image.rgba.end(), 0), 0);
}

TEST(Base64, Rfc4648) {
  EXPECT_EQ(base64(""), "");
  EXPECT_EQ(base64("f"), "Zg==");
  EXPECT_EQ(base64("fo"), "Zm8=");
  EXPECT_EQ(base64("foo"), "Zm9v");
  EXPECT_EQ(base64("foobar"), "Zm9vYmFy");
  EXPECT_EQ(base64("\xff\xfe"), "//4=");
}

TEST(Png, IsAPngOfThatSize) {
  const Image image{3, 2, std::vector<std::uint8_t>(24, 77)};
  const std::string png = encode_png(image);
  EXPECT_EQ(png.substr(0, 8), "\x89PNG\r\n\x1a\n");
  EXPECT_EQ(png[19], 3);
  EXPECT_EQ(png[23], 2);
  EXPECT_EQ(png, encode_png(image));
  EXPECT_THROW((void)encode_png(Image{}), InputError);
}

}  // namespace
}  // namespace palpate::report
