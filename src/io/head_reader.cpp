// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "io/glb_writer.hpp"
#include "io/gltf_document.hpp"
#include "io/head_file.hpp"

namespace palpate::io {
namespace {

using nlohmann::json;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();

class HeadReader {
 public:
  HeadReader(const GltfDocument& document) : document_(document) {
    const json& root = document.root();
    const json* found = nullptr;
    if (const auto list = root.find("extensions"); list != root.end() && list->is_object())
      if (const auto entry = list->find(kHeadExtension); entry != list->end()) found = &*entry;
    if (!found || !found->is_object())
      document.source().fail(
          "", fmt::format("no {} object: this is not a touchable head", kHeadExtension),
          "make one with `palpate build`");
    extension_ = found;
    if (const auto version = document.integer(*found, "version", kHeadExtension);
        version != kHeadFormatVersion)
      document.source().fail("version", fmt::format("format {} is not read", version),
                             "use the version of palpate that wrote it");
  }

  TouchableHead read() {
    read_scalars();
    read_table();
    const json& skin = primitive(0);
    head_.skin = read_mesh(skin, "skin");
    read_map(skin);
    if (document_.root().at("meshes").size() > 1) {
      const json& skull = primitive(1);
      head_.skull = read_mesh(skull, "skull");
      head_.skull_region =
          codes<SkullRegion>(skull, head_.skull.points.size(), skull_regions_, "_REGION");
      const auto attributes = skull.find("attributes");
      if (attributes != skull.end() && attributes->is_object() && attributes->contains("_DEPTH_SD"))
        head_.skull_spread = values(skull, "_DEPTH_SD", head_.skull.points.size());
    }
    head_.provenance = member(*extension_, "provenance");
    head_.run = member(*extension_, "run");
    return std::move(head_);
  }

 private:
  const json& member(const json& object, const char* key) const {
    if (!object.is_object()) document_.fail(key, "its parent is not an object");
    const auto found = object.find(key);
    if (found == object.end()) document_.fail(kHeadExtension, fmt::format("has no '{}'", key));
    return *found;
  }
  double number(const json& object, const char* key) const {
    const json& value = member(object, key);
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      document_.fail(kHeadExtension, fmt::format("'{}' is not a number", key));
    return value.get<double>();
  }
  double positive(const json& object, const char* key) const {
    const double value = number(object, key);
    if (!(value > 0)) document_.fail(kHeadExtension, fmt::format("'{}' is not positive", key));
    return value;
  }
  std::vector<double> number_list(const json& list, const char* what) const {
    if (!list.is_array()) document_.fail(kHeadExtension, fmt::format("'{}' is no list", what));
    std::vector<double> out;
    for (const json& v : list) {
      if (!v.is_number() || !std::isfinite(v.get<double>()))
        document_.fail(kHeadExtension, fmt::format("'{}' holds something else", what));
      out.push_back(v.get<double>());
    }
    return out;
  }
  Vec3 vector(const json& list, const char* what) const {
    const std::vector<double> v = number_list(list, what);
    if (v.size() != 3) document_.fail(kHeadExtension, fmt::format("'{}' has not 3 numbers", what));
    return {v[0], v[1], v[2]};
  }

  void read_scalars() {
    head_.unit_mm = positive(*extension_, "unit_mm");
    head_.map.tool_radius = positive(*extension_, "tool_radius_mm");
    head_.map.forces = number_list(member(*extension_, "forces_n"), "forces_n");
    const std::vector<double>& f = head_.map.forces;
    constexpr std::size_t kMaxForces = 1000;
    if (f.empty() || f.size() > kMaxForces || !(f.front() > 0) ||
        std::adjacent_find(f.begin(), f.end(), std::greater_equal<>()) != f.end())
      document_.fail(kHeadExtension, "'forces_n' does not ascend from above 0");
    // The codes below are indices into these lists; another order would be another meaning.
    statuses_ = check_names("status_names", kVertexStatusNames);
    regions_ = check_names("skin_region_names", kSkinRegionNames);
    skull_regions_ = check_names("skull_region_names", kSkullRegionNames);
    const json& frame = member(*extension_, "frame");
    const json& rows = member(frame, "rotation");
    if (!rows.is_array() || rows.size() != 3) document_.fail("frame", "has no 3 x 3 rotation");
    for (int r = 0; r < 3; ++r) head_.frame.rotation.row(r) = vector(rows[r], "rotation");
    const Mat3& m = head_.frame.rotation;
    if (!(m * m.transpose()).isIdentity(1e-6) || m.determinant() < 0)
      document_.fail("frame", "its rotation is not a rotation");
    head_.frame.origin = vector(member(frame, "origin_mm"), "origin_mm");
  }

