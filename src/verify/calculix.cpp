// SPDX-License-Identifier: GPL-3.0-or-later
// CalculiX on the same slab. Its hyperelastic laws are isochoric with (J - 1)^2 / D1, so ours is
// given that volume term: with k ln^2 J the displacements differ by percents, and rightly so.
#include <fmt/format.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <sstream>

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

constexpr const char* kInstall = "not run: install calculix-ccx";
constexpr double kTimeLimit = 600;  // [s] of one CalculiX run

/// The deck: one step a load, displacements of all nodes printed at its end.
std::string deck(const SlabCase& c, const std::string& material) {
  const fem::TetMesh& mesh = c.slab.mesh;
  const int stride = fem::tet_nodes(mesh.order);
  std::string out = "*NODE, NSET=ALL\n";
  for (std::size_t n = 0; n < mesh.nodes.size(); ++n)
    out += fmt::format("{}, {:.12e}, {:.12e}, {:.12e}\n", n + 1, mesh.nodes[n].x(),
                       mesh.nodes[n].y(), mesh.nodes[n].z());
  out += fmt::format("*ELEMENT, TYPE=C3D{}, ELSET=SLAB\n", stride);
  for (int t = 0; t < mesh.size(); ++t) {
    out += fmt::format("{}", t + 1);
    for (int a = 0; a < stride; ++a) out += fmt::format(", {}", mesh.tet(t)[a] + 1);
    out += "\n";
  }
  out += "*NSET, NSET=FLOOR\n";
  for (std::size_t n = 0; n < c.slab.held.size(); ++n)
    if (c.slab.held[n]) out += fmt::format("{},\n", n + 1);
  out += "*MATERIAL, NAME=FLESH\n" + material +
         "*SOLID SECTION, ELSET=SLAB, MATERIAL=FLESH\n*BOUNDARY\nFLOOR, 1, 3, 0.\n";
  for (const double force : c.forces) {
    out +=
        "*STEP, NLGEOM, INC=500\n*STATIC\n0.1, 1., 1e-4\n*CONTROLS, PARAMETERS=FIELD\n"
        "1e-6, 1e-5\n*CLOAD\n";
    for (const fem::NodalLoad& l : c.unit)
      for (int k = 0; k < 3; ++k)
        if (l.force[k] != 0)
          out += fmt::format("{}, {}, {:.12e}\n", l.node + 1, k + 1, force * l.force[k]);
    out += "*NODE PRINT, NSET=ALL, FREQUENCY=1000\nU\n*END STEP\n";
  }
  return out;
}

/// The fields at the ends of the steps (times 1, 2, ...) of a .dat file.
std::vector<Field> read_dat(const fs::path& file, std::size_t nodes) {
  std::ifstream in(file);
  std::vector<Field> fields;
  bool wanted = false;
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    if (const auto at = line.find("and time"); at != std::string::npos) {
      const double time = std::stod(line.substr(at + 8));
      wanted = std::abs(time - static_cast<double>(fields.size() + 1)) < 1e-6;
      if (wanted) fields.emplace_back(nodes, Vec3::Zero());
      continue;
    }
    std::size_t node = 0;
    Vec3 u;
    if (wanted && words >> node >> u[0] >> u[1] >> u[2] && node >= 1 && node <= nodes)
      fields.back()[node - 1] = u;
  }
  return fields;
}

struct Theirs {
  bool found = true;
  std::vector<Field> at;
  std::string last_line;
};

Theirs run_calculix(const SlabCase& scene, const std::string& material, const Progress& progress) {
  const tetmesh::TemporaryFolder folder;
  write_file(folder.path() / "slab.inp", deck(scene, material));
  const tetmesh::ProcessResult run =
      tetmesh::run_process("ccx", {"-i", folder.path() / "slab"}, folder.path() / "log", kTimeLimit,
                           20, progress, "CalculiX");
  return {run.found, read_dat(folder.path() / "slab.dat", scene.slab.mesh.nodes.size()),
          run.last_line};
}

struct Case {
  const char* name;
  std::string material;
  fem::TissueLaws laws;
};

/// Small-strain moduli of the flesh; b > 0: Mooney-Rivlin.
Case hyperelastic(bool mooney) {
  const fem::LameModuli m = flesh_moduli();
  fem::MooneyRivlin p = fem::mooney_rivlin_from(m);
  p.volume = fem::VolumeTerm::quadratic;
  if (!mooney) p.a += p.b, p.b = 0;
  const std::string material =
      mooney ? fmt::format("*HYPERELASTIC, MOONEY-RIVLIN\n{:.12e}, {:.12e}, {:.12e}\n", p.a, p.b,
                           1 / p.k)
             : fmt::format("*HYPERELASTIC, NEO HOOKE\n{:.12e}, {:.12e}\n", p.a, 1 / p.k);
  return {mooney ? "Mooney-Rivlin" : "neo-Hooke", material, fem::mooney_rivlin(p)};
}

