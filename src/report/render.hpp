// SPDX-License-Identifier: GPL-3.0-or-later
// Pictures of surfaces by casting rays; needs neither a display nor a graphics card.
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "core/surface_mesh.hpp"
#include "plot/color_map.hpp"

namespace palpate::report {

using plot::Rgb;

/// Where a picture is taken from. The image plane goes through `target`, facing the eye; x runs to
/// the image's right and y up, both [mm] in that plane.
struct Camera {
  Vec3 target = Vec3::Zero();     ///< [mm]
  Vec3 to_eye = Vec3::UnitZ();    ///< [-] unit, from the target to the eye
  Vec3 right = Vec3::UnitX();     ///< [-] unit
  Vec3 up = Vec3::UnitY();        ///< [-] unit
  double distance = 0;            ///< [mm] eye to target; 0: parallel rays
  Eigen::Vector2d low{-1, -1};    ///< [mm] lower left of the picture in the image plane
  Eigen::Vector2d high{1, 1};     ///< [mm] upper right
  int width = 900, height = 900;  ///< [px]

  /// Pixel coordinates of a point, x right and y down.
  [[nodiscard]] Eigen::Vector2d project(const Vec3& p) const;
};

/// A camera that shows all `points` from the direction `to_eye`, with a narrow margin.
/// @param world_up  need not be perpendicular to `to_eye`, must not be parallel to it
/// @param perspective  [-] eye distance in radii of the points' box; 0: parallel rays
[[nodiscard]] Camera frame_points(const std::vector<Vec3>& points, const Vec3& to_eye,
                                  const Vec3& world_up, double perspective, int width);

/// How one mesh of the renderer looks in one picture.
struct Look {
  bool visible = true;
  std::vector<Rgb> colors;     ///< one per point; empty: `base` everywhere
  bool nearest = false;        ///< each spot takes its nearest corner's colour: for categories
  Rgb base{0.86, 0.83, 0.79};  ///< unpainted plaster
  double opacity = 1;          ///< [-] facing the eye; grazing parts are denser; 1 is solid
  double relief = 1;           ///< [-] 1: full light and shade; less keeps colours nearer to the
                               ///< legend's
};
struct Sphere {
  Vec3 centre = Vec3::Zero();  ///< [mm]
  double radius = 1;           ///< [mm]
  Rgb color;
};

struct Image {
  int width = 0, height = 0;
  std::vector<std::uint8_t> rgba;  ///< row by row from the top; not premultiplied; outside is clear
};

/// Holds a tree and the ambient light of each mesh, so that many pictures share them.
class Renderer {
 public:
  /// Meshes in [mm]. One whose signed volume is negative is shown turned outside out.
  /// @throws InputError  a mesh with a bad index or coordinate
  explicit Renderer(std::vector<SurfaceMesh> meshes);
  ~Renderer();
  Renderer(Renderer&&) noexcept;
  Renderer& operator=(Renderer&&) noexcept;

  /// @param looks  one per mesh
  /// @throws InputError  the number of looks or of colours does not fit
  /// @note Same bits for any thread count. 2 x 2 samples a pixel.
  [[nodiscard]] Image picture(const Camera& camera, const std::vector<Look>& looks,
                              const std::vector<Sphere>& spheres = {}) const;

 private:
  struct Stage;
  std::unique_ptr<Stage> stage_;
};

}  // namespace palpate::report
