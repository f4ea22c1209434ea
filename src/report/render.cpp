// SPDX-License-Identifier: GPL-3.0-or-later
// Light: a key lamp from above the eye's left, a weak fill from the right, and the sky, dimmed
// where the surface is hollow (ambient occlusion, computed once per point). Colours are mixed in
// linear light. Embree finds the hits in single precision, centred on the mesh: 1e-5 mm on a head.
#include "report/render.hpp"

#include <tbb/parallel_for.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"
#include "report/ray_mesh.hpp"

namespace palpate::report {
namespace {

using Color = Eigen::Vector3d;  // linear light

constexpr int kGrid = 2;          // samples along each side of a pixel
constexpr double kMargin = 0.03;  // [-] of the picture around the points
constexpr int kLayers = 2;        // sheets of a translucent surface that count: an ear over a cheek
constexpr double kRimDensity = 0.75;  // [-] how solid a grazing translucent sheet looks

double decode(double s) {
  return s <= 0.04045 ? s / 12.92 : std::pow((s + 0.055) / 1.055, 2.4);
}
double encode(double x) {
  return x <= 0.0031308 ? 12.92 * x : 1.055 * std::pow(x, 1 / 2.4) - 0.055;
}
Color linear(const Rgb& c) {
  return {decode(c.r), decode(c.g), decode(c.b)};
}

/// One surface along a ray, painted.
struct Layer {
  double distance;
  Color color;
  double opacity;
};

struct Lamps {
  Vec3 key, fill, sky, eye;
  explicit Lamps(const Camera& c)
      : key((c.to_eye + 0.9 * c.up - 0.7 * c.right).normalized()),
        fill((0.8 * c.to_eye + 0.1 * c.up + 1.0 * c.right).normalized()),
        sky(c.up),
        eye(c.to_eye) {}
};

/// @param normal   towards the eye's side
/// @param ambient  [0, 1] share of the sky that is seen
Color shade(const Color& paint, const Vec3& normal, double ambient, const Lamps& lamps,
            double relief) {
  const double sky = 0.5 + 0.5 * normal.dot(lamps.sky);
  const double light = (0.30 + 0.16 * sky) * ambient +
                       (0.35 + 0.65 * ambient) * (0.62 * std::max(0.0, normal.dot(lamps.key)) +
                                                  0.16 * std::max(0.0, normal.dot(lamps.fill)));
  const Vec3 half = (lamps.key + lamps.eye).normalized();
  const double g2 = std::pow(std::max(0.0, normal.dot(half)), 2), g8 = g2 * g2 * g2 * g2;
  const double gloss = 0.05 * relief * g8 * g8 * g8;
  return paint * (1 + relief * (light - 1)) + Color::Constant(gloss);
}

Color painted(const RayMesh& mesh, const std::vector<Color>& colors, bool nearest,
              const MeshHit& hit) {
  if (colors.size() == 1) return colors[0];
  const Triangle& t = mesh.surface().triangles[hit.triangle];
  if (nearest) {
    int best = 0;
    hit.barycentric.maxCoeff(&best);
    return colors[t[best]];
  }
  Color sum = Color::Zero();
  for (int i = 0; i < 3; ++i) sum += hit.barycentric[i] * colors[t[i]];
  return sum;
}

std::optional<Layer> sphere_layer(const Sphere& s, const Color& paint, const Vec3& origin,
                                  const Vec3& direction, const Lamps& lamps) {
  const Vec3 from = origin - s.centre;
  const double b = from.dot(direction);
  const double under_root = b * b - from.squaredNorm() + s.radius * s.radius;
  if (under_root < 0) return std::nullopt;
  const double distance = -b - std::sqrt(under_root);
  if (distance <= 0) return std::nullopt;
  const Vec3 normal = (from + distance * direction) / s.radius;
  return Layer{distance, shade(paint, normal, 1, lamps, 0.8), 1};
}

}  // namespace

Eigen::Vector2d Camera::project(const Vec3& p) const {
  const Vec3 q = p - target;
  const double scale = distance > 0 ? distance / (distance - q.dot(to_eye)) : 1;
  const Eigen::Vector2d at = scale * Eigen::Vector2d(q.dot(right), q.dot(up));
  return {(at.x() - low.x()) / (high.x() - low.x()) * width,
          (high.y() - at.y()) / (high.y() - low.y()) * height};
}

Camera frame_points(const std::vector<Vec3>& points, const Vec3& to_eye, const Vec3& world_up,
                    double perspective, int width) {
  const Box box = bounding_box(points);
  Camera c;
  if (points.empty()) return c;
  c.target = box.center();
  c.to_eye = to_eye.normalized();
  c.right = world_up.cross(c.to_eye).normalized();
  c.up = c.to_eye.cross(c.right);
  c.distance = perspective * 0.5 * box.size().norm();
  Eigen::Vector2d low = Eigen::Vector2d::Constant(INFINITY), high = -low;
  for (const Vec3& p : points) {
    const Vec3 q = p - c.target;
    const double scale = c.distance > 0 ? c.distance / (c.distance - q.dot(c.to_eye)) : 1;
    const Eigen::Vector2d at = scale * Eigen::Vector2d(q.dot(c.right), q.dot(c.up));
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  const Eigen::Vector2d margin =
      Eigen::Vector2d::Constant(std::max(1e-6, kMargin * (high - low).maxCoeff()));
  c.low = low - margin;
  c.high = high + margin;
  c.width = width;
  const Eigen::Vector2d size = c.high - c.low;
  c.height = std::clamp(static_cast<int>(std::lround(width * size.y() / size.x())), 1, 4 * width);
  // Pixels stay square: the plane's height follows the rounded number of rows.
  const double centre = 0.5 * (c.low.y() + c.high.y()), half = 0.5 * size.x() * c.height / width;
  c.low.y() = centre - half;
  c.high.y() = centre + half;
  return c;
}

struct Renderer::Stage {
  std::vector<RayMesh> meshes;

  struct Picture {
    const Camera& camera;
    const std::vector<Look>& looks;
    const std::vector<Sphere>& spheres;
    std::vector<std::vector<Color>> colors;  // per mesh: one, or one per point
    std::vector<Color> sphere_colors;
    Lamps lamps;
  };

  void add_layers(const Picture& p, std::size_t m, const Vec3& origin, const Vec3& direction,
                  std::vector<Layer>& layers) const {
    const Look& look = p.looks[m];
    const bool solid = look.opacity >= 1;
    double from = 0;
    for (int found = 0, tries = 0; found < (solid ? 1 : kLayers) && tries < 16; ++tries) {
      const auto hit = meshes[m].cast(origin, direction, from);
      if (!hit) return;
      from = hit->distance;
      Vec3 normal = meshes[m].normal(*hit);
      const bool facing = meshes[m].side(*hit).dot(direction) < 0;
      if (!solid && !facing) continue;
      if (normal.dot(direction) > 0) normal = -normal;
      const Color paint = painted(meshes[m], p.colors[m], look.nearest, *hit);
      const double grazing = std::pow(1 - std::abs(normal.dot(direction)), 2.5);
      const double opacity = solid ? 1 : look.opacity + (1 - look.opacity) * kRimDensity * grazing;
      layers.push_back({hit->distance,
                        shade(paint, normal, meshes[m].ambient(*hit), p.lamps, look.relief),
                        opacity});
      ++found;
    }
  }

  /// Premultiplied colour and coverage along one ray.
  Eigen::Vector4d sample(const Picture& p, const Vec3& origin, const Vec3& direction,
                         std::vector<Layer>& layers) const {
    layers.clear();
    for (std::size_t m = 0; m < meshes.size(); ++m)
      if (p.looks[m].visible) add_layers(p, m, origin, direction, layers);
    for (std::size_t s = 0; s < p.spheres.size(); ++s)
      if (const auto layer =
              sphere_layer(p.spheres[s], p.sphere_colors[s], origin, direction, p.lamps))
        layers.push_back(*layer);
    std::stable_sort(layers.begin(), layers.end(),
                     [](const Layer& a, const Layer& b) { return a.distance < b.distance; });
    Eigen::Vector4d sum = Eigen::Vector4d::Zero();
    for (const Layer& layer : layers) {
      const double share = (1 - sum.w()) * layer.opacity;
      sum.head<3>() += share * layer.color;
      sum.w() += share;
    }
    return sum;
  }
};

Renderer::Renderer(std::vector<SurfaceMesh> meshes) : stage_(std::make_unique<Stage>()) {
  for (SurfaceMesh& m : meshes) stage_->meshes.emplace_back(std::move(m));
}
Renderer::~Renderer() = default;
Renderer::Renderer(Renderer&&) noexcept = default;
Renderer& Renderer::operator=(Renderer&&) noexcept = default;

/// Ray through a spot of the picture, given in pixels from the upper left.
static std::pair<Vec3, Vec3> ray(const Camera& c, double px, double py, double far) {
  const double x = c.low.x() + px / c.width * (c.high.x() - c.low.x());
  const double y = c.high.y() - py / c.height * (c.high.y() - c.low.y());
  const Vec3 on_plane = c.target + x * c.right + y * c.up;
  if (c.distance <= 0) return {on_plane + far * c.to_eye, -c.to_eye};
  const Vec3 eye = c.target + c.distance * c.to_eye;
  return {eye, (on_plane - eye).normalized()};
}

Image Renderer::picture(const Camera& camera, const std::vector<Look>& looks,
                        const std::vector<Sphere>& spheres) const {
  if (looks.size() != stage_->meshes.size()) throw InputError("a picture needs one look per mesh");
  Stage::Picture p{camera, looks, spheres, {}, {}, Lamps(camera)};
  double far = 1;  // [mm] start of parallel rays, beyond everything
  for (std::size_t m = 0; m < looks.size(); ++m) {
    const SurfaceMesh& mesh = stage_->meshes[m].surface();
    if (!looks[m].colors.empty() && looks[m].colors.size() != mesh.points.size())
      throw InputError("a picture needs one colour per point");
    auto& colors = p.colors.emplace_back();
    if (looks[m].colors.empty()) colors.push_back(linear(looks[m].base));
    for (const Rgb& c : looks[m].colors) colors.push_back(linear(c));
    const Box box = bounding_box(mesh.points);
    if (!mesh.points.empty())
      far = std::max(far, (box.center() - camera.target).norm() + box.size().norm());
  }
  for (const Sphere& s : spheres) {
    p.sphere_colors.push_back(linear(s.color));
    far = std::max(far, (s.centre - camera.target).norm() + 2 * s.radius);
  }
  Image image{camera.width, camera.height, {}};
  image.rgba.assign(static_cast<std::size_t>(camera.width) * camera.height * 4, 0);
  tbb::parallel_for(0, camera.height, [&](int row) {
    std::vector<Layer> layers;
    for (int column = 0; column < camera.width; ++column) {
      Eigen::Vector4d sum = Eigen::Vector4d::Zero();
      for (int k = 0; k < kGrid * kGrid; ++k) {
        const auto [origin, direction] =
            ray(camera, column + (k % kGrid + 0.5) / kGrid, row + (k / kGrid + 0.5) / kGrid, far);
        sum += stage_->sample(p, origin, direction, layers) / (kGrid * kGrid);
      }
      if (sum.w() <= 0) continue;
      const std::size_t at = (static_cast<std::size_t>(row) * camera.width + column) * 4;
      const auto byte = [](double x) {
        return static_cast<std::uint8_t>(std::lround(255 * std::clamp(x, 0.0, 1.0)));
      };
      for (int i = 0; i < 3; ++i) image.rgba[at + i] = byte(encode(sum[i] / sum.w()));
      image.rgba[at + 3] = byte(sum.w());
    }
  });
  return image;
}

}  // namespace palpate::report
