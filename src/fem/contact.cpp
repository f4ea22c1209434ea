// SPDX-License-Identifier: GPL-3.0-or-later
// With y the skin point relative to the indenter, y = X + sum_i N_i u_i - start - d axis:
//   sphere  g = |y| - R,   dg/dy = y/|y|,  d2g/dy2 = (I - n n')/|y|
//   punch   g = y . axis,  dg/dy = axis,   d2g/dy2 = 0
// and for phi = penalty/2 g^2 (g < 0), M = phi'' n n' + phi' d2g:
//   by (u_i, u_j): N_i N_j M,  by (u_i, d): -N_i M axis,  by (d, d): axis' M axis.
// phi' d2g is the only indefinite part (it is negative: a deflected pressure); `projected` drops
// it.
#include "fem/contact.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.hpp"

namespace palpate::fem {
namespace {

// A sphere whose centre is o * axis meets a triangle first at a corner, on an edge or within; each
// of the three gives its smallest o, kInadmissible where it is missed. Points are relative to o =
// 0.

double meets_point(const Vec3& p, const Vec3& axis, double radius) {
  const double along = p.dot(axis), aside_squared = p.squaredNorm() - along * along;
  if (aside_squared >= radius * radius) return kInadmissible;
  return along - std::sqrt(radius * radius - aside_squared);
}

double meets_edge(const Vec3& p, const Vec3& q, const Vec3& axis, double radius) {
  const double length = (q - p).norm();
  const Vec3 e = (q - p) / length;
  const Vec3 d = axis - axis.dot(e) * e, m = p.dot(e) * e - p;  // across the edge
  // |m + o d| = radius
  const double a = d.squaredNorm(), b = m.dot(d), c = m.squaredNorm() - radius * radius;
  if (a < 1e-12 || b * b < a * c) return kInadmissible;
  const double o = (-b - std::sqrt(b * b - a * c)) / a;
  const double at = (o * axis - p).dot(e);
  return at >= 0 && at <= length ? o : kInadmissible;
}

double meets_plane(const std::array<Vec3, 3>& corner, const Vec3& axis, double radius) {
  Vec3 n = (corner[1] - corner[0]).cross(corner[2] - corner[0]).normalized();
  if (n.dot(axis) > 0) n = -n;  // towards the sphere that comes
  if (n.dot(axis) > -1e-12) return kInadmissible;
  const double o = (radius + n.dot(corner[0])) / n.dot(axis);
  const Vec3 touch = o * axis - radius * n;
  double side = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3& p = corner[i];
    const double s = (corner[(i + 1) % 3] - p).cross(touch - p).dot(n);
    if (side * s < 0) return kInadmissible;
    if (s != 0) side = s;
  }
  return o;
}

/// Rest position of quadrature point q of a face.
Vec3 face_point(const std::int32_t* face, const Eigen::VectorXd& shape,
                const std::vector<Vec3>& nodes) {
  Vec3 p = Vec3::Zero();
  for (int i = 0; i < shape.size(); ++i) p += shape[i] * nodes[face[i]];
  return p;
}

}  // namespace

double default_penalty(double youngs_modulus, double tool_radius) {
  return 900 * youngs_modulus / tool_radius;
}

double first_contact(const FaceList& faces, ElementOrder order, const std::vector<Vec3>& nodes,
                     const Vec3& through, const Vec3& axis, double radius) {
  const int stride = face_nodes(order);
  double offset = kInadmissible;
  for (std::size_t f = 0; f < faces.size(); f += stride) {
    const std::array<Vec3, 3> corner = {nodes[faces[f]] - through, nodes[faces[f + 1]] - through,
                                        nodes[faces[f + 2]] - through};
    offset = std::min(offset, meets_plane(corner, axis, radius));
    for (int i = 0; i < 3; ++i) {
      offset = std::min(offset, meets_point(corner[i], axis, radius));
      offset = std::min(offset, meets_edge(corner[i], corner[(i + 1) % 3], axis, radius));
    }
  }
  if (offset == kInadmissible) throw InputError("the tool's path does not meet the skin");
  return offset;
}

