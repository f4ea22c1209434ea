// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <fstream>
#include <limits>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "tetmesh/process.hpp"
#include "verify/blocks.hpp"
#include "verify/slab_case.hpp"
#include "verify/verify.hpp"

namespace palpate::verify {
namespace {

using fem::ElementOrder;
namespace fs = std::filesystem;

constexpr const char* kScript =
#include "verify/getfem_script.inc"
    ;
// Debian's module belongs to Debian's own Python, whatever else is first in the path.
const char* python() {
  constexpr const char* kDebian = "/usr/bin/python3";
  return fs::exists(kDebian) ? kDebian : "python3";
}

constexpr const char* kInstall = "not run: install python3-getfem";
constexpr double kTimeLimit = 600;  // [s] of one GetFEM run; it takes some ten

std::string written(const SlabCase& c, const fem::LameModuli& m) {
  const fem::TetMesh& mesh = c.slab.mesh;
  const int stride = fem::tet_nodes(mesh.order);
  std::string out =
      fmt::format("{} {} {} {} {}\n{:.17g} {:.17g}\n", static_cast<int>(mesh.order),
                  mesh.nodes.size(), mesh.size(), c.unit.size(), c.forces.size(), m.lambda, m.mu);
  for (const Vec3& p : mesh.nodes)
    out += fmt::format("{:.17g} {:.17g} {:.17g}\n", p.x(), p.y(), p.z());
  for (std::size_t i = 0; i < mesh.tets.size(); i += stride)
    out += fmt::format("{} {} {} {}\n", mesh.tets[i], mesh.tets[i + 1], mesh.tets[i + 2],
                       mesh.tets[i + 3]);
  for (const fem::NodalLoad& l : c.unit)
    out +=
        fmt::format("{} {:.17g} {:.17g} {:.17g}\n", l.node, l.force.x(), l.force.y(), l.force.z());
  for (const double f : c.forces) out += fmt::format("{:.17g}\n", f);
  return out;
}

std::vector<Field> read_fields(const fs::path& file, std::size_t nodes) {
  std::ifstream in(file);
  std::vector<Field> fields;
  Vec3 u;
  while (in >> u[0] >> u[1] >> u[2]) {
    if (fields.empty() || fields.back().size() == nodes) fields.emplace_back();
    fields.back().push_back(u);
  }
  if (!fields.empty() && fields.back().size() < nodes) fields.pop_back();
  return fields;
}

}  // namespace

Section compare_getfem(const VerifyOptions& options, const Progress& progress) {
  Section s{
      "getfem", "The same slab in GetFEM",
      "12 mm of flesh bonded to a floor, under a smooth pressure of radius 8 mm that keeps its "
      "direction. With 10-node elements the two solvers were seen to end in different equilibria "
      "at "
      "2.5 and 4 N; what is compared there is smaller. "
      "GetFEM gets the tetrahedra and the nodal forces; shape functions, assembly, the "
      "neo-Hookean energy (written in its weak-form language) and Newton are its own. Largest "
      "difference of any node over the largest displacement."};
  report::Page::Table table{
      {"element", "load [N]", "ours, middle [mm]", "GetFEM [mm]", "difference"}, {}};
  const fem::LameModuli m = flesh_moduli();
  for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
    const std::string what = order == ElementOrder::linear
                                 ? "GetFEM, 4-node elements, whole field"
                                 : "GetFEM, 10-node elements, whole field";
    if (options.quick && order == ElementOrder::quadratic) continue;
    const SlabCase scene =
        slab_case(order, order == ElementOrder::linear ? std::vector<double>{1, 2.5, 4}
                                                       : std::vector<double>{0.5, 1, 1.5});
    const tetmesh::TemporaryFolder folder;
    const fs::path script = folder.path() / "slab.py", in = folder.path() / "case",
                   out = folder.path() / "answer";
    write_file(script, kScript);
    write_file(in, written(scene, m));
    const CpuSeconds before = CpuSeconds::now();
    const tetmesh::ProcessResult run = tetmesh::run_process(
        python(), {script, in, out}, folder.path() / "log", kTimeLimit, 20, progress, "GetFEM");
    if (!run.found || run.last_words.find("No module named") != std::string::npos) {
      s.figures.push_back(not_run(what, 1e-5, kInstall));
      continue;
    }
    const std::vector<Field> theirs = read_fields(out, scene.slab.mesh.nodes.size());
    if (run.exit_code != 0 || theirs.size() != scene.forces.size()) {
      s.figures.push_back(not_run(what, 1e-5, "GetFEM failed: " + run.last_line));
      continue;
    }
    const SlabFields ours = solve_ours(scene, fem::neo_hookean(m));
    double worst = ours.failure.empty() ? 0 : std::numeric_limits<double>::quiet_NaN();
    for (std::size_t i = 0; i < ours.at.size(); ++i) {
      const double difference = field_difference(ours.at[i], theirs[i]);
      worst = std::max(worst, difference);
      table.rows.push_back(
          {order == ElementOrder::linear ? "4 nodes" : "10 nodes",
           fmt::format("{}", scene.forces[i]), fmt::format("{:.6f}", -ours.at[i][0].z()),
           fmt::format("{:.6f}", -theirs[i][0].z()), fmt::format("{:.1e}", difference)});
    }
    s.figures.push_back(
        at_most(what, worst, 1e-5, ours.failure.empty() ? before.since("GetFEM") : ours.failure));
  }
  s.tables = {table};
  return s;
}

}  // namespace palpate::verify
