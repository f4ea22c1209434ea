// SPDX-License-Identifier: GPL-3.0-or-later
// What the flesh is made of: one modulus everywhere, one by facial region, or layers of the depth.
// Which of them is the default, and why: docs/decisions/0005-tissue-model.md.
#pragma once
#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "core/head_surface.hpp"
#include "fem/elastic_body.hpp"
#include "stiffness/patch.hpp"

namespace palpate::stiffness {

enum class TissueKind { uniform, regional, layered };
enum class TissueLaw { neo_hookean, mooney_rivlin };

/// One sheet of the flesh, from the skin down.
struct TissueLayer {
  std::string name;
  double share = 1;           ///< [-] of the local depth; all layers sum to 1
  double youngs_modulus = 0;  ///< [MPa] > 0
  double poissons_ratio = 0.43;
  TissueLaw law = TissueLaw::neo_hookean;
};
struct TissueModel {
  std::string name = "published";
  std::string source = "Human Head Stiffness Rendering, University of Ottawa 2015, Table 4.2";
  TissueKind kind = TissueKind::uniform;
  double youngs_modulus = 0.045658;        ///< [MPa] uniform; and where a region has no figure; > 0
  double poissons_ratio = 0.43;            ///< [-] 0 <= nu < 0.5; uniform and regional
  TissueLaw law = TissueLaw::neo_hookean;  ///< uniform and regional
  /// [MPa] by skin region; 0: `youngs_modulus`. Regional only.
  std::array<double, kSkinRegionNames.size()> by_region{};
  double blend = 12;  ///< [mm] the field is averaged over the skin within this distance; > 0
  std::vector<TissueLayer> layers;  ///< from the skin down; layered only
};
/// @throws InputError names the model and the first key that cannot be
void check(const TissueModel& model);

/// The model laid over one head.
class Flesh {
 public:
  /// @param model  checked; copied
  Flesh(const TissueModel& model, const HeadSurface& head);

  /// Whether every law runs in the single-precision batch.
  [[nodiscard]] bool neo_hookean_only() const;
  /// Depth fractions of the template's levels, 0 to 1, so that element layers end where tissue
  /// layers do; empty: free to grade. `layers` are those of the template.
  [[nodiscard]] std::vector<double> levels(int layers) const;
  /// Element layers of a template that wants two, or three for tissue that is thick for the tool.
  [[nodiscard]] int element_layers(int wanted) const;

  /// Small-strain moduli of a patch: one for all tetrahedra, or one each.
  [[nodiscard]] std::vector<fem::LameModuli> moduli(const PatchTemplate& t,
                                                    const PatchGeometry& g) const;
  /// The laws of a patch, likewise.
  [[nodiscard]] fem::TissueLaws laws(const PatchTemplate& t, const PatchGeometry& g) const;
  /// One law for the whole depth at a spot of the skin, for pieces without layers of their own: a
  /// layered tissue counts as its layers in series.
  [[nodiscard]] std::shared_ptr<const fem::EnergyDensity> law_at(const SkinSpot& spot) const;
  /// [MPa] of what lies right under the skin at the patch's middle: scales the contact's penalty.
  [[nodiscard]] double surface_modulus(const PatchGeometry& g) const;

 private:
  [[nodiscard]] double modulus_at(const SkinSpot& spot) const;
  [[nodiscard]] int tissue_layer(int element_layer, int layers) const;

  TissueModel model_;
  std::vector<Triangle> triangles_;  // regional: of the working skin
  std::vector<double> log_modulus_;  // regional: per point of the working skin, ln MPa
};

}  // namespace palpate::stiffness
