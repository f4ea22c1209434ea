// SPDX-License-Identifier: GPL-3.0-or-later
// The pictures of a touchable head: what is painted on what, seen from where.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "core/touchable_head.hpp"
#include "report/render.hpp"

namespace palpate::report {

enum class View { front, three_quarter, left };  ///< from the subject's left

/// Values at the two ends of a heat map's colours.
struct ColorRange {
  double low = 0, high = 1;
  bool logarithmic = false;
  [[nodiscard]] double part(double value) const;  ///< 0 at low, 1 at high; NaN stays NaN
};
/// Tissue depth [mm], linear from 0 to the 98th percentile, rounded up to a round number.
[[nodiscard]] ColorRange depth_range(const StiffnessMap& map);
/// 2 N / u(2 N) [N/mm], logarithmic from the 2nd to the 98th percentile, rounded outwards to 1, 2
/// or 5 times a power of ten, so that similar heads get the same colours.
[[nodiscard]] ColorRange stiffness_range(const StiffnessMap& map);

[[nodiscard]] Rgb region_color(SkinRegion region);
[[nodiscard]] Rgb status_color(VertexStatus status);
[[nodiscard]] Rgb mark_color(bool marked);

/// Builds the trees once. All pictures are in the head frame, [mm].
class HeadPictures {
 public:
  /// @param head   must outlive the pictures
  /// @param width  [px] of every picture
  HeadPictures(const TouchableHead& head, int width);

  [[nodiscard]] Image scan(View view) const;
  [[nodiscard]] Image skull(View view) const;  ///< in translucent skin
  [[nodiscard]] Image depth(View view, const ColorRange& range) const;
  [[nodiscard]] Image stiffness(View view, const ColorRange& range) const;
  /// Any number per vertex in the sequential colours; NaN is grey.
  [[nodiscard]] Image values(View view, const std::vector<double>& values,
                             const ColorRange& range) const;
  /// Vertices marked with 1 (one mark per vertex) beside the others.
  [[nodiscard]] Image marked(View view, const std::vector<std::uint8_t>& marks) const;
  [[nodiscard]] Image regions(View view) const;
  [[nodiscard]] Image status(View view) const;  ///< solved points as beads
  /// The face with its landmarks, names and confidences beside it, as SVG that carries the picture.
  [[nodiscard]] std::string landmarks_svg() const;

 private:
  [[nodiscard]] Image painted(View view, Look skin) const;

  const StiffnessMap* map_;
  LandmarkSet landmarks_;
  using Cameras = std::array<Camera, 3>;  ///< by View
  Cameras whole_, head_;                  ///< of the whole scan; of the head alone
  Renderer renderer_;
};

}  // namespace palpate::report
