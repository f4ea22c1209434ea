// SPDX-License-Identifier: GPL-3.0-or-later
// What the lane kernels read: plain pointers and sizes, because the kernels are compiled once per
// instruction set and must not share inline library code with the rest of the program.
//
// A lane array holds kLanes floats per entry, one per site: entry i of lane l is data[i * kLanes +
// l].
#pragma once
#include <cstdint>

namespace palpate::fem::lanes {

inline constexpr int kLanes = 16;
inline constexpr int kTetNodes = 10, kFaceNodes = 6, kTetPairs = 55, kFacePairs = 21;
/// A straight-sided tetrahedron: four barycentric gradients, the volume, lambda and mu of its
/// tissue.
inline constexpr int kTetGeometry = 15;

/// Columns [first, first + width) of the factor in elimination order, as a dense row-major panel of
/// rows x width entries; its first `width` rows are the diagonal block.
struct Panel {
  std::int32_t first, width, rows;
  std::int32_t row_index;              ///< start in `row_index`
  std::int64_t offset;                 ///< entry of the panel's first element in the factor
  std::int32_t first_update, updates;  ///< in `updates`
};
/// An earlier panel whose rows [from, rows) reach into this one, `columns` of them into its
/// columns.
struct Update {
  std::int32_t panel, from, columns;
  std::int32_t position;  ///< start in `position`: row of this panel for each of those rows
};
/// Where a 3 x 3 block (a, b) goes: entry, stride between its rows, and whether (b, a) is meant.
struct BlockTarget {
  std::int64_t entry;  ///< -1: a held node, nothing to add
  std::int32_t stride;
  std::int32_t transposed;
};

struct PlanView {
  std::int32_t unknowns;  ///< 3 per free node, then the travel
  std::int64_t factor_entries;
  const Panel* panels;
  std::int32_t panel_count;
  std::int32_t contact_panel;  ///< the first one that the contact adds to; all later ones are such
  const Update* updates;
  const std::int32_t* row_index;
  const std::int32_t* position;

  std::int32_t tets;
  const std::int32_t* tet_slot;  ///< tets x 10: first unknown of each node; held: `unknowns`
  const BlockTarget* tet_block;  ///< tets x 55, pairs (a, b) with b <= a
  std::int32_t faces;
  const std::int32_t* face_slot;   ///< faces x 6
  const BlockTarget* face_block;   ///< faces x 21
  const BlockTarget* face_travel;  ///< faces x 6: the travel's row
  std::int64_t travel_entry;       ///< diagonal of the travel
  std::int32_t face_points;
  const float* face_shape;   ///< face_points x 6
  const float* face_weight;  ///< face_points, sum 1
};

/// One batch: all pointers are lane arrays, 64-byte aligned.
struct BatchView {
  const float* tet_geometry;   ///< tets x kTetGeometry
  const float* face_position;  ///< faces x 6 x 3: rest positions [mm], z along the outward axis
  const float* face_area;      ///< faces [mm^2]
  const float* start;          ///< 1: height of the sphere's centre at travel 0 [mm]
  const float* penalty;        ///< 1: pressure per penetration [MPa/mm]
  float radius;
};

/// Results for all lanes at once. `x` and `gradient` have unknowns + 3 entries: the last three
/// stand for every held node (zero in x, ignored in the gradient).
struct Kernels {
  /// gradient: of energy + contact [N]. admissible: 1, or 0 where an element is inverted.
  /// squared_pressure: integral of p^2 over the contact [N^2/mm^2].
  void (*gradient)(const PlanView&, const BatchView&, const float* x, float* gradient,
                   float* admissible, float* squared_pressure);
  /// Tissue's Hessian into the cleared factor; `shift` [-] >= 0 adds shift * mu to the tangent's
  /// diagonal.
  void (*tissue_hessian)(const PlanView&, const BatchView&, const float* x, const float* shift,
                         float* factor);
  /// Adds the contact's Hessian. Where `convex` [N/mm] > 0, without its indefinite part and with
  /// that stiffness on the travel, so that a tool that has lost the skin finds it again.
  void (*contact_hessian)(const PlanView&, const BatchView&, const float* x, const float* convex,
                          float* factor);
  /// Factorises the panels before the contact's in place and takes their products from the
  /// contact's, which then hold what the tissue adds there. inverse_diagonal has `unknowns`
  /// entries; positive: 1, or 0 where a pivot is not.
  void (*factorize_tissue)(const PlanView&, float* factor, float* inverse_diagonal,
                           float* positive);
  /// Factorises the contact's panels in place.
  void (*factorize_contact)(const PlanView&, float* factor, float* inverse_diagonal,
                            float* positive);
  /// In place on the right side.
  void (*solve)(const PlanView&, const float* factor, const float* inverse_diagonal, float* b);
};
extern const Kernels kBaseline, kAvx2, kAvx512;

}  // namespace palpate::fem::lanes
