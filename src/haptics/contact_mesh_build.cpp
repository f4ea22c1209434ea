// SPDX-License-Identifier: Apache-2.0
// From a scan's triangles to a mesh that a proxy can walk on. Runs once, off line.
#include <algorithm>
#include <numeric>
#include <tuple>

#include "core/error.hpp"
#include "haptics/contact_mesh.hpp"

namespace palpate::haptics {

namespace {

// Numbers equal positions once; `vertex_of` and `source_vertex` are filled.
void weld(const SurfaceMesh& skin, ContactMesh& mesh) {
  std::vector<std::int32_t> order(skin.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto key = [&](std::int32_t i) {
    const Vec3& p = skin.points[i];
    return std::make_tuple(p.x(), p.y(), p.z(), i);
  };
  std::sort(order.begin(), order.end(),
            [&](std::int32_t a, std::int32_t b) { return key(a) < key(b); });
  std::vector<std::int32_t> first(skin.points.size());  // the lowest number at this position
  for (std::size_t i = 0; i < order.size(); ++i) {
    const bool same = i > 0 && skin.points[order[i]] == skin.points[order[i - 1]];
    first[order[i]] = same ? first[order[i - 1]] : order[i];
  }
  mesh.vertex_of = std::move(first);
}

void keep_triangles_with_area(const SurfaceMesh& skin, ContactMesh& mesh) {
  for (std::size_t i = 0; i < skin.triangles.size(); ++i) {
    Triangle t = skin.triangles[i];
    for (std::int32_t& v : t) v = mesh.vertex_of[v];
    const Vec3& a = skin.points[t[0]];
    const Vec3 ab = skin.points[t[1]] - a;
    const Vec3 ac = skin.points[t[2]] - a;
    // [-] Twice the area over the squared longest side; below this the normal is rounding.
    constexpr double kThinnest = 1e-10;
    const double longest2 = std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
    if (!(ab.cross(ac).norm() > kThinnest * longest2)) {
      ++mesh.degenerate;
      continue;
    }
    mesh.triangles.push_back(t);
    mesh.source_triangle.push_back(static_cast<std::int32_t>(i));
  }
}

// Pairs the two triangles of each edge; a third one on the same edge stays without neighbour.
void find_neighbours(std::size_t point_count, ContactMesh& mesh) {
  struct Side {
    std::int32_t high, triangle, edge;
  };
  // Sides by their lower vertex: a counting sort, then short sorts within each vertex.
  std::vector<std::size_t> begin(point_count + 1, 0);
  const auto low_of = [&](const Triangle& t, int k) { return std::min(t[k], t[(k + 1) % 3]); };
  for (const Triangle& t : mesh.triangles)
    for (int k = 0; k < 3; ++k) ++begin[low_of(t, k) + 1];
  std::partial_sum(begin.begin(), begin.end(), begin.begin());
  std::vector<Side> sides(3 * mesh.triangles.size());
  std::vector<std::size_t> next(begin.begin(), begin.end() - 1);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const Triangle& t = mesh.triangles[i];
      sides[next[low_of(t, k)]++] = {std::max(t[k], t[(k + 1) % 3]), static_cast<std::int32_t>(i),
                                     k};
    }
  mesh.neighbours.assign(mesh.triangles.size(), Triangle{-1, -1, -1});
  for (std::size_t v = 0; v < point_count; ++v) {
    const auto from = sides.begin() + static_cast<std::ptrdiff_t>(begin[v]);
    const auto to = sides.begin() + static_cast<std::ptrdiff_t>(begin[v + 1]);
    std::sort(from, to, [](const Side& a, const Side& b) {
      return std::tie(a.high, a.triangle) < std::tie(b.high, b.triangle);
    });
    for (auto a = from; a != to && a + 1 != to; ++a) {
      const auto b = a + 1;
      if (a->high != b->high || a->triangle == b->triangle) continue;
      mesh.neighbours[a->triangle][a->edge] = b->triangle;
      mesh.neighbours[b->triangle][b->edge] = a->triangle;
      ++a;
      if (a + 1 == to) break;
    }
  }
}

bool runs_along(const Triangle& t, std::int32_t from, std::int32_t to) {
  for (int k = 0; k < 3; ++k)
    if (t[k] == from && t[(k + 1) % 3] == to) return true;
  return false;
}

// Corners 1 and 2 change places, so edges 0 and 2 do.
void turn_round(ContactMesh& mesh, std::int32_t t) {
  std::swap(mesh.triangles[t][1], mesh.triangles[t][2]);
  std::swap(mesh.neighbours[t][0], mesh.neighbours[t][2]);
  ++mesh.flipped;
}

// Spreads the direction of the first triangle over each connected piece, then turns the piece so
// that it faces away from the middle of the head.
void orient(const SurfaceMesh& skin, ContactMesh& mesh) {
  const Vec3 center = bounding_box(skin.points).center();
  std::vector<char> seen(mesh.triangles.size(), 0);
  std::vector<std::int32_t> piece;
  for (std::size_t seed = 0; seed < mesh.triangles.size(); ++seed) {
    if (seen[seed]) continue;
    piece.assign(1, static_cast<std::int32_t>(seed));
    seen[seed] = 1;
    double outward = 0;
    for (std::size_t head = 0; head < piece.size(); ++head) {
      const std::int32_t t = piece[head];
      const Triangle corners = mesh.triangles[t];
      const Vec3 a = skin.points[corners[0]] - center;
      const Vec3 b = skin.points[corners[1]] - center;
      const Vec3 c = skin.points[corners[2]] - center;
      outward += a.dot(b.cross(c));
      for (int k = 0; k < 3; ++k) {
        const std::int32_t other = mesh.neighbours[t][k];
        if (other < 0 || seen[other]) continue;
        seen[other] = 1;
        if (runs_along(mesh.triangles[other], corners[k], corners[(k + 1) % 3]))
          turn_round(mesh, other);
        piece.push_back(other);
      }
    }
    if (outward < 0)
      for (const std::int32_t t : piece) turn_round(mesh, t);
  }
}

std::vector<char> touching_border(std::size_t point_count, const ContactMesh& mesh) {
  std::vector<char> on_border(point_count, 0);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (int k = 0; k < 3; ++k)
      if (mesh.neighbours[t][k] < 0)
        on_border[mesh.triangles[t][k]] = on_border[mesh.triangles[t][(k + 1) % 3]] = 1;
  std::vector<char> touching;
  for (const Triangle& t : mesh.triangles)
    touching.push_back(on_border[t[0]] || on_border[t[1]] || on_border[t[2]] ? 1 : 0);
  return touching;
}

void put_in_order(ContactMesh& mesh, const std::vector<std::int32_t>& order) {
  std::vector<std::int32_t> place(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) place[order[i]] = static_cast<std::int32_t>(i);
  std::vector<Triangle> triangles(order.size());
  std::vector<Triangle> neighbours(order.size());
  std::vector<std::int32_t> source(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) {
    triangles[i] = mesh.triangles[order[i]];
    source[i] = mesh.source_triangle[order[i]];
    for (int k = 0; k < 3; ++k) {
      const std::int32_t other = mesh.neighbours[order[i]][k];
      neighbours[i][k] = other < 0 ? -1 : place[other];
    }
  }
  mesh.triangles = std::move(triangles);
  mesh.neighbours = std::move(neighbours);
  mesh.source_triangle = std::move(source);
}

// Points get the order in which the triangles meet them, which keeps a contact in few cache lines.
void renumber_points(const SurfaceMesh& skin, ContactMesh& mesh) {
  std::vector<std::int32_t> number(skin.points.size(), -1);
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& v : t) {
      if (number[v] < 0) {
        number[v] = static_cast<std::int32_t>(mesh.points.size());
        mesh.points.push_back(skin.points[v]);
        mesh.source_vertex.push_back(v);
      }
      v = number[v];
    }
  for (std::int32_t& v : mesh.vertex_of) v = number[v];
}

void find_rings(ContactMesh& mesh) {
  mesh.ring_begin.assign(mesh.points.size() + 1, 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t v : t) ++mesh.ring_begin[v + 1];
  std::partial_sum(mesh.ring_begin.begin(), mesh.ring_begin.end(), mesh.ring_begin.begin());
  mesh.ring.resize(3 * mesh.triangles.size());
  std::vector<std::int32_t> next(mesh.ring_begin.begin(), mesh.ring_begin.end() - 1);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    for (const std::int32_t v : mesh.triangles[t])
      mesh.ring[next[v]++] = static_cast<std::int32_t>(t);
}

}  // namespace

ContactMesh make_contact_mesh(const SurfaceMesh& skin) {
  if (const auto defect = first_defect(skin))
    throw InputError("the skin cannot be touched: " + *defect + "; repair the scan");
  ContactMesh mesh;
  weld(skin, mesh);
  keep_triangles_with_area(skin, mesh);
  if (mesh.triangles.empty())
    throw InputError("the skin cannot be touched: no triangle has an area; repair the scan");
  find_neighbours(skin.points.size(), mesh);
  orient(skin, mesh);

  auto [tree, order] =
      BoxTree::build({skin.points, mesh.triangles}, touching_border(skin.points.size(), mesh));
  mesh.tree = std::move(tree);
  put_in_order(mesh, order);
  renumber_points(skin, mesh);
  for (const Triangle& t : mesh.neighbours)
    mesh.border_edges += static_cast<std::size_t>(std::count(t.begin(), t.end(), -1));
  find_rings(mesh);
  mesh.normals = vertex_normals({mesh.points, mesh.triangles});
  return mesh;
}

}  // namespace palpate::haptics
