// SPDX-License-Identifier: Apache-2.0
#include "haptics/touch_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "haptics/fingerprint.hpp"

namespace palpate::haptics {

namespace {

void check(const TouchableHead& head, const TouchModelOptions& options) {
  const std::size_t n = head.skin.points.size();
  const StiffnessMap& map = head.map;
  const std::size_t m = map.forces.size();
  if (map.size() != n || map.displacement.size() != n * m || map.region.size() != n || m == 0)
    throw InputError(fmt::format(
        "the map has {} rows of {} forces but the skin has {} vertices; build the head again",
        map.size(), m, n));
  for (std::size_t i = 0; i < m; ++i)
    if (!(map.forces[i] > (i ? map.forces[i - 1] : 0)))
      throw InputError(fmt::format("force {} of the map does not ascend", i + 1));
  if (!(head.unit_mm > 0) || !std::isfinite(head.unit_mm))
    throw InputError(fmt::format("the head's unit is {} mm; it must be positive", head.unit_mm));
  if (!(options.tool_radius >= 0) || options.tool_radius > 100)
    throw InputError(fmt::format("a tool radius of {} mm cannot touch a head; give 0.5 to 100 mm",
                                 options.tool_radius));
  if (!options.friction.empty() && options.friction.size() != n)
    throw InputError(
        fmt::format("{} friction factors for {} vertices", options.friction.size(), n));
}

// The tree is in single precision, and its searches count on finding something.
void check_size(const SurfaceMesh& skin) {
  constexpr double kFarthest = 1e5;  // [mm] 100 m; a float still tells 0.01 mm there
  constexpr double kSmallest = 1;    // [mm]
  for (std::size_t v = 0; v < skin.points.size(); ++v)
    if (!(skin.points[v].cwiseAbs().maxCoeff() <= kFarthest))
      throw InputError(fmt::format(
          "vertex {} lies more than 100 m from the head's origin; build the head again with the "
          "right unit",
          v));
  if (!skin.points.empty() && !(bounding_box(skin.points).size().maxCoeff() >= kSmallest))
    throw InputError("the head is smaller than 1 mm; build it again with the right unit");
}

// Rows of the map on the welded points; `known` tells which points have one.
void copy_curves(const TouchableHead& head, TouchModel& model, std::vector<char>& known) {
  const std::size_t m = head.map.forces.size();
  const ContactMesh& mesh = model.mesh;
  model.curves.knots = m;
  model.curves.force = head.map.forces;
  model.curves.travel.assign(mesh.points.size() * m, 0);
  known.assign(mesh.points.size(), 0);
  for (std::size_t v = 0; v < mesh.vertex_of.size(); ++v) {
    const std::int32_t p = mesh.vertex_of[v];
    if (p < 0 || known[p] || !head.map.has_curve(v)) continue;
    const auto row = head.map.curve(v);
    double previous = 0;
    for (std::size_t i = 0; i < m; ++i) {
      if (!(row[i] > previous) || !std::isfinite(row[i]))
        throw InputError(
            fmt::format("travel {} of vertex {} does not ascend; build the head again", i + 1, v));
      previous = row[i];
      model.curves.travel[static_cast<std::size_t>(p) * m + i] = row[i];
    }
    known[p] = 1;
  }
}

// Mean of the neighbours' rows that satisfy `use`; false where there is none.
template <class Use>
bool mean_of_neighbours(const TouchModel& model, const std::vector<double>& rows, std::int32_t p,
                        Use use, std::vector<double>& mean) {
  const ContactMesh& mesh = model.mesh;
  const std::size_t m = model.curves.knots;
  mean.assign(m, 0);
  int count = 0;
  for (std::int32_t i = mesh.ring_begin[p]; i < mesh.ring_begin[p + 1]; ++i)
    for (const std::int32_t q : mesh.triangles[mesh.ring[i]]) {
      if (q == p || !use(q)) continue;
      for (std::size_t k = 0; k < m; ++k) mean[k] += rows[static_cast<std::size_t>(q) * m + k];
      ++count;
    }
  for (double& x : mean) x /= std::max(count, 1);
  return count > 0;
}

std::vector<double> median_row(const TouchModel& model, const std::vector<char>& known) {
  const std::size_t m = model.curves.knots;
  std::vector<double> column;
  std::vector<double> row;
  for (std::size_t k = 0; k < m; ++k) {
    column.clear();
    for (std::size_t p = 0; p < known.size(); ++p)
      if (known[p]) column.push_back(model.curves.travel[p * m + k]);
    std::nth_element(column.begin(),
                     column.begin() + static_cast<std::ptrdiff_t>(column.size() / 2), column.end());
    row.push_back(column[column.size() / 2]);
  }
  return row;
}

// Points without a curve in the order in which rings around the known ones reach them; `ring` of a
// known point is 0, of a point that no ring reaches -1.
std::vector<std::int32_t> rings_outwards(const ContactMesh& mesh, const std::vector<char>& known,
                                         std::vector<std::int32_t>& ring) {
  std::vector<std::int32_t> queue;
  ring.assign(known.size(), -1);
  for (std::size_t p = 0; p < known.size(); ++p)
    if (known[p]) {
      ring[p] = 0;
      queue.push_back(static_cast<std::int32_t>(p));
    }
  const std::size_t seeds = queue.size();
  for (std::size_t head = 0; head < queue.size(); ++head) {
    const std::int32_t p = queue[head];
    for (std::int32_t i = mesh.ring_begin[p]; i < mesh.ring_begin[p + 1]; ++i)
      for (const std::int32_t q : mesh.triangles[mesh.ring[i]]) {
        if (ring[q] >= 0) continue;
        ring[q] = ring[p] + 1;
        queue.push_back(q);
      }
  }
  queue.erase(queue.begin(), queue.begin() + static_cast<std::ptrdiff_t>(seeds));
  return queue;
}

void put_row(TouchModel& model, std::int32_t p, const double* row) {
  const std::size_t m = model.curves.knots;
  std::copy_n(row, m,
              model.curves.travel.begin() +
                  static_cast<std::ptrdiff_t>(p) * static_cast<std::ptrdiff_t>(m));
}

// Jacobi sweeps over the carried-over points take the steps between the rings out. Means of
// ascending rows ascend.
void smooth(TouchModel& model, const std::vector<std::int32_t>& points) {
  constexpr int kSweeps = 20;  // [-] more changes travels by less than a few percent
  const std::size_t m = model.curves.knots;
  std::vector<double> rows;
  std::vector<double> mean;
  const auto use = [](std::int32_t) { return true; };
  for (int sweep = 0; sweep < kSweeps; ++sweep) {
    rows.clear();
    for (const std::int32_t p : points) {
      mean_of_neighbours(model, model.curves.travel, p, use, mean);
      rows.insert(rows.end(), mean.begin(), mean.end());
    }
    for (std::size_t i = 0; i < points.size(); ++i) put_row(model, points[i], rows.data() + i * m);
  }
}

void carry_over(TouchModel& model, const std::vector<char>& known) {
  std::vector<std::int32_t> ring;
  const std::vector<std::int32_t> open = rings_outwards(model.mesh, known, ring);
  std::vector<double> mean;
  for (const std::int32_t p : open) {
    const auto use = [&](std::int32_t q) { return ring[q] < ring[p]; };
    mean_of_neighbours(model, model.curves.travel, p, use, mean);
    put_row(model, p, mean.data());
  }
  smooth(model, open);
  const std::vector<double> median = median_row(model, known);
  for (std::size_t p = 0; p < ring.size(); ++p)  // a piece without any curve
    if (ring[p] < 0) put_row(model, static_cast<std::int32_t>(p), median.data());
}

void collect_warnings(TouchModel& model) {
  if (model.tool_radius != model.map_radius)
    model.warnings.push_back(fmt::format(
        "the tool's radius is {} mm but the map was pressed with {} mm: forces hold for the latter",
        model.tool_radius, model.map_radius));
  if (model.mesh.border_edges > 0)
    model.warnings.push_back(fmt::format(
        "the skin is open ({} border edges): the tool can enter through a hole and feels "
        "nothing from behind",
        model.mesh.border_edges));
  if (model.mesh.flipped > 0)
    model.warnings.push_back(
        fmt::format("{} triangles were turned to face outwards", model.mesh.flipped));
}

std::uint64_t fingerprint_of(const TouchModel& model) {
  Fingerprint f;
  f.add(model.mesh.points);
  f.add(model.mesh.triangles);
  f.add(model.curves.travel);
  f.add(model.curves.force);
  f.add(model.friction);
  f.add(model.tool_radius);
  return f.value();
}

}  // namespace

SkinRegion TouchModel::region_at(const SurfacePoint& p) const {
  Eigen::Index corner = 0;
  p.on.barycentric.maxCoeff(&corner);
  return region[mesh.triangles[p.triangle][static_cast<std::size_t>(corner)]];
}

TouchModel make_touch_model(const TouchableHead& head, const TouchModelOptions& options) {
  check(head, options);
  TouchModel model;
  SurfaceMesh skin = head.skin;
  for (Vec3& p : skin.points) p = head.frame.to_head(head.unit_mm * p);
  check_size(skin);
  model.mesh = make_contact_mesh(skin);
  model.map_radius = head.map.tool_radius;
  model.tool_radius = options.tool_radius > 0 ? options.tool_radius : head.map.tool_radius;
  model.frame = head.frame;
  model.unit_mm = head.unit_mm;

  std::vector<char> known;
  copy_curves(head, model, known);
  if (std::count(known.begin(), known.end(), 1) == 0)
    throw InputError("no vertex of the head has a force curve; build the head again");
  for (const char k : known) model.estimated.push_back(k ? 0 : 1);
  carry_over(model, known);

  for (const std::int32_t v : model.mesh.source_vertex) {
    model.region.push_back(head.map.region[v]);
    if (!options.friction.empty())
      model.friction.push_back(static_cast<float>(std::max(0.0, options.friction[v])));
  }
  collect_warnings(model);
  model.fingerprint = fingerprint_of(model);
  return model;
}

std::array<double, kSkinRegionNames.size()> region_stiffness(const TouchModel& model) {
  constexpr double kForce = 2;  // [N] at which the project states a region's stiffness
  std::array<std::vector<double>, kSkinRegionNames.size()> values;
  const std::size_t m = model.curves.knots;
  for (std::size_t p = 0; p < model.region.size(); ++p) {
    if (model.estimated[p]) continue;
    const double* u = model.curves.travel.data() + p * m;
    const std::vector<double>& f = model.curves.force;
    std::size_t i = 0;
    while (i + 1 < m && f[i] < kForce) ++i;
    const double f0 = i ? f[i - 1] : 0;
    const double u0 = i ? u[i - 1] : 0;
    const double travel = u0 + (kForce - f0) * (u[i] - u0) / (f[i] - f0);
    values[static_cast<std::size_t>(model.region[p])].push_back(kForce / travel);
  }
  std::array<double, kSkinRegionNames.size()> medians{};
  medians.fill(std::numeric_limits<double>::quiet_NaN());
  for (std::size_t r = 0; r < values.size(); ++r) {
    auto& v = values[r];
    if (v.empty()) continue;
    const auto middle = v.begin() + static_cast<std::ptrdiff_t>(v.size() / 2);
    std::nth_element(v.begin(), middle, v.end());
    medians[r] = *middle;
  }
  return medians;
}

}  // namespace palpate::haptics
