// SPDX-License-Identifier: Apache-2.0
// The triangles of a glTF scene: nodes in depth-first order, their transforms applied. Primitives
// of one node that share a POSITION accessor share its points. Of a touchable head only the scan
// that it was made from: its skin's mesh in the scan's own numbers.
#include <fmt/format.h>

#include <array>
#include <map>
#include <utility>

#include "io/gltf_document.hpp"
#include "io/head_file.hpp"
#include "io/mesh_builder.hpp"
#include "io/readers.hpp"

namespace palpate::io {
namespace {

using nlohmann::json;
using Transform = Eigen::Affine3d;

class SceneReader {
 public:
  explicit SceneReader(const GltfDocument& document)
      : document_(document), out_(document.source()) {}

  SurfaceMesh read() {
    const json& root = document_.root();
    if (const auto nodes = root.find("nodes"); nodes != root.end() && nodes->is_array())
      seen_.assign(nodes->size(), false);
    for (const std::uint64_t node : root_nodes()) pending_.push_back({node, Transform::Identity()});
    if (seen_.empty() && root.contains("meshes"))
      for (std::size_t m = 0; m < root["meshes"].size(); ++m) read_mesh(m, Transform::Identity());
    while (!pending_.empty()) visit();
    out_.finish("primitive");
    return std::move(out_.mesh);
  }
  /// One mesh as it is stored.
  SurfaceMesh read_alone(std::uint64_t mesh) {
    read_mesh(mesh, Transform::Identity());
    out_.finish("primitive");
    return std::move(out_.mesh);
  }

 private:
  /// Of the default scene, else of the first, else all nodes that are nobody's child; last first,
  /// because the stack turns them round.
  std::vector<std::uint64_t> root_nodes() const {
    const json& root = document_.root();
    std::vector<std::uint64_t> nodes;
    if (root.contains("scenes")) {
      const std::uint64_t index = document_.integer(root, "scene", "JSON", 0);
      nodes = indices(document_.entry("scenes", index), "nodes", fmt::format("scenes[{}]", index));
    } else {
      std::vector<bool> child(seen_.size(), false);
      for (std::size_t n = 0; n < seen_.size(); ++n)
        for (const std::uint64_t c : indices(document_.entry("nodes", n), "children", "nodes"))
          if (c < child.size()) child[c] = true;
      for (std::size_t n = 0; n < seen_.size(); ++n)
        if (!child[n]) nodes.push_back(n);
    }
    return {nodes.rbegin(), nodes.rend()};
  }

  std::vector<std::uint64_t> indices(const json& object, const char* key,
                                     const std::string& where) const {
    std::vector<std::uint64_t> out;
    const auto list = object.find(key);
    if (list == object.end()) return out;
    if (!list->is_array()) document_.fail(where, fmt::format("'{}' is not an array", key));
    for (const json& i : *list) {
      if (!i.is_number_unsigned()) document_.fail(where, fmt::format("'{}' holds no index", key));
      out.push_back(i.get<std::uint64_t>());
    }
    return out;
  }

  void visit() {
    const auto [index, parent] = pending_.back();
    pending_.pop_back();
    const std::string where = fmt::format("nodes[{}]", index);
    const json& node = document_.entry("nodes", index);
    if (seen_[index]) document_.fail(where, "is the child of two nodes");
    seen_[index] = true;
    const Transform transform = parent * local_transform(node, where);
    if (node.contains("mesh")) read_mesh(document_.integer(node, "mesh", where), transform);
    const std::vector<std::uint64_t> children = indices(node, "children", where);
    for (auto child = children.rbegin(); child != children.rend(); ++child)
      pending_.push_back({*child, transform});
  }

  template <std::size_t N>
  bool numbers(const json& node, const char* key, const std::string& where,
               std::array<double, N>& out) const {
    const auto list = node.find(key);
    if (list == node.end()) return false;
    if (!list->is_array() || list->size() != N)
      document_.fail(where, fmt::format("'{}' has not {} numbers", key, N));
    for (std::size_t i = 0; i < N; ++i) {
      if (!(*list)[i].is_number()) document_.fail(where, fmt::format("'{}' is not numeric", key));
      out[i] = (*list)[i].template get<double>();
    }
    return true;
  }

  Transform local_transform(const json& node, const std::string& where) const {
    Transform transform = Transform::Identity();
    if (std::array<double, 16> m; numbers(node, "matrix", where, m)) {
      transform.matrix() = Eigen::Map<const Eigen::Matrix4d>(m.data());
      if (m[3] != 0 || m[7] != 0 || m[11] != 0 || m[15] != 1)
        document_.fail(where, "its matrix is not affine");
      return transform;
    }
    std::array<double, 3> t{}, s{};
    std::array<double, 4> r{};
    if (numbers(node, "translation", where, t)) transform.translate(Vec3(t[0], t[1], t[2]));
    if (numbers(node, "rotation", where, r))
      transform.rotate(Eigen::Quaterniond(r[3], r[0], r[1], r[2]).normalized());
    if (numbers(node, "scale", where, s)) transform.scale(Vec3(s[0], s[1], s[2]));
    return transform;
  }

