// SPDX-License-Identifier: GPL-3.0-or-later
// The terms of the depth fit: what each bone point should satisfy, and their linearisation.
#pragma once
#include <cstdint>
#include <vector>

#include "skull/depth_model.hpp"
#include "skull/fit.hpp"
#include "skull/skin_field.hpp"

namespace palpate::skull {

/// A point of the template that the fit looks at.
struct FitPoint {
  enum class Kind : std::uint8_t { bone, landmark, registration };
  Kind kind = Kind::bone;
  Vec3 rest = Vec3::Zero();    ///< [mm] template
  Vec3 normal = Vec3::Zero();  ///< [-] template; bone, and landmarks of the jaw's lower border
  double mean = 0;             ///< [mm] expected depth
  double sd = 1;               ///< [mm] its spread
  double weight = 0;  ///< [-] independent observations that the point stands for; 0: limits only
  double limit_weight = 0;     ///< [-] the same, of the clearance
  Vec3 target = Vec3::Zero();  ///< [mm] head; registration only
  Vec3 precision =
      Vec3::Zero();  ///< [1/mm^2] of the target, per axis of the head frame; registration only
};

/// weight/2 * (residual - direction . step)^2, the model of one term around the current positions.
struct Row {
  std::int32_t point = 0;
  Vec3 direction = Vec3::Zero();  ///< [-] head frame
  double residual = 0;            ///< [mm] what is wanted along `direction`
  double weight = 0;              ///< [1/mm^2]
};

struct Linearisation {
  double energy = 0;      ///< [-] sum of all terms
  std::vector<Row> rows;  ///< the energy's gradient along a step is -sum weight residual direction
};

/// Every bone point on a grid of options.depth.sampling, the table's landmarks, and the
/// registration points that head and template share. A point and its mirror image are both chosen
/// or not.
[[nodiscard]] std::vector<FitPoint> make_fit_points(const HeadSurface& head,
                                                    const SkullTemplate& skull,
                                                    const DepthModel& model,
                                                    const FitOptions& options);

/// What may be asked of each point where it is now; kept while a step is tried, so that the energy
/// is continuously differentiable.
struct Standing {
  std::vector<std::uint8_t> drawn;    ///< scanned or completed skin is nearest, and bone faces it
  std::vector<std::uint8_t> limited;  ///< the scan does not end here
  std::vector<Vec3>
      outward;  ///< [-] head: the way along which depth is measured; zero: the shortest
};
/// @param normals  [-] of the points, head frame
[[nodiscard]] Standing standing(const std::vector<FitPoint>& points,
                                const std::vector<Vec3>& positions,
                                const std::vector<Vec3>& normals, const SkinField& skin,
                                const FitOptions& options);

/// Depth terms of the drawn points (Huber; with the wider spread where the skin was completed),
/// clearance of the limited ones (one-sided, quadratic), registration points (quadratic).
[[nodiscard]] Linearisation linearise(const std::vector<FitPoint>& points,
                                      const std::vector<Vec3>& positions, const Standing& standing,
                                      const SkinField& skin, const FitOptions& options);

}  // namespace palpate::skull