  /// Returns how many names the file knows: the files of earlier versions lack the last ones.
  template <typename Names>
  std::size_t check_names(const char* key, const Names& names) const {
    const json& list = member(*extension_, key);
    if (!list.is_array() || list.empty() || list.size() > names.size() ||
        !std::equal(list.begin(), list.end(), names.begin(), [](const json& a, std::string_view b) {
          return a.is_string() && a.get_ref<const std::string&>() == b;
        }))
      document_.fail(kHeadExtension, fmt::format("'{}' are not the names of this version", key));
    return list.size();
  }

  void read_table() {
    const json& marks = member(*extension_, "landmarks");
    if (!marks.is_object()) document_.fail("landmarks", "is not an object");
    for (const auto& item : marks.items())
      head_.landmarks[item.key()] = {vector(member(item.value(), "position_mm"), "position_mm"),
                                     number(item.value(), "confidence")};
    const json& rows = member(*extension_, "depths");
    if (!rows.is_array()) document_.fail("depths", "is not a list");
    for (const json& row : rows) {
      DepthRow d;
      const json& code = member(row, "code");
      const json& reached = member(row, "reached");
      if (!code.is_string() || !reached.is_boolean()) document_.fail("depths", "a row is damaged");
      d.code = code.get<std::string>();
      d.reached = reached.get<bool>();
      d.published_mm = number(row, "published_mm");
      d.sd_mm = number(row, "sd_mm");
      d.depth_mm = member(row, "depth_mm").is_null() ? kNaN : number(row, "depth_mm");
      head_.depths.push_back(std::move(d));
    }
  }

  const json& primitive(std::size_t mesh) const {
    const json& entry = document_.entry("meshes", mesh);
    const auto list = entry.find("primitives");
    if (list == entry.end() || !list->is_array() || list->size() != 1 || !(*list)[0].is_object())
      document_.fail(fmt::format("meshes[{}]", mesh), "has not one primitive");
    return (*list)[0];
  }

  GltfAccessor attribute(const json& primitive, const std::string& name, int components,
                         std::size_t count) const {
    const auto attributes = primitive.find("attributes");
    if (attributes == primitive.end() || !attributes->is_object())
      document_.fail(name, "the mesh has no attributes");
    const GltfAccessor out = document_.accessor(document_.integer(*attributes, name, name));
    if (out.type != ScalarType::f32 || out.components != components)
      document_.fail(name, fmt::format("is not made of {} floats each", components));
    if (count > 0 && out.count != count)
      document_.fail(name, fmt::format("has {} values for {} vertices", out.count, count));
    return out;
  }
  std::vector<double> values(const json& primitive, const std::string& name,
                             std::size_t count) const {
    const GltfAccessor at = attribute(primitive, name, 1, count);
    std::vector<double> out(at.count);
    for (std::size_t i = 0; i < at.count; ++i) {
      out[i] = at.value(i, 0);
      if (!std::isfinite(out[i])) document_.fail(fmt::format("{}[{}]", name, i), "is not finite");
    }
    return out;
  }
  template <typename Enum>
  std::vector<Enum> codes(const json& primitive, std::size_t count, std::size_t names,
                          const std::string& name) const {
    std::vector<Enum> out;
    out.reserve(count);
    for (const double v : values(primitive, name, count)) {
      if (!(v >= 0 && v < static_cast<double>(names)) || v != std::floor(v))
        document_.fail(fmt::format("{}[{}]", name, out.size()), fmt::format("{} has no name", v));
      out.push_back(static_cast<Enum>(static_cast<int>(v)));
    }
    return out;
  }

  SurfaceMesh read_mesh(const json& primitive, const std::string& where) const {
    SurfaceMesh mesh;
    const GltfAccessor at = attribute(primitive, "POSITION", 3, 0);
    mesh.points.reserve(at.count);
    for (std::size_t i = 0; i < at.count; ++i)
      mesh.points.emplace_back(at.value(i, 0), at.value(i, 1), at.value(i, 2));
    const GltfAccessor index = document_.accessor(document_.integer(primitive, "indices", where));
    if (index.type != ScalarType::u32 || index.components != 1 || index.count % 3 != 0)
      document_.fail(where, "its indices are not triangles of 32-bit integers");
    mesh.triangles.reserve(index.count / 3);
    for (std::size_t t = 0; t < index.count / 3; ++t) {
      Triangle corners;
      for (std::size_t k = 0; k < 3; ++k) {
        const double c = index.value(3 * t + k, 0);
        if (c >= static_cast<double>(at.count))
          document_.fail(fmt::format("{} triangle {}", where, t), "refers to a missing vertex");
        corners[k] = static_cast<std::int32_t>(c);
      }
      mesh.triangles.push_back(corners);
    }
    if (const auto defect = first_defect(mesh)) document_.fail(where, *defect);
    return mesh;
  }

