// SPDX-License-Identifier: GPL-3.0-or-later
#include "stiffness/tissue_model.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numeric>

#include "stiffness/site_features.hpp"

namespace palpate::stiffness {
namespace {

constexpr double kMostShareError = 1e-6;  // [-] the shares of the layers sum to 1 within this

void check_elastic(const std::string& where, double youngs_modulus, double poissons_ratio) {
  if (!(youngs_modulus > 0) || !std::isfinite(youngs_modulus))
    throw InputError(
        fmt::format("{}: youngs_modulus_kpa is {}; it must be > 0", where, youngs_modulus * 1e3));
  if (!(poissons_ratio >= 0 && poissons_ratio < 0.5))
    throw InputError(
        fmt::format("{}: poissons_ratio is {}; it must be in [0, 0.5)", where, poissons_ratio));
}

std::shared_ptr<const fem::EnergyDensity> law_of(TissueLaw law, const fem::LameModuli& moduli) {
  if (law == TissueLaw::mooney_rivlin) return fem::mooney_rivlin(fem::mooney_rivlin_from(moduli));
  return fem::neo_hookean(moduli);
}

}  // namespace

void check(const TissueModel& m) {
  const std::string where = fmt::format("tissue model '{}'", m.name);
  if (m.kind != TissueKind::layered) check_elastic(where, m.youngs_modulus, m.poissons_ratio);
  if (m.kind == TissueKind::regional) {
    for (std::size_t r = 0; r < m.by_region.size(); ++r)
      if (m.by_region[r] != 0)
        check_elastic(fmt::format("{}, region {}", where, kSkinRegionNames[r]), m.by_region[r],
                      m.poissons_ratio);
    if (!(m.blend > 0)) throw InputError(fmt::format("{}: blend_mm must be > 0", where));
  }
  if (m.kind != TissueKind::layered) return;
  if (m.layers.empty()) throw InputError(fmt::format("{}: has no [[layer]]", where));
  double sum = 0;
  for (const TissueLayer& l : m.layers) {
    const std::string layer = fmt::format("{}, layer '{}'", where, l.name);
    check_elastic(layer, l.youngs_modulus, l.poissons_ratio);
    if (!(l.share > 0)) throw InputError(fmt::format("{}: share_of_depth must be > 0", layer));
    sum += l.share;
  }
  if (std::abs(sum - 1) > kMostShareError)
    throw InputError(fmt::format("{}: share_of_depth sums to {}, not 1", where, sum));
}

Flesh::Flesh(const TissueModel& model, const HeadSurface& head) : model_(model) {
  if (model_.kind != TissueKind::regional) return;
  triangles_ = head.skin.triangles;
  std::vector<double> raw;
  for (const SkinRegion r : head.region) {
    const double own = model_.by_region[static_cast<std::size_t>(r)];
    raw.push_back(std::log(own > 0 ? own : model_.youngs_modulus));
  }
  log_modulus_ = smoothed_over_skin(head.skin, raw, model_.blend);
}

bool Flesh::neo_hookean_only() const {
  if (model_.kind != TissueKind::layered) return model_.law == TissueLaw::neo_hookean;
  for (const TissueLayer& l : model_.layers)
    if (l.law != TissueLaw::neo_hookean) return false;
  return true;
}

int Flesh::element_layers(int wanted) const {
  if (model_.kind != TissueKind::layered) return wanted;
  // Two element layers at least; one more, in the thickest sheet, where tissue is thick.
  const int sheets = static_cast<int>(model_.layers.size());
  return std::max(sheets, 2) + (wanted > 2 ? 1 : 0);
}

int Flesh::tissue_layer(int element_layer, int layers) const {
  const std::vector<double> fractions = levels(layers);
  const double middle = 0.5 * (fractions[element_layer] + fractions[element_layer + 1]);
  double bottom = 0;
  for (std::size_t l = 0; l < model_.layers.size(); ++l)
    if (middle < (bottom += model_.layers[l].share)) return static_cast<int>(l);
  return static_cast<int>(model_.layers.size()) - 1;
}

std::vector<double> Flesh::levels(int layers) const {
  if (model_.kind != TissueKind::layered) return {};
  std::vector<double> out = {0};
  for (const TissueLayer& l : model_.layers) out.push_back(out.back() + l.share);
  out.back() = 1;
  while (static_cast<int>(out.size()) < layers + 1) {  // split the thickest until there are enough
    std::size_t widest = 1;
    for (std::size_t i = 2; i < out.size(); ++i)
      if (out[i] - out[i - 1] > out[widest] - out[widest - 1] + 1e-9) widest = i;
    out.insert(out.begin() + static_cast<std::ptrdiff_t>(widest),
               0.5 * (out[widest - 1] + out[widest]));
  }
  return out;
}

double Flesh::modulus_at(const SkinSpot& spot) const {
  if (spot.triangle < 0) return model_.youngs_modulus;
  double log_sum = 0;
  for (int i = 0; i < 3; ++i)
    log_sum += spot.barycentric[i] * log_modulus_[triangles_[spot.triangle][i]];
  return std::exp(log_sum);
}

std::shared_ptr<const fem::EnergyDensity> Flesh::law_at(const SkinSpot& spot) const {
  if (model_.kind != TissueKind::layered) {
    const double e = model_.kind == TissueKind::regional ? modulus_at(spot) : model_.youngs_modulus;
    return law_of(model_.law, fem::lame_moduli(e, model_.poissons_ratio));
  }
  double compliance = 0, nu = 0;
  for (const TissueLayer& l : model_.layers) {
    compliance += l.share / l.youngs_modulus;
    nu += l.share * l.poissons_ratio;
  }
  return law_of(model_.layers.front().law, fem::lame_moduli(1 / compliance, nu));
}

double Flesh::surface_modulus(const PatchGeometry& g) const {
  if (model_.kind == TissueKind::layered) return model_.layers.front().youngs_modulus;
  return model_.kind == TissueKind::regional ? modulus_at(g.spot[0]) : model_.youngs_modulus;
}

std::vector<fem::LameModuli> Flesh::moduli(const PatchTemplate& t, const PatchGeometry& g) const {
  if (model_.kind == TissueKind::uniform)
    return {fem::lame_moduli(model_.youngs_modulus, model_.poissons_ratio)};
  const int layers = t.rule.layers, stride = fem::tet_nodes(t.topology.order);
  const int tets = static_cast<int>(t.topology.tets.size()) / stride;
  std::vector<fem::LameModuli> out;
  if (model_.kind == TissueKind::layered) {
    std::vector<fem::LameModuli> of_layer;
    for (int e = 0; e < layers; ++e) {
      const TissueLayer& l = model_.layers[tissue_layer(e, layers)];
      of_layer.push_back(fem::lame_moduli(l.youngs_modulus, l.poissons_ratio));
    }
    for (int tet = 0; tet < tets; ++tet) out.push_back(of_layer[t.element_layer(tet)]);
    return out;
  }
  std::vector<double> column;
  for (const SkinSpot& spot : g.spot) column.push_back(std::log(modulus_at(spot)));
  for (int tet = 0; tet < tets; ++tet) {
    double mean = 0;
    for (int i = 0; i < 4; ++i)
      mean += 0.25 * column[t.topology.tets[tet * stride + i] / (layers + 1)];
    out.push_back(fem::lame_moduli(std::exp(mean), model_.poissons_ratio));
  }
  return out;
}

fem::TissueLaws Flesh::laws(const PatchTemplate& t, const PatchGeometry& g) const {
  std::vector<std::shared_ptr<const fem::EnergyDensity>> laws;
  std::vector<std::int32_t> of_tet;
  const int tets = static_cast<int>(t.topology.tets.size()) / fem::tet_nodes(t.topology.order);
  if (model_.kind == TissueKind::layered) {
    for (int e = 0; e < t.rule.layers; ++e) {
      const TissueLayer& l = model_.layers[tissue_layer(e, t.rule.layers)];
      laws.push_back(law_of(l.law, fem::lame_moduli(l.youngs_modulus, l.poissons_ratio)));
    }
    for (int tet = 0; tet < tets; ++tet) of_tet.push_back(t.element_layer(tet));
    return {std::move(laws), std::move(of_tet)};
  }
  for (const fem::LameModuli& m : moduli(t, g)) laws.push_back(law_of(model_.law, m));
  if (laws.size() > 1)
    for (int tet = 0; tet < tets; ++tet) of_tet.push_back(tet);
  return {std::move(laws), std::move(of_tet)};
}

}  // namespace palpate::stiffness
