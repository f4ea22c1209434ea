// SPDX-License-Identifier: GPL-3.0-or-later
#include "image/filters.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::image {
namespace {

/// Weights of a sampled Gaussian out to three deviations, sum 1.
std::vector<float> gaussian(double sigma_voxels) {
  const int reach = std::max(1, static_cast<int>(std::ceil(3 * sigma_voxels)));
  std::vector<float> w;
  double sum = 0;
  for (int i = -reach; i <= reach; ++i) {
    w.push_back(static_cast<float>(std::exp(-0.5 * i * i / (sigma_voxels * sigma_voxels))));
    sum += w.back();
  }
  for (float& x : w) x = static_cast<float>(x / sum);
  return w;
}

}  // namespace

void smooth(Volume& v, double sigma) {
  if (!(sigma > 0)) return;
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<float> weight = gaussian(sigma / v.spacing(axis));
    const int reach = static_cast<int>(weight.size()) / 2, n = v.size[axis];
    const std::size_t stride = axis == 0 ? 1 : axis == 1 ? v.size[0] : v.index(0, 0, 1);
    std::vector<float> line(n);
    const int a = axis == 0 ? 1 : 0, b = axis == 2 ? 1 : 2;
    for (int q = 0; q < v.size[b]; ++q)
      for (int p = 0; p < v.size[a]; ++p) {
        std::array<int, 3> at{};
        at[a] = p, at[b] = q;
        float* first = v.value.data() + v.index(at[0], at[1], at[2]);
        for (int i = 0; i < n; ++i) line[i] = first[i * stride];
        for (int i = 0; i < n; ++i) {
          float sum = 0;
          for (int d = -reach; d <= reach; ++d)
            sum += weight[d + reach] * line[std::clamp(i + d, 0, n - 1)];
          first[i * stride] = sum;
        }
      }
  }
}

Volume coarsened(const Volume& v, double edge) {
  std::array<int, 3> every{};
  Volume out;
  out.format = v.format;
  out.warnings = v.warnings;
  out.origin = v.origin;
  for (int a = 0; a < 3; ++a) {
    every[a] = std::clamp(static_cast<int>(edge / v.spacing(a) + 1e-6), 1, v.size[a] / 2);
    out.size[a] = (v.size[a] - 1) / every[a] + 1;
    out.step.col(a) = v.step.col(a) * every[a];
  }
  out.value.reserve(out.index(0, 0, out.size[2]));
  for (int k = 0; k < out.size[2]; ++k)
    for (int j = 0; j < out.size[1]; ++j)
      for (int i = 0; i < out.size[0]; ++i)
        out.value.push_back(v.at(i * every[0], j * every[1], k * every[2]));
  return out;
}

Volume padded(const Volume& v, float value) {
  Volume out = v;
  for (int a = 0; a < 3; ++a) out.size[a] += 2;
  out.origin = v.place({-1, -1, -1});
  out.value.assign(out.index(0, 0, out.size[2]), value);
  for (int k = 0; k < v.size[2]; ++k)
    for (int j = 0; j < v.size[1]; ++j)
      std::copy_n(v.value.begin() + static_cast<std::ptrdiff_t>(v.index(0, j, k)), v.size[0],
                  out.value.begin() + static_cast<std::ptrdiff_t>(out.index(1, j + 1, k + 1)));
  return out;
}

Components components(const Volume& grid, const std::vector<std::uint8_t>& mask) {
  Components c{std::vector<std::int32_t>(mask.size(), 0), {}, {}};
  const std::array<std::size_t, 3> stride = {1, grid.index(0, 1, 0), grid.index(0, 0, 1)};
  std::vector<std::size_t> queue;
  for (std::size_t seed = 0; seed < mask.size(); ++seed) {
    if (!mask[seed] || c.of[seed]) continue;
    c.size.push_back(0);
    c.at_edge.push_back(0);
    const auto number = static_cast<std::int32_t>(c.size.size());
    c.of[seed] = number;
    queue.push_back(seed);
    while (!queue.empty()) {
      const std::size_t now = queue.back();
      queue.pop_back();
      ++c.size.back();
      for (int a = 0; a < 3; ++a) {
        const auto at = static_cast<int>(now / stride[a] % static_cast<std::size_t>(grid.size[a]));
        for (const int way : {-1, 1}) {
          if (at + way < 0 || at + way >= grid.size[a]) {
            c.at_edge.back() = 1;
            continue;
          }
          const std::size_t next = way < 0 ? now - stride[a] : now + stride[a];
          if (!mask[next] || c.of[next]) continue;
          c.of[next] = number;
          queue.push_back(next);
        }
      }
    }
  }
  return c;
}

}  // namespace palpate::image
