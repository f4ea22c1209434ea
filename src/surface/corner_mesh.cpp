// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface/corner_mesh.hpp"

#include <algorithm>

#include "surface/edge_groups.hpp"

namespace palpate::surface {

using Id = CornerMesh::Id;

Id CornerMesh::find(Id a, Id b) const {
  Id found = kNone;
  around(a, [&](Id h) {
    if (to(h) == b) found = h;
  });
  return found;
}

int CornerMesh::valence(Id v) const {
  int n = 0;
  around(v, [&](Id) { ++n; });
  return n;
}

Id CornerMesh::add_point(const Vec3& p) {
  points.push_back(p);
  out.push_back(kNone);
  return static_cast<Id>(points.size()) - 1;
}

Id CornerMesh::add_face(Id a, Id b, Id c, std::uint8_t in_patch) {
  const Id first = half_edges();
  corner.insert(corner.end(), {a, b, c});
  twin.insert(twin.end(), 3, kNone);
  patch.push_back(in_patch);
  return first;
}

// The face (a, b, c) of h = a->b becomes (a, m, c), and (m, b, c) is new; the same across the edge.
Id CornerMesh::split(Id h, const Vec3& p) {
  const Id g = twin[h], a = from(h), b = to(h), m = add_point(p);
  const auto halve = [&](Id e) {  // e: s->t with apex r, becomes s->m; the new face is m->t->r
    const Id t = to(e), r = apex(e), e1 = next(e), across = twin[e1];
    const Id f = add_face(m, t, r, patch[e / 3]);
    corner[e1] = m;
    twin[f + 1] = across;
    if (across != kNone) twin[across] = f + 1;
    pair(e1, f + 2);
    return f;
  };
  const Id b_to_c = next(h);
  const Id f = halve(h);  // f: m->b, f + 1: b->c
  if (out[b] == b_to_c) out[b] = f + 1;
  if (g != kNone) {
    const Id a_to_d = next(g);
    const Id k = halve(g);  // g: b->m, k: m->a, k + 1: a->d
    if (out[a] == a_to_d) out[a] = k + 1;
    pair(h, k);
    pair(f, g);
  }
  out[m] = f;  // on a border, the first of m's fan
  return m;
}

bool CornerMesh::can_flip(Id h) const {
  const Id g = twin[h];
  if (g == kNone) return false;
  const Id c = apex(h), d = apex(g);
  return c != d && !joined(c, d);
}

// Faces (a, b, c) of h and (b, a, d) of g become (d, c, a) and (c, d, b): h is d->c, g is c->d.
void CornerMesh::flip(Id h) {
  const Id g = twin[h];
  const Id h1 = next(h), h2 = prev(h), g1 = next(g), g2 = prev(g);
  const Id a = corner[h], b = corner[g], c = corner[h2], d = corner[g2];
  const Id bc = twin[h1], ca = twin[h2], ad = twin[g1], db = twin[g2];
  const auto join = [&](Id e, Id f) {
    twin[e] = f;
    if (f != kNone) twin[f] = e;
  };
  corner[h] = d, corner[h1] = c, corner[h2] = a;
  corner[g] = c, corner[g1] = d, corner[g2] = b;
  join(h1, ca);
  join(h2, ad);
  join(g1, db);
  join(g2, bc);
  // On a border `out` must stay first of the fan, so only half-edges that moved are replaced.
  const auto moved = [&](Id v, Id old_side, Id now) {
    if (out[v] == old_side) out[v] = now;
  };
  if (out[a] == h || out[a] == g1) out[a] = h2;
  if (out[b] == g || out[b] == h1) out[b] = g2;
  moved(c, h2, h1);
  moved(d, g2, g1);
}

// Link condition: the two ends have exactly the two apices as common neighbours, and the result has
// more than a tetrahedron's worth of faces at each apex.
bool CornerMesh::can_collapse(Id h) const {
  const Id g = twin[h], a = from(h), b = to(h), c = apex(h), d = apex(g);
  if (c == d || valence(c) <= 3 || valence(d) <= 3) return false;
  int common = 0;
  around(a, [&](Id e) {
    if (to(e) != b && joined(to(e), b)) ++common;
  });
  return common == 2;
}

void CornerMesh::collapse(Id h) {
  const Id g = twin[h], a = from(h), b = to(h);
  std::vector<Id> leaving;
  around(a, [&](Id e) { leaving.push_back(e); });
  for (const Id e : leaving) corner[e] = b;
  const auto drop = [&](Id e) {  // e's face closes up: the two other edges become one
    const Id x = twin[next(e)], y = twin[prev(e)], apex_point = corner[prev(e)];
    pair(x, y);
    for (int k = 0; k < 3; ++k) corner[e / 3 * 3 + k] = kNone;
    // Of x and y one leaves the apex, the other leaves b.
    const Id from_apex = corner[x] == apex_point ? x : y;
    out[apex_point] = from_apex;
    out[b] = from_apex == x ? y : x;
  };
  drop(h);
  drop(g);
  out[a] = kNone;
}

std::size_t CornerMesh::split_fans() {
  std::size_t added = 0;
  std::vector<std::uint8_t> seen(corner.size(), 0), used(points.size(), 0);
  for (Id h = 0; h < half_edges(); ++h) {
    if (!alive(h) || seen[h]) continue;
    Id v = corner[h];
    if (used[v]) {
      points.push_back(Vec3(points[v]));
      used.push_back(1);
      v = static_cast<Id>(points.size()) - 1;
      ++added;
    }
    used[v] = 1;
    const auto mark = [&](Id e) { seen[e] = 1, corner[e] = v; };
    Id e = h;
    do {  // counter-clockwise
      mark(e);
      e = turn(e);
    } while (e != kNone && e != h);
    if (e == h) continue;
    for (e = twin[h]; e != kNone; e = twin[e]) mark(e = next(e));  // clockwise
  }
  return added;
}

void CornerMesh::remove_faces(const std::vector<std::uint8_t>& flagged) {
  const auto remove = [&](Id f) {
    for (Id h = 3 * f; h < 3 * f + 3; ++h) {
      if (twin[h] != kNone) twin[twin[h]] = kNone;
      twin[h] = corner[h] = kNone;
    }
  };
  for (Id f = 0; f < faces(); ++f)
    if (flagged[f] && alive(3 * f)) remove(f);
  std::vector<Id> piece(faces(), kNone), walk, size;
  for (Id seed = 0; seed < faces(); ++seed) {
    if (piece[seed] != kNone || !alive(3 * seed)) continue;
    walk.assign(1, seed);
    piece[seed] = static_cast<Id>(size.size());
    for (std::size_t i = 0; i < walk.size(); ++i)
      for (Id h = 3 * walk[i]; h < 3 * walk[i] + 3; ++h)
        if (twin[h] != kNone && piece[twin[h] / 3] == kNone) {
          piece[twin[h] / 3] = piece[seed];
          walk.push_back(twin[h] / 3);
        }
    size.push_back(static_cast<Id>(walk.size()));
  }
  const auto kept = static_cast<Id>(std::max_element(size.begin(), size.end()) - size.begin());
  for (Id f = 0; f < faces(); ++f)
    if (alive(3 * f) && piece[f] != kept) remove(f);
  split_fans();
  compact();
}

void CornerMesh::rebuild_out() {
  out.assign(points.size(), kNone);
  for (Id h = 0; h < half_edges(); ++h) {
    if (!alive(h)) continue;
    if (out[corner[h]] == kNone || twin[h] == kNone) out[corner[h]] = h;
  }
}

void CornerMesh::compact() {
  std::vector<Id> face(faces(), kNone), point(points.size(), kNone);
  Id nf = 0;
  for (Id f = 0; f < faces(); ++f)
    if (alive(3 * f)) face[f] = nf++;
  for (const Id v : corner)
    if (v != kNone) point[v] = 0;
  Id np = 0;
  for (std::size_t v = 0; v < points.size(); ++v)
    if (point[v] == 0) {
      point[v] = np;
      points[np++] = points[v];
    }
  points.resize(np);
  for (Id f = 0; f < faces(); ++f) {
    if (face[f] == kNone) continue;
    patch[face[f]] = patch[f];
    for (int k = 0; k < 3; ++k) {
      const Id t = twin[3 * f + k];
      corner[3 * face[f] + k] = point[corner[3 * f + k]];
      twin[3 * face[f] + k] = t == kNone ? kNone : 3 * face[t / 3] + t % 3;
    }
  }
  corner.resize(3 * nf);
  twin.resize(3 * nf);
  patch.resize(nf);
  rebuild_out();
}

std::vector<std::vector<Id>> CornerMesh::border_loops() const {
  std::vector<std::vector<Id>> loops;
  std::vector<std::uint8_t> seen(corner.size(), 0);
  for (Id start = 0; start < half_edges(); ++start) {
    if (!alive(start) || twin[start] != kNone || seen[start]) continue;
    auto& loop = loops.emplace_back();
    for (Id h = start; !seen[h]; h = out[to(h)]) {  // the border half-edge that leaves a point
      seen[h] = 1;
      loop.push_back(h);
    }
  }
  return loops;
}

SurfaceMesh CornerMesh::to_surface() const {
  SurfaceMesh mesh;
  mesh.points = points;
  mesh.triangles.reserve(faces());
  for (Id h = 0; h < half_edges(); h += 3)
    if (alive(h)) mesh.triangles.push_back({corner[h], corner[h + 1], corner[h + 2]});
  return mesh;
}

CornerMesh corner_mesh(const SurfaceMesh& mesh) {
  CornerMesh m;
  m.points = mesh.points;
  m.corner.reserve(3 * mesh.triangles.size());
  for (const Triangle& t : mesh.triangles) m.corner.insert(m.corner.end(), t.begin(), t.end());
  m.twin.assign(m.corner.size(), CornerMesh::kNone);
  m.patch.assign(mesh.triangles.size(), 0);
  for_each_edge(mesh.triangles, mesh.points.size(), [&](std::span<const std::int32_t> sides) {
    if (sides.size() == 2) m.pair(sides[0], sides[1]);
  });
  m.rebuild_out();
  return m;
}

}  // namespace palpate::surface
