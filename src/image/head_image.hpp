// SPDX-License-Identifier: GPL-3.0-or-later
// Skin and skull out of a volume instead of an estimate.
#pragma once
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "core/surface_mesh.hpp"
#include "image/volume.hpp"

namespace palpate::image {

struct ImageOptions {
  double skin_threshold = -300;  ///< [HU] above: tissue; half way between air and fat
  double bone_threshold = 250;  ///< [HU] above: bone; thin bone needs less, metal is not told apart
  double smoothing = 0.7;       ///< [mm] SD of the Gaussian before thresholding; >= 0
  double voxel = 1.0;           ///< [mm] finer grids are thinned out to voxels of at most this; > 0
  std::vector<int> bone_labels = {4, 7, 8};  ///< of a label volume: bone, compact and spongy bone
};

/// Both in the volume's own frame, [mm]; oriented, closed unless the volume is cut through.
struct HeadImage {
  SurfaceMesh skin;
  SurfaceMesh skull;  ///< outer surface of the bone and the inner ones that are open to outside
  std::vector<std::string> notes;     ///< thresholds, smoothing, voxels: what was done
  std::vector<std::string> warnings;  ///< what a reader should doubt
};

/// From Hounsfield units: the largest piece of tissue, its hollows filled (air inside the head is
/// no skin); the largest piece of bone and those of at least a tenth of it (a jaw), hollows filled.
/// @throws InputError  no tissue or no bone at these thresholds
[[nodiscard]] HeadImage head_of_ct(const Volume& ct, const ImageOptions& options = {},
                                   const Progress& progress = {});
/// From labels: everything that is not 0 is tissue; `bone_labels` are bone (the default is what
/// SimNIBS' charm and headreco write).
[[nodiscard]] HeadImage head_of_labels(const Volume& labels, const ImageOptions& options = {},
                                       const Progress& progress = {});

}  // namespace palpate::image
