// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/site.hpp"

namespace palpate::stiffness {

SiteCurve press_site(const PatchTemplate& t, const std::vector<Vec3>& nodes,
                     std::shared_ptr<const fem::EnergyDensity> law, const Tool& press_tool,
                     std::span<const double> forces, fem::Cholesky& cholesky) {
  const Vec3 axis = -Vec3::UnitZ();
  fem::Indenter tool;
  tool.radius = press_tool.radius;
  tool.penalty = press_tool.penalty;
  tool.axis = axis;
  tool.start = axis * fem::first_contact(t.topology.contact_faces, t.topology.order, nodes,
                                         Vec3::Zero(), axis, tool.radius);
  const fem::ElasticBody body(t.topology, nodes, std::move(law));
  const fem::Contact contact(t.topology, nodes, tool);
  const fem::PressCurve curve = fem::press(body, contact, forces, cholesky);
  SiteCurve out{{}, curve.iterations, curve.projections, curve.residual};
  if (curve.complete) out.travel = curve.travel;
  return out;
}

}  // namespace palpate::stiffness