  void read_mesh(std::uint64_t index, const Transform& transform) {
    const std::string where = fmt::format("meshes[{}]", index);
    const json& mesh = document_.entry("meshes", index);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array())
      document_.fail(where, "has no primitives");
    first_point_.clear();
    for (std::size_t p = 0; p < primitives->size(); ++p)
      read_primitive((*primitives)[p], fmt::format("meshes[{}].primitives[{}]", index, p),
                     transform);
  }

  void read_primitive(const json& primitive, const std::string& where, const Transform& transform) {
    if (!primitive.is_object()) document_.fail(where, "is not an object");
    const std::uint64_t mode = document_.integer(primitive, "mode", where, 4);
    if (mode < 4) return;  // points and lines
    if (mode > 6) document_.fail(where, fmt::format("mode {} is not known", mode));
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      document_.fail(where, "has no attributes");
    const std::uint64_t position = document_.integer(*attributes, "POSITION", where);
    const auto [first, count] = read_points(position, where, transform);

    GltfAccessor index;
    if (primitive.contains("indices")) {
      index = document_.accessor(document_.integer(primitive, "indices", where));
      const bool whole = index.type == ScalarType::u8 || index.type == ScalarType::u16 ||
                         index.type == ScalarType::u32;
      if (index.components != 1 || !whole || index.normalized)
        document_.fail(where, "its indices are not unsigned integers");
    }
    const std::size_t n = index.data ? index.count : count;
    const auto corner = [&](std::size_t i) {
      const auto c = index.data ? static_cast<std::uint64_t>(index.value(i, 0)) : i;
      if (c >= count)
        document_.fail(where, fmt::format("index {} refers to vertex {} of {}", i, c, count));
      return static_cast<std::int64_t>(first + c);
    };
    if (n < 3 || (mode == 4 && n % 3 != 0))
      document_.fail(where, fmt::format("{} corners do not make triangles", n));
    const bool mirrored = transform.linear().determinant() < 0;  // glTF: turns the winding round
    const std::size_t triangles = mode == 4 ? n / 3 : n - 2;
    for (std::size_t t = 0; t < triangles; ++t) {
      std::array<std::size_t, 3> at = {3 * t, 3 * t + 1, 3 * t + 2};
      if (mode == 5) at = {t, t + 1 + t % 2, t + 2 - t % 2};
      if (mode == 6) at = {0, t + 1, t + 2};
      if (mirrored) std::swap(at[1], at[2]);
      const std::array<std::int64_t, 3> c = {corner(at[0]), corner(at[1]), corner(at[2])};
      out_.add_polygon(c, [&] { return where; });
    }
  }

  /// First point and number of points of a POSITION accessor, added once per node.
  std::pair<std::size_t, std::size_t> read_points(std::uint64_t accessor, const std::string& where,
                                                  const Transform& transform) {
    const GltfAccessor position = document_.accessor(accessor);
    if (position.components != 3 || (position.type == ScalarType::u32))
      document_.fail(where, "its POSITION is not made of points");
    if (const auto known = first_point_.find(accessor); known != first_point_.end())
      return {known->second, position.count};
    const std::size_t first = out_.mesh.points.size();
    first_point_[accessor] = first;
    out_.announce(first + position.count, 0);
    const bool moved = !transform.matrix().isIdentity(0);
    for (std::size_t i = 0; i < position.count; ++i) {
      const Vec3 p(position.value(i, 0), position.value(i, 1), position.value(i, 2));
      out_.add_point(moved ? Vec3(transform * p) : p,
                     [&] { return fmt::format("{} vertex {}", where, i); });
    }
    return {first, position.count};
  }

  struct Visit {
    std::uint64_t node;
    Transform parent;
  };

  const GltfDocument& document_;
  MeshBuilder out_;
  std::vector<bool> seen_;
  std::vector<Visit> pending_;
  std::map<std::uint64_t, std::size_t> first_point_;
};

/// Node 0 of a touchable head is its skin (docs/formats.md).
ParsedMesh parse_carried(const GltfDocument& document, const json& extension) {
  const auto unit = extension.find("unit_mm");
  if (unit == extension.end() || !unit->is_number() || !(unit->get<double>() > 0))
    document.fail(kHeadExtension, "has no unit_mm");
  ParsedMesh parsed;
  parsed.unit_mm = unit->get<double>();
  const json& skin = document.entry("nodes", 0);
  parsed.mesh = SceneReader(document).read_alone(document.integer(skin, "mesh", "nodes[0]"));
  return parsed;
}

ParsedMesh parse(GltfDocument document) {
  const json& root = document.root();
  if (const auto e = root.find("extensions");
      e != root.end() && e->is_object() && e->contains(kHeadExtension))
    return parse_carried(document, (*e)[kHeadExtension]);
  ParsedMesh parsed;
  parsed.mesh = SceneReader(document).read();
  parsed.external = document.take_files();
  return parsed;
}

}  // namespace

ParsedMesh parse_gltf(const Source& source) {
  return parse(GltfDocument::from_gltf(source));
}
ParsedMesh parse_glb(const Source& source) {
  return parse(GltfDocument::from_glb(source));
}

}  // namespace palpate::io
