// SPDX-License-Identifier: GPL-3.0-or-later
// A scan of a face alone becomes a whole head (docs/method/landmarks.md).
#pragma once
#include <cstdint>
#include <vector>

#include "landmarks/detect.hpp"

namespace palpate::landmarks {

struct FoundFace {
  Detection detection;
  bool alone = false;  ///< no back of the head: complete_face makes one
};
/// As detect_landmarks, but a whole face, chin included, with no head behind it is not refused.
[[nodiscard]] FoundFace find_face(const SurfaceMesh& skin, const DetectOptions& options = {},
                                  const Progress& progress = {});

/// The points that every detection answers: nose tip, nose corners and eye corners.
[[nodiscard]] bool always_answered(const std::string& name);

struct CompletedFace {
  SurfaceMesh skin;                  ///< [mm] closed, in the scan's frame
  std::vector<std::uint8_t> filled;  ///< one per point: 0 scanned, 1 repair had closed a hole, 2
                                     ///< taken from the whole head
  double completed_share = 0;        ///< [-] of the skin's area
};

/// The whole head is bent to the face: the statistical face fitted to both says how their heads
/// differ, and what remains at the face decays away from it. Its part beyond the scan's border is
/// then joined to the scan.
/// @param face        closed working surface of the scan, [mm]
/// @param filled      one per point of `face`: 1 where repair closed a hole
/// @param found       of `face`
/// @param whole_head  [mm] a scan in any pose, closed or not
/// @param edge        [mm] of the result, as of `face`
/// @throws InputError `whole_head` has no face, or the two do not close into one surface
/// @note Deterministic; same bits for any thread count.
[[nodiscard]] CompletedFace complete_face(const SurfaceMesh& face,
                                          const std::vector<std::uint8_t>& filled,
                                          const Detection& found, const SurfaceMesh& whole_head,
                                          double edge, const Progress& progress = {});

/// Leaves out the optional points that lie on completed skin: nobody has seen them.
void drop_unseen(LandmarkSet& landmarks, const CompletedFace& head);

}  // namespace palpate::landmarks
