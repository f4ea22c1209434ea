// SPDX-License-Identifier: GPL-3.0-or-later
// Frictionless contact of the skin with a rigid indenter that travels along its axis.
#pragma once
#include "fem/body.hpp"

namespace palpate::fem {

enum class IndenterShape { sphere, flat_punch };

/// At travel d [mm] its reference point is start + d * axis: the sphere's centre, or the middle of
/// the punch's face (the punch touches only skin that rests within its radius of the axis).
struct Indenter {
  IndenterShape shape = IndenterShape::sphere;
  double radius = 8;           ///< [mm] > 0
  Vec3 axis = -Vec3::UnitZ();  ///< [-] unit, the direction of travel
  Vec3 start = Vec3::Zero();   ///< [mm]
  /// Pressure per penetration [MPa/mm]; see default_penalty().
  double penalty = 5;
  /// The skin under the punch follows its plane in both directions (and slides in it). The same
  /// equilibrium where all of it presses, in one Newton step and at any penalty.
  bool bilateral = false;
};

/// 900 E / R (5 MPa/mm for a fingertip on flesh): with the correction of press() the travel is
/// within 0.2 % of that at 40 times the penalty; ten times more doubles the Newton steps, ten times
/// less costs 0.5 % on thin tissue.
[[nodiscard]] double default_penalty(double youngs_modulus, double tool_radius);

/// Offset along the axis at which a sphere that comes along `axis` through `through` first touches
/// the triangles of the faces' corners: its centre is then `through + offset * axis`.
/// @throws InputError when no face lies within the sphere's radius of the axis
[[nodiscard]] double first_contact(const FaceList& faces, ElementOrder order,
                                   const std::vector<Vec3>& nodes, const Vec3& through,
                                   const Vec3& axis, double radius);

/// Contact energy penalty/2 * integral of min(gap, 0)^2 over the skin's rest area, by quadrature.
class Contact {
 public:
  /// @param topology  with contact faces and travel; must outlive the object
  Contact(const Topology& topology, const std::vector<Vec3>& nodes, const Indenter& indenter);

  [[nodiscard]] double energy(const Eigen::VectorXd& x) const;  ///< [N mm]
  void add_derivatives(const Eigen::VectorXd& x, HessianKind kind, Eigen::VectorXd* gradient,
                       std::vector<double>* hessian) const;
  /// Integral of the squared contact pressure over the skin's rest area [N^2/mm^2].
  [[nodiscard]] double squared_pressure(const Eigen::VectorXd& x) const;
  [[nodiscard]] double penalty() const { return indenter_.penalty; }

 private:
  struct Gap {
    double value;   // [mm] < 0: penetration
    Vec3 gradient;  // by the skin point
    Mat3 hessian;
  };
  struct Point {
    std::size_t face;
    int rule;     // index of the quadrature point
    double area;  // [mm^2]
  };
  [[nodiscard]] Gap gap(const Vec3& skin_point, double travel) const;
  [[nodiscard]] Vec3 position(const Eigen::VectorXd& x, const Point& p) const;
  [[nodiscard]] bool touches(double gap) const { return gap < 0 || indenter_.bilateral; }
  /// Cheaper than gap(): value only.
  [[nodiscard]] double gap_value(const Vec3& skin_point, double travel) const;

  const Topology& topology_;
  const std::vector<Vec3>& nodes_;
  Indenter indenter_;
  std::vector<Eigen::VectorXd> shape_;  // per quadrature point of a face
  std::vector<Point> points_;
};

}  // namespace palpate::fem
