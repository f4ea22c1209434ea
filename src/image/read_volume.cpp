// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "core/atomic_file.hpp"
#include "image/voxels.hpp"

namespace palpate::image {
namespace fs = std::filesystem;
namespace {

constexpr std::size_t kMostSlices = 20000;

Volume read_folder(const fs::path& folder) {
  std::vector<fs::path> paths;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder))
    if (entry.is_regular_file()) paths.push_back(entry.path());
  if (paths.size() > kMostSlices)
    refuse(folder.string(), "holds too many files", "give the folder of one CT series");
  std::sort(paths.begin(), paths.end());
  std::vector<std::pair<std::string, std::string>> files;
  for (const fs::path& p : paths) files.emplace_back(read_file(p), p.string());
  return parse_dicom(files, folder.string());
}

}  // namespace

Volume read_volume(const fs::path& path) {
  const std::string name = path.string();
  std::error_code error;
  if (fs::is_directory(path, error)) return read_folder(path);
  if (!fs::is_regular_file(path, error)) refuse(name, "is no file and no folder", "check the path");
  const std::string bytes = read_file(path);
  if (bytes.starts_with("NRRD")) return parse_nrrd(bytes, name, path.parent_path());
  if (name.ends_with(".nii") || name.ends_with(".nii.gz")) return parse_nifti(bytes, name);
  refuse(name, "is no volume that is read here",
         "give .nii, .nii.gz, .nrrd, .nhdr or a DICOM folder");
}

}  // namespace palpate::image