Contact::Contact(const Topology& topology, const std::vector<Vec3>& nodes, const Indenter& indenter)
    : topology_(topology), nodes_(nodes), indenter_(indenter) {
  const FaceQuadrature& rule = contact_quadrature();
  const int stride = face_nodes(topology.order);
  std::vector<Eigen::Matrix<double, Eigen::Dynamic, 2>> slope;
  for (const Vec3& b : rule.points) {
    shape_.push_back(face_shape(topology.order, b));
    slope.push_back(face_shape_gradient(topology.order, b));
  }
  for (std::size_t f = 0; f < topology.contact_faces.size(); f += stride)
    for (std::size_t q = 0; q < rule.weights.size(); ++q) {
      const std::int32_t* face = &topology.contact_faces[f];
      Eigen::Matrix<double, 3, 2> tangent = Eigen::Matrix<double, 3, 2>::Zero();
      for (int i = 0; i < stride; ++i) tangent += nodes[face[i]] * slope[q].row(i);
      const double area = 0.5 * rule.weights[q] * tangent.col(0).cross(tangent.col(1)).norm();
      const Vec3 y = face_point(face, shape_[q], nodes) - indenter.start;
      const double aside = (y - y.dot(indenter.axis) * indenter.axis).norm();
      if (indenter.shape == IndenterShape::sphere || aside <= indenter.radius)
        points_.push_back({f, static_cast<int>(q), area});
    }
}

double Contact::gap_value(const Vec3& p, double travel) const {
  const Vec3 y = p - indenter_.start - travel * indenter_.axis;
  return indenter_.shape == IndenterShape::sphere ? y.norm() - indenter_.radius
                                                  : y.dot(indenter_.axis);
}

Contact::Gap Contact::gap(const Vec3& p, double travel) const {
  if (indenter_.shape == IndenterShape::flat_punch)
    return {gap_value(p, travel), indenter_.axis, Mat3::Zero()};
  const Vec3 y = p - indenter_.start - travel * indenter_.axis;
  const double length = y.norm();
  const Vec3 n = y / length;
  return {length - indenter_.radius, n, (Mat3::Identity() - n * n.transpose()) / length};
}

Vec3 Contact::position(const Eigen::VectorXd& x, const Point& p) const {
  Vec3 at = Vec3::Zero();
  for (int i = 0; i < shape_[p.rule].size(); ++i) {
    const int node = topology_.contact_faces[p.face + i];
    const int f = topology_.free_node[node];
    at += shape_[p.rule][i] * (f < 0 ? nodes_[node] : Vec3(nodes_[node] + x.segment<3>(3 * f)));
  }
  return at;
}

double Contact::energy(const Eigen::VectorXd& x) const {
  double sum = 0;
  for (const Point& p : points_) {
    const double g = gap_value(position(x, p), x[topology_.travel()]);
    if (touches(g)) sum += p.area * g * g;
  }
  return 0.5 * indenter_.penalty * sum;
}

double Contact::squared_pressure(const Eigen::VectorXd& x) const {
  return 2 * indenter_.penalty * energy(x);
}

void Contact::add_derivatives(const Eigen::VectorXd& x, HessianKind kind, Eigen::VectorXd* gradient,
                              std::vector<double>* hessian) const {
  const int travel = topology_.travel();
  for (const Point& p : points_) {
    const Vec3 at = position(x, p);
    if (!touches(gap_value(at, x[travel]))) continue;
    const Gap g = gap(at, x[travel]);
    const Vec3 force = p.area * indenter_.penalty * g.value * g.gradient;
    Mat3 M = p.area * indenter_.penalty * g.gradient * g.gradient.transpose();
    if (kind == HessianKind::exact) M += p.area * indenter_.penalty * g.value * g.hessian;
    const Eigen::VectorXd& N = shape_[p.rule];
    for (int i = 0; i < N.size(); ++i) {
      const int a = topology_.free_node[topology_.contact_faces[p.face + i]];
      if (a < 0) continue;
      if (gradient) gradient->segment<3>(3 * a) += N[i] * force;
      if (!hessian) continue;
      for (int j = 0; j <= i; ++j) {
        const int b = topology_.free_node[topology_.contact_faces[p.face + j]];
        if (b >= 0) topology_.add_block(*hessian, a, b, N[i] * N[j] * M);
      }
      topology_.add_travel_row(*hessian, a, -N[i] * M * indenter_.axis);
    }
    if (gradient) (*gradient)[travel] -= force.dot(indenter_.axis);
    if (hessian) hessian->back() += indenter_.axis.dot(M * indenter_.axis);
  }
}

}  // namespace palpate::fem
