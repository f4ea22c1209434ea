// SPDX-License-Identifier: GPL-3.0-or-later
// Where a scan ends: the planes of its caps.
#pragma once
#include <cstdint>
#include <vector>

#include "core/head_surface.hpp"

namespace palpate::registration {

struct CutOptions {
  /// [mm^2] smallest cap that counts as the scan's end. A closed eye or mouth is below 10 cm^2, the
  /// neck of a child above 50 cm^2. Smaller: closed eyes become ends of the scan.
  double least_area = 1500;
  /// [degree] and [mm] how far a triangle of a flat face may turn from the face's first one and lie
  /// off its plane. A disc of least_area is 44 mm wide; on the flattest part of a vault (radius
  /// 150 mm) it would bulge by 1.6 mm and turn by 8 degrees.
  double flat_angle = 3.0;
  double flat_height = 0.5;
};

/// One end of the scan. The head lies where normal . p < offset.
struct CutPlane {
  Vec3 normal = Vec3::Zero();  ///< [-] unit, out of the head
  double offset = 0;           ///< [mm] of the innermost point of the cap
  double area_mm2 = 0;
};

struct ScanEnds {
  std::vector<CutPlane> planes;       ///< by falling area
  std::vector<std::uint8_t> cap;      ///< per point: 1 on one of the planes' patches
  std::vector<std::uint8_t> no_scan;  ///< per point: 1 on a cap or where repair closed a hole
};

/// A cap is a connected patch of triangles that repair filled, or of a flat face of a scan that
/// came closed already.
[[nodiscard]] ScanEnds find_scan_ends(const HeadSurface& head, const CutOptions& options = {});

}  // namespace palpate::registration
