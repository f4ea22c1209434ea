// SPDX-License-Identifier: Apache-2.0
// Gmsh's text format 2.2: the tissue mesh whole, both ways. Sections that Gmsh does not know carry
// what it has no word for; it passes over them.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "io/export.hpp"
#include "io/text_cursor.hpp"
#include "io/tissue_formats.hpp"

namespace palpate::io {
namespace {

constexpr int kTetrahedron = 4;  // Gmsh's element type

void node_data(std::string& out, const char* name, std::size_t count, auto&& value) {
  const auto to = std::back_inserter(out);
  // One text tag (the name), one number (the time), three integers (step, components, rows).
  fmt::format_to(to, "$NodeData\n1\n\"{}\"\n1\n0\n3\n0\n1\n{}\n", name, count);
  for (std::size_t i = 0; i < count; ++i) fmt::format_to(to, "{} {}\n", i + 1, value(i));
  out += "$EndNodeData\n";
}

class MshReader {
 public:
  explicit MshReader(const Source& source) : source_(source), text_(source.bytes) {}

  TissueMesh read() {
    expect("$MeshFormat");
    const std::string_view version = text_.next_word();
    if (version != "2.2" || text_.next_word() != "0") fail("is not Gmsh's text format 2.2");
    expect("8");
    expect("$EndMeshFormat");
    std::string_view section;
    while (!(section = text_.next_word()).empty()) {
      if (section == "$Nodes")
        read_nodes();
      else if (section == "$Elements")
        read_elements();
      else if (section == "$NodeData")
        read_node_data();
      else if (section == "$PalpateQuality")
        read_quality();
      else
        skip(section);
    }
    finish();
    return std::move(mesh_);
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    source_.fail(fmt::format("line {}", text_.line_number()), what,
                 "write the mesh again with `palpate mesh`");
  }
  void expect(std::string_view word) {
    const std::string_view found = text_.next_word();
    if (found != word) fail(fmt::format("{} instead of {}", in_quotes(found), word));
  }
  std::int64_t integer(std::int64_t low, std::int64_t high) {
    const std::string_view word = text_.next_word();
    const auto value = parse_integer(word);
    if (!value || *value < low || *value > high)
      fail(fmt::format("{} is not a number from {} to {}", in_quotes(word), low, high));
    return *value;
  }
  double number() {
    const std::string_view word = text_.next_word();
    const auto value = parse_number(word);
    if (!value || !std::isfinite(*value)) fail(fmt::format("{} is no number", in_quotes(word)));
    return *value;
  }
  /// Every row takes `least` bytes, so a count that does not fit is a damaged one.
  std::int64_t count(std::size_t least) {
    return integer(0, static_cast<std::int64_t>(text_.rest().size() / least));
  }

  void read_nodes() {
    if (!mesh_.nodes.empty()) fail("a second $Nodes");
    const std::int64_t n = count(8);
    mesh_.nodes.reserve(static_cast<std::size_t>(n));
    for (std::int64_t i = 1; i <= n; ++i) {
      integer(i, i);
      const double x = number(), y = number(), z = number();
      mesh_.nodes.emplace_back(x, y, z);
    }
    mesh_.held.assign(mesh_.nodes.size(), 0);
    expect("$EndNodes");
  }

  void read_elements() {
    if (!mesh_.tets.empty()) fail("a second $Elements");
    const std::int64_t n = count(10), nodes = static_cast<std::int64_t>(mesh_.nodes.size());
    for (std::int64_t i = 0; i < n; ++i) {
      integer(1, std::int64_t{1} << 40);
      if (integer(0, 1000) != kTetrahedron) fail("an element that is not a 4-node tetrahedron");
      const std::int64_t tags = integer(1, 10);
      mesh_.label.push_back(static_cast<TissueLabel>(integer(1, 2)));
      for (std::int64_t t = 1; t < tags; ++t) integer(0, std::int64_t{1} << 40);
      Tetrahedron tet;
      for (std::int32_t& corner : tet) corner = static_cast<std::int32_t>(integer(1, nodes) - 1);
      const Vec3& a = mesh_.nodes[tet[0]];
      const auto edge = [&](int k) { return Vec3(mesh_.nodes[tet[k]] - a); };
      if (!(edge(1).cross(edge(2)).dot(edge(3)) > 0)) fail("a tetrahedron without volume");
      mesh_.tets.push_back(tet);
    }
    expect("$EndElements");
  }

