// SPDX-License-Identifier: GPL-3.0-or-later
#include "fem/published.hpp"

#include <fmt/format.h>

#include "core/error.hpp"
#include "fem/loads.hpp"

namespace palpate::fem {

std::vector<PublishedSample> press_published(const Topology& topology,
                                             const std::vector<Vec3>& nodes,
                                             std::span<const std::uint8_t> is_bone,
                                             std::int32_t node, const Vec3& push,
                                             std::span<const double> forces, Cholesky& cholesky,
                                             const PublishedRecipe& recipe) {
  if (topology.order != ElementOrder::linear)
    throw InputError("the published recipe uses linear tetrahedra");
  const std::vector<NodalLoad> load = nodal_force(node, push);
  const Eigen::VectorXd unit = load_vector(topology, load);
  if (topology.free_node[node] < 0)
    throw InputError(fmt::format("node {} is held; it cannot be pushed", node));

  const auto law = [&](double e, double nu) -> std::shared_ptr<const EnergyDensity> {
    return st_venant_kirchhoff(lame_moduli(e, nu), recipe.compression_resistance);
  };
  const TissueLaws laws({law(recipe.flesh_youngs_modulus, recipe.flesh_poissons_ratio),
                         law(recipe.bone_youngs_modulus, recipe.bone_poissons_ratio)},
                        std::vector<std::int32_t>(is_bone.begin(), is_bone.end()));
  const ElasticBody body(topology, nodes, laws);
  std::vector<double> density(topology.tets.size() / 4, recipe.flesh_density);
  for (std::size_t t = 0; t < is_bone.size(); ++t)
    if (is_bone[t]) density[t] = recipe.bone_density;
  const std::vector<double> mass = consistent_mass(topology, nodes, density);

  std::vector<PublishedSample> samples;
  const Vec3 axis = push.normalized();
  for (const double force : forces) {
    const RestState rest = step_to_rest(body, mass, force * unit, cholesky, recipe.dynamics);
    samples.push_back({body.displacement(rest.x, node).dot(axis), rest.at_rest,
                       body.inverted_tets(rest.x), rest.steps});
  }
  return samples;
}

}  // namespace palpate::fem
