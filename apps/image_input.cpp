// SPDX-License-Identifier: GPL-3.0-or-later
// Skin and skull out of a CT or a label volume, in place of a scan and a fit.
#include <fmt/format.h>

#include "apps/pipeline.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "io/sha256.hpp"

namespace palpate::app {

PreparedScan prepare_image(const PipelineOptions& options, const Progress& progress,
                           StageClock& clock) {
  const bool labelled = !options.labels.empty();
  const std::filesystem::path& path = labelled ? options.labels : options.ct;
  PreparedScan prepared;
  prepared.file_name = path.filename().string();
  const image::Volume volume = clock.run("read", [&] { return image::read_volume(path); });
  image::HeadImage head = clock.run("image", [&] {
    return labelled ? image::head_of_labels(volume, options.image, progress)
                    : image::head_of_ct(volume, options.image, progress);
  });
  prepared.scan.mesh = std::move(head.skin);
  prepared.scan.format = volume.format;
  if (std::filesystem::is_regular_file(path))
    prepared.scan.sha256 = io::sha256_hex(read_file(path));
  prepared.scan.warnings = std::move(head.warnings);
  prepared.image_notes = std::move(head.notes);
  prepared.known_skull = std::move(head.skull);
  prepared.scan_mm = prepared.scan.mesh;
  try {
    prepared.working = clock.run("repair", [&] {
      return surface::make_working_surface(prepared.scan_mm, options.repair, progress);
    });
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}", path.string(), error.what()));
  }
  return prepared;
}

}  // namespace palpate::app