  void read_node_data() {
    expect("1");
    const std::string_view name = text_.next_word();
    for (const char* word : {"1", "0", "3", "0", "1"}) expect(word);
    const std::int64_t n = integer(0, static_cast<std::int64_t>(mesh_.nodes.size()));
    std::size_t set = 0;
    for (std::int64_t i = 1; i <= n; ++i) {
      const std::int64_t node = integer(1, static_cast<std::int64_t>(mesh_.nodes.size()));
      const std::int64_t value = integer(0, 1);
      if (name == "\"held\"") mesh_.held[static_cast<std::size_t>(node - 1)] = value != 0;
      if (name == "\"skin\"" && value != 0 && static_cast<std::size_t>(node - 1) != set++)
        fail("the nodes of the skin are not the first ones");
    }
    if (name == "\"skin\"") mesh_.skin_points = set;
    has_skin_ |= name == "\"skin\"";
    has_held_ |= name == "\"held\"";
    expect("$EndNodeData");
  }

  void read_quality() {
    const std::int64_t n = count(4);
    for (std::int64_t i = 0; i < n; ++i) {
      const std::string name(text_.next_word());
      mesh_.quality[name] = number();
    }
    expect("$EndPalpateQuality");
  }

  void skip(std::string_view section) {
    if (section.size() < 2 || section.front() != '$') fail("a section's name is missing");
    const std::string end = fmt::format("$End{}", section.substr(1));
    std::string_view word;
    while ((word = text_.next_word()) != end)
      if (word.empty()) fail(fmt::format("the file ends before {}", in_quotes(end)));
  }

  void finish() const {
    if (mesh_.nodes.empty() || mesh_.tets.empty()) fail("no tetrahedra");
    if (!has_skin_ || !has_held_) fail("no $NodeData \"held\" and \"skin\"; is the file cut?");
  }

  const Source& source_;
  TextCursor text_;
  TissueMesh mesh_;
  bool has_skin_ = false;
  bool has_held_ = false;
};

}  // namespace

std::string tissue_msh(const TissueMesh& mesh) {
  std::string out =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
      "$PhysicalNames\n2\n3 1 \"flesh\"\n3 2 \"bone\"\n$EndPhysicalNames\n";
  const auto to = std::back_inserter(out);
  fmt::format_to(to, "$Nodes\n{}\n", mesh.nodes.size());
  for (std::size_t i = 0; i < mesh.nodes.size(); ++i)
    fmt::format_to(to, "{} {} {} {}\n", i + 1, mesh.nodes[i].x(), mesh.nodes[i].y(),
                   mesh.nodes[i].z());
  fmt::format_to(to, "$EndNodes\n$Elements\n{}\n", mesh.tets.size());
  for (std::size_t t = 0; t < mesh.tets.size(); ++t) {
    const int label = static_cast<int>(mesh.label[t]);
    fmt::format_to(to, "{} {} 2 {} {} {} {} {} {}\n", t + 1, kTetrahedron, label, label,
                   mesh.tets[t][0] + 1, mesh.tets[t][1] + 1, mesh.tets[t][2] + 1,
                   mesh.tets[t][3] + 1);
  }
  out += "$EndElements\n";
  node_data(out, "held", mesh.nodes.size(), [&](std::size_t i) { return mesh.held[i] ? 1 : 0; });
  node_data(out, "skin", mesh.nodes.size(),
            [&](std::size_t i) { return i < mesh.skin_points ? 1 : 0; });
  const auto finite = [](const auto& entry) { return std::isfinite(entry.second); };
  fmt::format_to(to, "$PalpateQuality\n{}\n",
                 std::count_if(mesh.quality.begin(), mesh.quality.end(), finite));
  for (const auto& entry : mesh.quality)
    if (finite(entry)) fmt::format_to(to, "{} {}\n", entry.first, entry.second);
  out += "$EndPalpateQuality\n";
  return out;
}

TissueMesh parse_tissue_msh(const Source& source) {
  return MshReader(source).read();
}

TissueMesh read_tissue(const std::filesystem::path& msh) {
  const std::string bytes = load_bytes(msh);
  return parse_tissue_msh({msh.string(), bytes, msh.parent_path()});
}

}  // namespace palpate::io