  /// What files of the first program versions do not have.
  void read_additions(const json& primitive) {
    StiffnessMap& map = head_.map;
    const std::size_t n = map.size();
    if (extension_->contains("method_names")) {
      const std::size_t methods = check_names("method_names", kSolveMethodNames);
      map.method = codes<SolveMethod>(primitive, n, methods, "_METHOD");
    }
    if (extension_->contains("spread")) {
      head_.spread.depth = values(primitive, "_DEPTH_SD", n);
      head_.spread.stiffness = values(primitive, "_STIFFNESS_SD", n);
      for (std::vector<double>* column : {&head_.spread.depth, &head_.spread.stiffness})
        std::replace(column->begin(), column->end(), -1.0, kNaN);
    }
    if (extension_->contains("completed"))
      for (const double c : values(primitive, "_COMPLETED", n)) head_.completed.push_back(c != 0);
    if (!extension_->contains("dents")) return;
    const json& dents = member(*extension_, "dents");
    constexpr std::size_t kMaxRings = 100;
    map.dents.force = positive(dents, "force_n");
    map.dents.radii = number_list(member(dents, "radii_mm"), "radii_mm");
    if (map.dents.radii.size() > kMaxRings) document_.fail("dents", "has too many radii");
    map.dents.share.assign(n * map.dents.radii.size(), kNaN);
    for (std::size_t r = 0; r < map.dents.radii.size(); ++r) {
      const auto ring = values(primitive, fmt::format("_DENT_{}", r + 1), n);
      for (std::size_t v = 0; v < n; ++v)
        if (map.has_curve(v)) map.dents.share[v * map.dents.radii.size() + r] = ring[v];
    }
  }

  void read_map(const json& primitive) {
    StiffnessMap& map = head_.map;
    const std::size_t n = head_.skin.points.size(), samples = map.forces.size();
    map.status = codes<VertexStatus>(primitive, n, statuses_, "_STATUS");
    map.region = codes<SkinRegion>(primitive, n, regions_, "_REGION");
    map.depth = values(primitive, "_DEPTH", n);
    map.error = values(primitive, "_ERROR", n);
    for (std::vector<double>* column : {&map.depth, &map.error})
      std::replace(column->begin(), column->end(), -1.0, kNaN);
    read_additions(primitive);
    map.displacement.assign(n * samples, kNaN);
    for (std::size_t i = 0; i < samples; ++i) {
      const std::string name = fmt::format("_U_{}", i + 1);
      const std::vector<double> u = values(primitive, name, n);
      for (std::size_t v = 0; v < n; ++v) {
        if (!map.has_curve(v)) continue;
        if (!(u[v] > (i == 0 ? 0 : map.displacement[v * samples + i - 1])))
          document_.fail(fmt::format("vertex {}", v), "its curve does not ascend");
        map.displacement[v * samples + i] = u[v];
      }
    }
  }

  const GltfDocument& document_;
  const json* extension_ = nullptr;
  std::size_t statuses_ = 0, regions_ = 0, skull_regions_ = 0;  // codes that the file names
  TouchableHead head_;
};

}  // namespace

TouchableHead parse_head(std::string_view bytes, const std::string& name) {
  const Source source{name, bytes, {}};
  const GltfDocument document = GltfDocument::from_glb(source);
  return HeadReader(document).read();
}

TouchableHead read_head(const std::filesystem::path& path) {
  return parse_head(load_bytes(path), path.string());
}

std::string head_bytes_without_run(std::string_view bytes, const std::string& name) {
  (void)parse_head(bytes, name);  // throws where anything below could fail
  const std::size_t length = load<std::uint32_t>(bytes.data() + 12);
  auto document = nlohmann::ordered_json::parse(bytes.substr(20, length));
  document["extensions"][kHeadExtension]["run"] = nlohmann::ordered_json::object();
  return join_glb(document, bytes.substr(std::min(bytes.size(), 20 + length + 8)));
}

}  // namespace palpate::io
