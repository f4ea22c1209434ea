// SPDX-License-Identifier: GPL-3.0-or-later
// Medical volumes in: NIfTI-1, NRRD, a folder of DICOM slices.
#pragma once
#include <array>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/types.hpp"

namespace palpate::image {

/// A regular grid of numbers in a right-handed patient frame, [mm].
struct Volume {
  std::array<int, 3> size{};     ///< along i, j, k; each >= 2
  std::vector<float> value;      ///< i fastest; Hounsfield units, or labels
  Mat3 step = Mat3::Identity();  ///< [mm] columns: from one voxel to the next along i, j, k
  Vec3 origin = Vec3::Zero();    ///< [mm] centre of the first voxel
  std::string format;            ///< "nifti", "nrrd", "dicom"
  std::vector<std::string> warnings;

  [[nodiscard]] std::size_t index(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * size[1] + j) * size[0] + i;
  }
  [[nodiscard]] float at(int i, int j, int k) const { return value[index(i, j, k)]; }
  [[nodiscard]] Vec3 place(const Vec3& ijk) const { return origin + step * ijk; }
  /// [mm] edge of a voxel along one axis.
  [[nodiscard]] double spacing(int axis) const { return step.col(axis).norm(); }
};

/// .nii, .nii.gz (NIfTI-1), .nrrd, .nhdr (raw or gzip), or a folder of uncompressed DICOM slices,
/// of which the series with the most slices is taken.
/// @throws InputError  one line: file, what is wrong, what to do; nothing is allocated on the word
///         of a header before the file's size was held against it
[[nodiscard]] Volume read_volume(const std::filesystem::path& path);

// The readers alone; `name` is for messages.
[[nodiscard]] Volume parse_nifti(std::string_view bytes, const std::string& name);
/// @param folder  of the data file that a detached header names
[[nodiscard]] Volume parse_nrrd(std::string_view bytes, const std::string& name,
                                const std::filesystem::path& folder);
/// @param files  bytes and name of each slice, in any order
[[nodiscard]] Volume parse_dicom(const std::vector<std::pair<std::string, std::string>>& files,
                                 const std::string& name);

}  // namespace palpate::image
