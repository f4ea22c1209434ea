// SPDX-License-Identifier: GPL-3.0-or-later
// Sederberg & Parry, "Free-form deformation of solid geometric models", SIGGRAPH 1986; eqs. 4.6-4.9
// of the source. With all weights equal the three forms agree: the Bernstein polynomials sum to one
// and reproduce x from the control points at rest (linear precision). With unequal weights only the
// displacement form keeps that: sum B w P / sum B w is x plus the weights' own shift.
#include "skull/ffd.hpp"

#include "core/error.hpp"

namespace palpate::skull {

BernsteinLattice make_lattice(const Box& box, const std::array<int, 3>& cells) {
  if (!(box.size().minCoeff() > 0))
    throw InputError("the lattice's box has no volume: the skull template is flat or empty");
  BernsteinLattice lattice{cells, box, {}, {}, {}};
  for (int i = 0; i <= cells[0]; ++i)
    for (int j = 0; j <= cells[1]; ++j)
      for (int k = 0; k <= cells[2]; ++k) {
        const Vec3 part(double(i) / cells[0], double(j) / cells[1], double(k) / cells[2]);
        lattice.rest.push_back(box.low + part.cwiseProduct(box.size()));
      }
  lattice.moved = lattice.rest;
  lattice.weight.assign(lattice.rest.size(), 1.0);
  return lattice;
}

std::vector<double> bernstein(int n, double s) {
  // De Casteljau's triangle on the unit vector: only sums of non-negative terms.
  std::vector<double> b(n + 1, 0.0);
  b[0] = 1;
  for (int degree = 1; degree <= n; ++degree) {
    for (int i = degree; i > 0; --i) b[i] = (1 - s) * b[i] + s * b[i - 1];
    b[0] *= 1 - s;
  }
  return b;
}

Vec3 deform(const BernsteinLattice& lattice, const Vec3& x, FfdForm form) {
  const Vec3 inside = x.cwiseMax(lattice.box.low).cwiseMin(lattice.box.high);
  const Vec3 part = (inside - lattice.box.low).cwiseQuotient(lattice.box.size());
  std::array<std::vector<double>, 3> basis;
  for (int a = 0; a < 3; ++a) basis[a] = bernstein(lattice.cells[a], part[a]);

  Vec3 position = Vec3::Zero(), displacement = Vec3::Zero();
  double total = 0;
  std::size_t c = 0;
  for (const double bi : basis[0])
    for (const double bj : basis[1])
      for (const double bk : basis[2]) {
        const double w = bi * bj * bk * lattice.weight[c];
        position += w * lattice.moved[c];
        displacement += w * (lattice.moved[c] - lattice.rest[c]);
        total += w;
        ++c;
      }
  switch (form) {
    case FfdForm::literal:
      return position + (x - inside);
    case FfdForm::rational:
      return position / total + (x - inside);
    case FfdForm::displacement:
      break;
  }
  return x + displacement / total;
}

}  // namespace palpate::skull
