// SPDX-License-Identifier: GPL-3.0-or-later
// The stages in the order in which a head travels. Composition only: every step is a library's.
#pragma once
#include <chrono>
#include <filesystem>
#include <map>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "core/progress.hpp"
#include "core/tissue_mesh.hpp"
#include "core/touchable_head.hpp"
#include "image/head_image.hpp"
#include "io/scan.hpp"
#include "landmarks/detect.hpp"
#include "skull/fit.hpp"
#include "stiffness/sweep.hpp"
#include "stiffness/uncertainty.hpp"
#include "surface/repair.hpp"
#include "tetmesh/tissue.hpp"

namespace palpate::app {

/// Everything a user may set; one struct, so that all of it can be recorded.
struct PipelineOptions {
  std::string unit;  ///< "" = guess
  surface::RepairOptions repair;
  landmarks::DetectOptions landmarks;  ///< `given` in the scan's own coordinates
  skull::FitOptions fit;
  tetmesh::TissueOptions tissue;
  stiffness::SweepOptions sweep;
  stiffness::SpreadOptions spread;
  std::filesystem::path skull_template;  ///< "" = bundled
  std::filesystem::path depth_table;     ///< "" = bundled
  std::filesystem::path ct;              ///< a CT volume instead of a scan; "" = none
  std::filesystem::path labels;          ///< a label volume instead of a scan; "" = none
  image::ImageOptions image;             ///< how surfaces are taken from these
  std::filesystem::path own_skull;       ///< a lab's own skull instead of a fit: scan frame, [mm]
};

/// Wall time of each stage, [s].
class StageClock {
 public:
  explicit StageClock(const Progress& progress) : progress_(progress) {}
  /// Runs `work` as stage `name`.
  template <class Work>
  auto run(const std::string& name, Work&& work) {
    progress_.step(name, 0);
    const auto start = std::chrono::steady_clock::now();
    auto result = work();
    seconds_[name] =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    progress_.step(name, 1);
    return result;
  }
  [[nodiscard]] const std::map<std::string, double>& seconds() const { return seconds_; }

 private:
  const Progress& progress_;
  std::map<std::string, double> seconds_;
};

/// A scan made ready: read, scaled to mm, repaired.
struct PreparedScan {
  io::Scan scan;
  std::string file_name;
  LengthUnit unit = LengthUnit::mm;
  bool unit_certain = true;
  std::optional<LengthUnit> other_unit;    ///< next best guess; none where the unit was given
  SurfaceMesh scan_mm;                     ///< the user's vertices, [mm]
  surface::WorkingSurface working;         ///< scan frame, [mm]
  std::optional<SurfaceMesh> known_skull;  ///< scan frame, [mm]: from an image
  std::vector<std::string> image_notes;    ///< how the surfaces were taken from the image
};
[[nodiscard]] PreparedScan prepare_scan(const std::filesystem::path& path,
                                        const PipelineOptions& options, const Progress& progress,
                                        StageClock& clock);

/// The same from `options.ct` or `options.labels`, whose skull comes along.
[[nodiscard]] PreparedScan prepare_image(const PipelineOptions& options, const Progress& progress,
                                         StageClock& clock);

/// A head with its face found.
struct LocatedHead {
  landmarks::Detection detection;          ///< scan frame, [mm]
  HeadSurface head;                        ///< head frame, [mm]
  std::vector<Vec3> points;                ///< the user's vertices, head frame [mm]
  std::vector<Vec3> normals;               ///< outward, [-]
  std::vector<SkinRegion> region;          ///< of the user's vertices
  std::optional<SurfaceMesh> known_skull;  ///< head frame, [mm]
};
/// @param scan  where no face is found and the unit was guessed, it is made ready again in the next
///              best unit
[[nodiscard]] LocatedHead locate_head(PreparedScan& scan, const PipelineOptions& options,
                                      const Progress& progress, StageClock& clock);

/// The fitted skull, or the user's own one; head frame.
[[nodiscard]] SkullFit make_skull(const LocatedHead& located, const PipelineOptions& options,
                                  const Progress& progress, StageClock& clock);
/// Swept on the user's vertices; in fast mode, where these are many more than the working skin's
/// points, on those and carried over.
struct MappedHead {
  StiffnessMap map;
  MapSpread spread;
  stiffness::Sweep sweep;
};
[[nodiscard]] MappedHead make_map(const LocatedHead& located, const SkullFit& skull,
                                  const PipelineOptions& options, const Progress& progress,
                                  StageClock& clock);

/// Gathers the product and its provenance.
[[nodiscard]] TouchableHead assemble(const PreparedScan& scan, const LocatedHead& located,
                                     const SkullFit& skull, const MappedHead& mapped,
                                     const std::optional<TissueMesh>& tissue,
                                     const PipelineOptions& options,
                                     const std::vector<std::string>& warnings);

[[nodiscard]] SkullTemplate load_template(const PipelineOptions& options);
[[nodiscard]] std::vector<TissueDepth> load_depths(const PipelineOptions& options);

}  // namespace palpate::app
