// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/site.hpp"

namespace palpate::stiffness {
namespace {

constexpr int kMostSplits = 2;  // a load that fails is approached in halves, then in quarters

/// The forces with `splits` halvings of each interval, from 0.
std::vector<double> split(std::span<const double> forces, int splits) {
  const int parts = 1 << splits;
  std::vector<double> out;
  double before = 0;
  for (const double f : forces) {
    for (int i = 1; i <= parts; ++i) out.push_back(before + (f - before) * i / parts);
    before = f;
  }
  return out;
}

void note_rings(const std::vector<std::vector<std::int32_t>>& rings, const fem::Topology& topology,
                const Eigen::VectorXd& x, std::vector<double>& sunk) {
  for (const std::vector<std::int32_t>& ring : rings) {
    double sum = 0;
    for (const std::int32_t node : ring) {
      const int f = topology.free_node[node];
      if (f >= 0) sum -= x[3 * f + 2];
    }
    sunk.push_back(sum / static_cast<double>(ring.size()));
  }
}

}  // namespace

bool deepens(std::span<const double> travel) {
  double last = 0;
  for (const double u : travel) {
    if (!(u > last)) return false;
    last = u;
  }
  return !travel.empty();
}

std::vector<std::vector<std::int32_t>> skin_rings(const PatchTemplate& t) {
  std::vector<std::vector<std::int32_t>> rings(t.rule.rings.size() + 1);
  for (std::size_t c = 0; c < t.columns.size(); ++c)
    rings[t.columns[c].ring].push_back(t.corner(static_cast<int>(c), 0));
  return rings;
}

SiteCurve press_body(const fem::Topology& topology, const std::vector<Vec3>& nodes,
                     fem::TissueLaws laws, const Tool& press_tool, std::span<const double> forces,
                     const std::vector<std::vector<std::int32_t>>& rings, fem::Cholesky& cholesky) {
  const Vec3 axis = -Vec3::UnitZ();
  fem::Indenter tool;
  tool.radius = press_tool.radius;
  tool.penalty = press_tool.penalty;
  tool.axis = axis;
  tool.start = axis * fem::first_contact(topology.contact_faces, topology.order, nodes,
                                         Vec3::Zero(), axis, tool.radius);
  const fem::ElasticBody body(topology, nodes, std::move(laws));
  const fem::Contact contact(topology, nodes, tool);
  SiteCurve out;
  out.method = SolveMethod::in_double;
  for (int splits = 0; splits <= kMostSplits && out.travel.empty(); ++splits) {
    const fem::PressCurve curve = fem::press(body, contact, split(forces, splits), cholesky);
    out.iterations += curve.iterations;
    out.projections += curve.projections;
    out.residual = curve.residual;
    if (!curve.complete || !deepens(curve.travel)) continue;
    const std::size_t parts = std::size_t{1} << splits;
    for (std::size_t i = parts - 1; i < curve.travel.size(); i += parts) {
      out.travel.push_back(curve.travel[i]);
      note_rings(rings, topology, curve.states[i], out.sunk);
    }
  }
  return out;
}

SiteCurve press_site(const PatchTemplate& t, const std::vector<Vec3>& nodes, fem::TissueLaws laws,
                     const Tool& tool, std::span<const double> forces, fem::Cholesky& cholesky) {
  return press_body(t.topology, nodes, std::move(laws), tool, forces, skin_rings(t), cholesky);
}

}  // namespace palpate::stiffness
