// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/pictures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "plot/svg_writer.hpp"
#include "report/figures_of_map.hpp"
#include "report/png.hpp"

namespace palpate::report {
namespace {

constexpr double kPerspective = 5;   // [-] eye distance in half diagonals: a mild one, like 85 mm
constexpr double kMapRelief = 0.55;  // [-] shading of heat maps: shape is seen, colours still read
constexpr double kSkinOpacity = 0.24;                      // [-] of the skin before the skull
constexpr double kBead = 1.3;                              // [mm] radius of a solved point's bead
constexpr std::size_t kMostBeads = 4000;                   // more of them would hide the map
constexpr std::array<std::size_t, 3> kMeshes = {0, 1, 2};  // skin, skull, beads
constexpr Rgb kSkinTone{0.87, 0.80, 0.74}, kBoneTone{0.93, 0.89, 0.79};

Vec3 eye_direction(View view) {
  switch (view) {
    case View::front:
      return Vec3(0, 0.04, 1).normalized();
    case View::three_quarter:
      return Vec3(0.66, 0.12, 0.75).normalized();
    case View::left:
      return Vec3(1, 0.04, 0).normalized();
  }
  return Vec3::UnitZ();
}

SurfaceMesh skin_in_head_frame(const TouchableHead& head) {
  SurfaceMesh m = head.skin;
  for (Vec3& p : m.points) p = head.frame.to_head(head.unit_mm * p);
  return m;
}
SurfaceMesh skull_in_head_frame(const TouchableHead& head) {
  SurfaceMesh m = head.skull;
  for (Vec3& p : m.points) p = head.frame.to_head(p);
  return m;
}

/// One octahedron, split once, for every solved point; empty where there are too many of them.
SurfaceMesh beads(const StiffnessMap& map, const std::vector<Vec3>& skin) {
  SurfaceMesh unit;
  unit.points = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  for (const int x : {0, 1})
    for (const int y : {2, 3})
      for (const int z : {4, 5}) {
        const bool even = (x + y + z) % 2 == 0;
        Triangle t = {x, y, z};
        if (!even) std::swap(t[1], t[2]);
        const auto base = static_cast<std::int32_t>(unit.points.size());
        for (int i = 0; i < 3; ++i)
          unit.points.push_back((unit.points[t[i]] + unit.points[t[(i + 1) % 3]]).normalized());
        unit.triangles.insert(unit.triangles.end(), {{t[0], base, base + 2},
                                                     {base, t[1], base + 1},
                                                     {base + 2, base + 1, t[2]},
                                                     {base, base + 1, base + 2}});
      }
  SurfaceMesh out;
  const auto solved = std::count(map.status.begin(), map.status.end(), VertexStatus::solved);
  if (static_cast<std::size_t>(solved) > kMostBeads) return out;
  for (std::size_t v = 0; v < map.size(); ++v) {
    if (map.status[v] != VertexStatus::solved) continue;
    const auto base = static_cast<std::int32_t>(out.points.size());
    for (const Vec3& p : unit.points) out.points.push_back(skin[v] + kBead * p);
    for (const auto& [a, b, c] : unit.triangles)
      out.triangles.push_back({a + base, b + base, c + base});
  }
  return out;
}

/// Skin that belongs to the head: shoulders and chest of a bust would make the face small.
std::vector<Vec3> near_skull(const std::vector<Vec3>& skin, const std::vector<Vec3>& skull) {
  if (skull.empty()) return skin;
  const Box box = bounding_box(skull);
  const Vec3 below(35, 35, 35), above(35, 40, 45);  // [mm] ears, neck, hair, nose
  std::vector<Vec3> out;
  for (const Vec3& p : skin)
    if (((p - box.low + below).array() >= 0).all() && ((box.high + above - p).array() >= 0).all())
      out.push_back(p);
  return out.empty() ? skin : out;
}

double round_up(double x) {
  const double power = std::pow(10.0, std::floor(std::log10(x)));
  for (const double m : {1.0, 2.0, 5.0})
    if (x <= m * power * (1 + 1e-9)) return m * power;
  return 10 * power;
}
double round_down(double x) {
  return 1 / round_up(1 / x);  // 1, 2, 5 turns into 1, 5, 2: the same set
}

std::vector<double> all_stiffness(const StiffnessMap& map) {
  std::vector<double> out;
  out.reserve(map.size());
  for (std::size_t v = 0; v < map.size(); ++v) out.push_back(compared_stiffness(map, v));
  return out;
}

std::vector<Rgb> heat(const std::vector<double>& values, const ColorRange& range) {
  std::vector<Rgb> out;
  out.reserve(values.size());
  for (const double v : values) out.push_back(plot::sequential_color(range.part(v)));
  return out;
}

}  // namespace

double ColorRange::part(double v) const {
  if (!std::isfinite(v)) return NAN;
  if (logarithmic) return v > 0 ? std::log(v / low) / std::log(high / low) : 0;
  return (v - low) / (high - low);
}

ColorRange depth_range(const StiffnessMap& map) {
  const double high = quantile(map.depth, 0.98);
  return {0, high > 0 ? 5 * std::ceil(high / 5) : 30, false};
}

ColorRange stiffness_range(const StiffnessMap& map) {
  const auto values = all_stiffness(map);
  const double low = quantile(values, 0.02), high = quantile(values, 0.98);
  if (!(low > 0)) return {0.1, 10, true};
  ColorRange range{round_down(low), round_up(high), true};
  if (range.high <= range.low) range.high = 10 * range.low;
  return range;
}

Rgb region_color(SkinRegion region) {
  for (std::size_t i = 0; i < kPublishedOrder.size(); ++i)
    if (kPublishedOrder[i] == region) return plot::category_color(i);
  switch (region) {  // quiet tints: not compared
    case SkinRegion::eye:
      return {0.91, 0.89, 0.83};
    case SkinRegion::nose:
      return {0.81, 0.78, 0.72};
    case SkinRegion::lips:
      return {0.73, 0.67, 0.61};
    case SkinRegion::ear:
      return {0.65, 0.60, 0.55};
    case SkinRegion::neck:
      return {0.86, 0.83, 0.79};
    default:
      return {0.77, 0.75, 0.72};
  }
}

Rgb status_color(VertexStatus status) {
  switch (status) {
    case VertexStatus::solved:
      return {0.08, 0.27, 0.50};
    case VertexStatus::blended:
      return {0.47, 0.69, 0.87};
    case VertexStatus::no_bone:
      return plot::missing_color();
    case VertexStatus::held:
      return {0.88, 0.78, 0.50};
    case VertexStatus::failed:
      return {0.84, 0.20, 0.18};
    case VertexStatus::inverted:
      return {0.58, 0.20, 0.52};
    case VertexStatus::unsettled:
      return {0.93, 0.58, 0.20};
  }
  return plot::missing_color();
}

Rgb mark_color(bool marked) {
  return marked ? Rgb{0.93, 0.58, 0.20} : Rgb{0.47, 0.69, 0.87};
}

static std::vector<SurfaceMesh> meshes_of(const TouchableHead& head) {
  SurfaceMesh skin = skin_in_head_frame(head);
  SurfaceMesh dots = beads(head.map, skin.points);
  return {std::move(skin), skull_in_head_frame(head), std::move(dots)};
}

/// The three views at one scale and height, so that pictures side by side can be compared.
static std::array<Camera, 3> cameras(const std::vector<Vec3>& points, int width) {
  std::array<Camera, 3> out;
  Eigen::Vector2d half = Eigen::Vector2d::Zero();
  double top = -INFINITY, bottom = INFINITY;
  for (const View v : {View::front, View::three_quarter, View::left}) {
    Camera& c = out[static_cast<std::size_t>(v)];
    c = frame_points(points, eye_direction(v), Vec3::UnitY(), kPerspective, width);
    half = half.cwiseMax(0.5 * (c.high - c.low));
    top = std::max(top, c.high.y());
    bottom = std::min(bottom, c.low.y());
  }
  for (Camera& c : out) {
    const double middle = 0.5 * (c.low.x() + c.high.x());
    c.height = std::max(1, static_cast<int>(std::lround(width * 0.5 * (top - bottom) / half.x())));
    c.low = {middle - half.x(), bottom};
    c.high = {middle + half.x(), bottom + 2 * half.x() * c.height / width};
  }
  return out;
}

HeadPictures::HeadPictures(const TouchableHead& head, int width)
    : map_(&head.map), renderer_(meshes_of(head)) {
  const auto skin = skin_in_head_frame(head).points;
  whole_ = cameras(skin, width);
  head_ = cameras(near_skull(skin, skull_in_head_frame(head).points), width);
  for (const auto& [key, mark] : head.landmarks)
    landmarks_[key] = {head.frame.to_head(mark.position), mark.confidence};
}

Image HeadPictures::painted(View view, Look skin) const {
  std::vector<Look> looks(kMeshes.size());
  looks[0] = std::move(skin);
  looks[1].visible = looks[2].visible = false;
  return renderer_.picture(head_[static_cast<std::size_t>(view)], looks);
}

Image HeadPictures::scan(View view) const {
  std::vector<Look> looks(kMeshes.size());
  looks[0].base = kSkinTone;
  looks[1].visible = looks[2].visible = false;
  return renderer_.picture(whole_[static_cast<std::size_t>(view)], looks);
}

Image HeadPictures::skull(View view) const {
  std::vector<Look> looks(kMeshes.size());
  looks[0].base = kSkinTone;
  looks[0].opacity = kSkinOpacity;
  looks[1].base = kBoneTone;
  looks[2].visible = false;
  return renderer_.picture(head_[static_cast<std::size_t>(view)], looks);
}

Image HeadPictures::values(View view, const std::vector<double>& values,
                           const ColorRange& range) const {
  Look look;
  look.colors = heat(values, range);
  look.relief = kMapRelief;
  return painted(view, std::move(look));
}

Image HeadPictures::depth(View view, const ColorRange& range) const {
  return values(view, map_->depth, range);
}

Image HeadPictures::stiffness(View view, const ColorRange& range) const {
  return values(view, all_stiffness(*map_), range);
}

Image HeadPictures::marked(View view, const std::vector<std::uint8_t>& marks) const {
  Look look;
  for (const std::uint8_t m : marks) look.colors.push_back(mark_color(m != 0));
  look.nearest = true;
  look.relief = kMapRelief;
  return painted(view, std::move(look));
}

Image HeadPictures::regions(View view) const {
  Look look;
  for (const SkinRegion r : map_->region) look.colors.push_back(region_color(r));
  look.nearest = true;
  look.relief = kMapRelief;
  return painted(view, std::move(look));
}

Image HeadPictures::status(View view) const {
  std::vector<Look> looks(kMeshes.size());
  for (const VertexStatus s : map_->status)
    looks[0].colors.push_back(status_color(s == VertexStatus::solved ? VertexStatus::blended : s));
  looks[0].nearest = true;
  looks[0].relief = kMapRelief;
  looks[1].visible = false;
  looks[2].base = status_color(VertexStatus::solved);
  return renderer_.picture(head_[static_cast<std::size_t>(view)], looks);
}

namespace {

/// The part of a picture's plane that holds all landmarks, with some face around them.
Camera face_camera(Camera c, const LandmarkSet& landmarks) {
  constexpr double kAround = 42;  // [mm]
  if (landmarks.empty()) return c;
  const Eigen::Vector2d size = c.high - c.low;
  Eigen::Vector2d low = c.high, high = c.low;
  for (const auto& [key, mark] : landmarks) {
    const Eigen::Vector2d pixel = c.project(mark.position);
    const Eigen::Vector2d at(c.low.x() + pixel.x() / c.width * size.x(),
                             c.high.y() - pixel.y() / c.height * size.y());
    low = low.cwiseMin(at);
    high = high.cwiseMax(at);
  }
  c.low = (low.array() - kAround).matrix().cwiseMax(c.low);
  c.high = (high.array() + kAround).matrix().cwiseMin(c.high);
  const double width = c.high.x() - c.low.x();
  if (width <= 0 || c.high.y() <= c.low.y()) return c;
  c.height = std::max(1, static_cast<int>(c.width * (c.high.y() - c.low.y()) / width));
  c.low.y() = c.high.y() - width * c.height / c.width;
  return c;
}

struct Label {
  std::string text;
  plot::PixelPoint at;
  double y;
  bool sure;
};

void spread(std::vector<Label>& labels, double gap, double bottom) {
  std::stable_sort(labels.begin(), labels.end(),
                   [](const Label& a, const Label& b) { return a.at.y < b.at.y; });
  for (std::size_t i = 1; i < labels.size(); ++i)
    labels[i].y = std::max(labels[i].y, labels[i - 1].y + gap);
  double limit = bottom;
  for (std::size_t i = labels.size(); i-- > 0; limit = labels[i].y - gap)
    labels[i].y = std::min(labels[i].y, limit);
}

}  // namespace

std::string HeadPictures::landmarks_svg() const {
  constexpr double kSide = 190, kShown = 470, kGap = 19, kText = 12.5;  // [px] of the SVG
  std::vector<Look> looks(kMeshes.size());
  looks[0].base = kSkinTone;
  looks[1].visible = looks[2].visible = false;
  const Camera c = face_camera(head_[static_cast<std::size_t>(View::front)], landmarks_);
  std::vector<Sphere> spheres;
  for (const auto& [key, mark] : landmarks_)
    spheres.push_back({mark.position, 2.6,
                       mark.confidence >= 0.5 ? Rgb{0.12, 0.45, 0.70} : Rgb{0.85, 0.38, 0.17}});
  const Image image = renderer_.picture(c, looks, spheres);
  const double scale = kShown / image.width, height = image.height * scale;
  plot::SvgWriter out(kShown + 2 * kSide, height, "Landmarks, names are the subject's sides");
  out.image({kSide, 0}, kShown, height, data_url(image));
  std::array<std::vector<Label>, 2> sides;  // left and right in the picture
  for (const auto& [key, mark] : landmarks_) {
    const Eigen::Vector2d p = scale * c.project(mark.position);
    std::string text = fmt::format("{}  {:.2f}", key, mark.confidence);
    std::replace(text.begin(), text.end(), '_', ' ');
    const bool sure = mark.confidence >= 0.5;
    sides[p.x() > 0.5 * kShown].push_back({text, {kSide + p.x(), p.y()}, p.y(), sure});
  }
  for (const int side : {0, 1}) {
    spread(sides[side], kGap, height - 10);
    const double x = side ? kSide + kShown + 8 : kSide - 8;
    for (const Label& l : sides[side]) {
      out.line(l.at, {x + (side ? -4 : 4), l.y}, {"currentColor", 0.8, 0.55, ""});
      out.text({x, l.y + 4}, l.text,
               {.size = kText,
                .anchor = side ? plot::Anchor::start : plot::Anchor::end,
                .fill = l.sure ? "currentColor" : "#d9622b"});
    }
  }
  return std::move(out).finish();
}

}  // namespace palpate::report