void compare_law(const Case& law, ElementOrder order, const Progress& progress,
                 report::Page::Table& table, Section& s) {
  const char* element = order == ElementOrder::linear ? "C3D4" : "C3D10";
  const std::string what = fmt::format("CalculiX, {}, {}, whole field", law.name, element);
  const SlabCase scene =
      slab_case(order, order == ElementOrder::linear ? std::vector<double>{1, 2.5, 5}
                                                     : std::vector<double>{0.5, 1, 2.5});
  const CpuSeconds before = CpuSeconds::now();
  const Theirs theirs = run_calculix(scene, law.material, progress);
  if (!theirs.found) {
    s.figures.push_back(not_run(what, 1e-3, kInstall));
    return;
  }
  const SlabFields ours = solve_ours(scene, law.laws);
  double worst = 0;
  const std::size_t both = std::min(ours.at.size(), theirs.at.size());
  for (std::size_t i = 0; i < both; ++i) {
    const double difference = field_difference(ours.at[i], theirs.at[i]);
    worst = std::max(worst, difference);
    table.rows.push_back({law.name, element, fmt::format("{}", scene.forces[i]),
                          fmt::format("{:.5f}", -ours.at[i][0].z()),
                          fmt::format("{:.5f}", -theirs.at[i][0].z()),
                          fmt::format("{:.1e}", difference)});
  }
  std::string note = ours.failure.empty() ? before.since("CalculiX") : ours.failure;
  if (theirs.at.size() < scene.forces.size())
    note = fmt::format("CalculiX reached {} of {} loads: {}", theirs.at.size(), scene.forces.size(),
                       theirs.last_line);
  if (both < scene.forces.size()) worst = std::numeric_limits<double>::quiet_NaN();
  s.figures.push_back(at_most(what, worst, 1e-3, note));
}

/// *ELASTIC with NLGEOM is Saint-Venant-Kirchhoff: the same field while it carries, and neither
/// solver brings it to 5 N without an element inside out.
void compare_collapse(const Progress& progress, report::Page::Table& table, Section& s) {
  const std::string same = "CalculiX *ELASTIC, NLGEOM = Saint-Venant-Kirchhoff, loads both carry";
  const std::string refuses = "Saint-Venant-Kirchhoff refused before 5 N by ours";
  const SlabCase scene =
      slab_case(ElementOrder::quadratic, {0.5, 1, 1.5, 2, 2.5, 3, 3.5, 4, 4.5, 5});
  const SlabFields ours = solve_ours(scene, fem::st_venant_kirchhoff(flesh_moduli()));
  const std::size_t sound = ours.first_inverted < 0 ? ours.at.size() : ours.first_inverted;
  s.figures.push_back(
      at_least(refuses, sound < scene.forces.size() ? 1 : 0, 1,
               ours.failure.empty() && ours.first_inverted >= 0
                   ? fmt::format("elements inside out at {} N", scene.forces[ours.first_inverted])
                   : ours.failure));
  const std::string elastic = fmt::format("*ELASTIC\n{:.12e}, {}\n", kFleshModulus, kFleshPoisson);
  const Theirs theirs = run_calculix(scene, elastic, progress);
  if (!theirs.found) {
    s.figures.push_back(not_run(same, 1e-3, kInstall));
    return;
  }
  const std::size_t both = std::min(sound, theirs.at.size());
  double worst = both > 0 ? 0 : std::numeric_limits<double>::quiet_NaN();
  for (std::size_t i = 0; i < std::max(sound, theirs.at.size()); ++i) {
    const auto middle = [i](const std::vector<Field>& f, std::size_t count) {
      return i < count ? fmt::format("{:.5f}", -f[i][0].z()) : std::string("fails");
    };
    const double difference = i < both ? field_difference(ours.at[i], theirs.at[i]) : 0;
    worst = std::max(worst, difference);
    table.rows.push_back({"St.-Venant-Kirchhoff", "C3D10", fmt::format("{}", scene.forces[i]),
                          middle(ours.at, sound), middle(theirs.at, theirs.at.size()),
                          i < both ? fmt::format("{:.1e}", difference) : ""});
  }
  s.figures.push_back(
      at_most(same, worst, 1e-3,
              fmt::format("CalculiX carries it to {} N, ours to {} N",
                          theirs.at.empty() ? 0 : scene.forces[theirs.at.size() - 1],
                          sound == 0 ? 0 : scene.forces[sound - 1])));
}

}  // namespace

Section compare_calculix(const VerifyOptions& options, const Progress& progress) {
  Section s{"calculix", "The same slab in CalculiX",
            "As above with CalculiX's own elements, laws and solver; its volumetric energy "
            "(J - 1)²/D1 is matched. Its *ELASTIC under NLGEOM is Saint-Venant-Kirchhoff, which "
            "collapses under a fingertip's pressure: both solvers must say so."};
  report::Page::Table table{
      {"law", "element", "load [N]", "ours, middle [mm]", "CalculiX [mm]", "difference"}, {}};
  table.text_columns = 2;
  for (const bool mooney : {false, true})
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
      if (options.quick && (mooney || order == ElementOrder::quadratic)) continue;
      compare_law(hyperelastic(mooney), order, progress, table, s);
    }
  if (!options.quick) compare_collapse(progress, table, s);
  s.tables = {table};
  return s;
}

}  // namespace palpate::verify
