// SPDX-License-Identifier: Apache-2.0
// Lays out a GLB: accessors one after the other in one buffer, then the JSON in front.
#pragma once
#include <cstdint>
#include <nlohmann/json.hpp>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/surface_mesh.hpp"

namespace palpate::io {

/// A GLB of a JSON chunk and a binary chunk, whose size is a multiple of 4.
[[nodiscard]] std::string join_glb(const nlohmann::ordered_json& document, std::string_view binary);

/// Three numbers a vector, as add_floats() takes them; one beyond a float's range becomes infinite.
[[nodiscard]] std::vector<float> glb_vectors(const std::vector<Vec3>& vectors);
/// glTF demands unit normals everywhere, also at vertices that no triangle uses: +z there.
[[nodiscard]] std::vector<float> glb_normals(const SurfaceMesh& mesh);
[[nodiscard]] std::vector<std::uint32_t> glb_corners(const SurfaceMesh& mesh);
/// NaN, which glTF forbids, becomes -1.
[[nodiscard]] float glb_or_missing(double value);

class GlbWriter {
 public:
  /// Vertex attribute of `components` floats each; all must be finite.
  /// @param with_bounds  adds min and max, which glTF demands for POSITION
  /// @returns the accessor's index
  std::size_t add_floats(std::span<const float> values, int components, bool with_bounds = false);
  /// Vertex attribute of four normalised bytes each.
  std::size_t add_colours(std::span<const std::uint8_t> rgba);
  std::size_t add_indices(std::span<const std::uint32_t> values);

  /// The file. `document` gets `accessors`, `bufferViews` and `buffers`; keys keep their order.
  /// Equal input gives equal bytes. @throws InputError above 4 GiB, the format's limit
  [[nodiscard]] std::string finish(nlohmann::ordered_json document) const;

 private:
  std::size_t add(const void* data, std::size_t bytes, int target, nlohmann::ordered_json accessor);

  std::string binary_;
  nlohmann::ordered_json accessors_ = nlohmann::ordered_json::array();
  nlohmann::ordered_json views_ = nlohmann::ordered_json::array();
};

}  // namespace palpate::io
