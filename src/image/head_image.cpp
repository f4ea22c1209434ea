// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/head_image.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "core/error.hpp"
#include "image/filters.hpp"
#include "image/isosurface.hpp"

namespace palpate::image {
namespace {

constexpr double kPieceShare = 0.1;   ///< [-] of the largest piece: smaller ones are not the head's
constexpr double kLeastTissue = 2e5;  ///< [mm^3] a head has 20 times more
constexpr double kLeastBone = 2e4;    ///< [mm^3] a skull has 20 times more

void check(const ImageOptions& o) {
  if (!(o.smoothing >= 0 && o.smoothing <= 10))
    throw InputError("image: the smoothing must be 0 to 10 mm");
  if (!(o.voxel > 0 && o.voxel <= 10))
    throw InputError("image: the voxel must be above 0 to 10 mm");
  if (!std::isfinite(o.skin_threshold) || !std::isfinite(o.bone_threshold) ||
      o.bone_threshold <= o.skin_threshold)
    throw InputError("image: the bone threshold must be above the skin threshold");
}

double voxel_volume(const Volume& v) {
  return std::abs(v.step.determinant());
}

/// Surface of what lies above `level`: pieces that count, without hollows. Voxels of other pieces
/// and of hollows are moved to the other side of the level, so that the surface keeps its sub-voxel
/// place everywhere else.
SurfaceMesh solid_surface(const Volume& field, double level, double least_mm3,
                          const std::string& what) {
  const auto range = std::minmax_element(field.value.begin(), field.value.end());
  Volume v = padded(field, std::min(*range.first, static_cast<float>(level - 1)));
  std::vector<std::uint8_t> above(v.value.size());
  for (std::size_t i = 0; i < above.size(); ++i) above[i] = v.value[i] > level;
  const Components solid = components(v, above);
  const std::size_t largest =
      solid.size.empty() ? 0 : *std::max_element(solid.size.begin(), solid.size.end());
  if (static_cast<double>(largest) * voxel_volume(v) < least_mm3)
    throw InputError(
        fmt::format("{}: no {} above {}: the largest piece has {:.0f} cm^3; change the threshold "
                    "or the labels",
                    v.format, what, level, static_cast<double>(largest) * voxel_volume(v) / 1000));
  const double span = std::max(1.0, static_cast<double>(*range.second) - level);
  const auto below_level = static_cast<float>(level - 0.5 * span);
  const auto above_level = static_cast<float>(level + 0.5 * span);
  for (std::size_t i = 0; i < above.size(); ++i)
    if (above[i] && static_cast<double>(solid.size[solid.of[i] - 1]) <
                        kPieceShare * static_cast<double>(largest)) {
      v.value[i] = below_level;
      above[i] = 0;
    }
  for (std::uint8_t& a : above) a = !a;
  const Components empty = components(v, above);
  for (std::size_t i = 0; i < above.size(); ++i)
    if (above[i] && !empty.at_edge[empty.of[i] - 1]) v.value[i] = above_level;
  return isosurface(v, level);
}

std::string described(const Volume& given, const Volume& used) {
  return fmt::format(
      "{} volume of {} x {} x {} voxels, {:.3g} x {:.3g} x {:.3g} mm; surfaces from {:.3g} x "
      "{:.3g} x {:.3g} mm",
      given.format, given.size[0], given.size[1], given.size[2], given.spacing(0), given.spacing(1),
      given.spacing(2), used.spacing(0), used.spacing(1), used.spacing(2));
}

}  // namespace

HeadImage head_of_ct(const Volume& ct, const ImageOptions& options, const Progress& progress) {
  check(options);
  progress.step("image", 0);
  Volume v = ct;
  smooth(v, options.smoothing);
  v = coarsened(v, options.voxel);
  HeadImage out;
  out.warnings = ct.warnings;
  out.notes = {described(ct, v),
               fmt::format("skin above {} HU, bone above {} HU, after a Gaussian of {} mm",
                           options.skin_threshold, options.bone_threshold, options.smoothing)};
  progress.step("image", 0.4);
  out.skin = solid_surface(v, options.skin_threshold, kLeastTissue, "tissue");
  progress.step("image", 0.7);
  out.skull = solid_surface(v, options.bone_threshold, kLeastBone, "bone");
  progress.step("image", 1);
  return out;
}

HeadImage head_of_labels(const Volume& labels, const ImageOptions& options,
                         const Progress& progress) {
  check(options);
  constexpr double kHalf = 0.5;  // [-] of an indicator that is 0 outside and 1 inside
  progress.step("image", 0);
  const auto indicator = [&](auto is_inside) {
    Volume v = labels;
    for (float& x : v.value) x = is_inside(static_cast<int>(std::lround(x))) ? 1.0f : 0.0f;
    smooth(v, std::max(options.smoothing, 0.5 * v.spacing(0)));  // else the surface has steps
    return coarsened(v, options.voxel);
  };
  HeadImage out;
  out.warnings = labels.warnings;
  const Volume tissue = indicator([](int label) { return label != 0; });
  out.notes = {described(labels, tissue),
               fmt::format("skin around every label but 0, bone labels {}, smoothed by {:.2g} mm",
                           fmt::join(options.bone_labels, ", "),
                           std::max(options.smoothing, 0.5 * labels.spacing(0)))};
  progress.step("image", 0.3);
  out.skin = solid_surface(tissue, kHalf, kLeastTissue, "tissue");
  const Volume bone = indicator([&](int label) {
    return std::find(options.bone_labels.begin(), options.bone_labels.end(), label) !=
           options.bone_labels.end();
  });
  progress.step("image", 0.7);
  out.skull = solid_surface(bone, kHalf, kLeastBone, "bone");
  progress.step("image", 1);
  return out;
}

}  // namespace palpate::image
