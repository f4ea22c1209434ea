// SPDX-License-Identifier: GPL-3.0-or-later
// What all sites of one head share.
#pragma once
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>
#include <atomic>

#include "stiffness/carriers.hpp"
#include "stiffness/checkpoint.hpp"
#include "stiffness/site_features.hpp"
#include "stiffness/sweep.hpp"

namespace palpate::stiffness {

/// A place that can be pressed. Coinciding vertices share one.
struct Spot {
  SiteFrame frame;
  SkinRegion region = SkinRegion::other;
  VertexStatus status = VertexStatus::no_bone;  ///< `blended` where there is tissue to press
  double depth = 0;                             ///< [mm] to what carries it; NaN where nothing
  double organ = 0;                             ///< [-] Carriers::organ_share
  Eigen::VectorXd shape;                        ///< SiteFeatures::shape; empty without tissue
};

struct Ground {
  const HeadSurface& head;
  const SweepOptions& options;
  surface::SurfaceQuery skin;
  Carriers carriers;
  SamplingLimits limits;
  Flesh flesh;
  std::vector<double> forces;         ///< [N] ascending
  std::vector<Spot> spots;            ///< in the order of first appearance
  std::vector<std::int32_t> spot_of;  ///< per point asked for

  /// Step 1 of the sweep: looks around every point.
  Ground(const HeadSurface& head, const SkullFit& skull, const SkinPoints& points,
         const SweepOptions& options, const Progress& progress);
  /// Of everything that a curve depends on.
  [[nodiscard]] std::uint64_t fingerprint() const;
};

/// Runs body(i) for i in [0, n) on the asked number of threads; tells `progress` fractions between
/// `from` and `to`. Exceptions of the body and of the progress come out here.
template <class Body>
void parallel(int n, const SweepOptions& options, const Progress& progress, double from, double to,
              const Body& body) {
  tbb::task_arena arena(options.threads > 0 ? options.threads : tbb::task_arena::automatic);
  std::atomic<int> done = 0;
  const int report_each = std::max(1, n / 200);
  arena.execute([&] {
    tbb::parallel_for(tbb::blocked_range<int>(0, n, 1), [&](const tbb::blocked_range<int>& range) {
      for (int i = range.begin(); i != range.end(); ++i) {
        body(i);
        const int now = ++done;
        if (now % report_each == 0) progress.step("sweep", from + (to - from) * now / n);
      }
    });
  });
}

}  // namespace palpate::stiffness
