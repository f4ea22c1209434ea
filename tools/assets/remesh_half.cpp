// SPDX-License-Identifier: GPL-3.0-or-later
// Remeshes one half of a mirror-symmetric closed surface and joins it with its mirror image.
//
// Input: an OFF mesh with x >= 0 whose only border lies in the plane x = 0. Output: the closed
// surface (half and mirror image, stitched in the plane), so that every vertex has an exact mirror
// partner. Isotropic remeshing after Botsch and Kobbelt 2004 as implemented in CGAL; the border
// stays in the plane since border vertices are neither relaxed nor projected off it.
// Usage: remesh_half IN.off OUT.off EDGE_MM ITERATIONS [--whole]
//   --whole: remesh as it is (closed input), no mirror.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/measure.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/remesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/Surface_mesh.h>

#include <cmath>
#include <fstream>
#include <iostream>
#include <string>
#include <vector>

namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Point = Kernel::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

constexpr double kPlaneTolerance = 1e-4;  // [mm] a border vertex nearer than this is in the plane

/// Moves border vertices into the plane x = 0; false if one lies off it.
bool snap_border(Mesh& mesh) {
  bool good = true;
  for (auto h : mesh.halfedges()) {
    if (!mesh.is_border(h)) continue;
    Point& p = mesh.point(mesh.target(h));
    good = good && std::abs(p.x()) < kPlaneTolerance;
    p = Point(0, p.y(), p.z());
  }
  return good;
}

/// Appends the mirror image and stitches both in the plane.
void mirror_and_join(Mesh& mesh) {
  const std::vector<Mesh::Face_index> faces(mesh.faces().begin(), mesh.faces().end());
  const std::vector<Mesh::Vertex_index> vertices(mesh.vertices().begin(), mesh.vertices().end());
  std::vector<Mesh::Vertex_index> twin(mesh.num_vertices());
  for (auto v : vertices) {
    const Point& p = mesh.point(v);
    twin[v] = mesh.is_border(v) ? v : mesh.add_vertex(Point(-p.x(), p.y(), p.z()));
  }
  for (auto f : faces) {
    auto h = mesh.halfedge(f);
    const auto a = mesh.source(h), b = mesh.target(h), c = mesh.target(mesh.next(h));
    if (mesh.add_face(twin[a], twin[c], twin[b]) == Mesh::null_face())
      throw std::runtime_error("mirror face does not fit: the border is not a simple curve");
  }
}

void report(const Mesh& mesh) {
  const long euler = static_cast<long>(mesh.num_vertices()) - static_cast<long>(mesh.num_edges()) +
                     static_cast<long>(mesh.num_faces());
  const bool closed = CGAL::is_closed(mesh);
  std::cout << mesh.num_vertices() << " vertices, " << mesh.num_faces() << " faces, closed "
            << closed << ", Euler characteristic " << euler << ", self-intersecting "
            << PMP::does_self_intersect(mesh) << ", volume "
            << (closed ? PMP::volume(mesh) / 1000 : 0.0) << " ml\n";
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 5) {
    std::cerr << "usage: remesh_half IN.off OUT.off EDGE_MM ITERATIONS [--whole]\n";
    return 2;
  }
  try {
    const double edge = std::stod(argv[3]);
    const unsigned iterations = static_cast<unsigned>(std::stoul(argv[4]));
    const bool whole = argc > 5 && std::string(argv[5]) == "--whole";
    Mesh mesh;
    std::ifstream in(argv[1]);
    if (!(in >> mesh)) throw std::runtime_error(std::string(argv[1]) + ": not a manifold OFF mesh");
    if (!whole && !snap_border(mesh)) throw std::runtime_error("the border leaves the plane x = 0");
    PMP::isotropic_remeshing(
        mesh.faces(), edge, mesh,
        PMP::parameters::number_of_iterations(iterations).number_of_relaxation_steps(3));
    mesh.collect_garbage();
    if (!whole) {
      if (!snap_border(mesh)) throw std::runtime_error("remeshing moved the border off x = 0");
      mirror_and_join(mesh);
    }
    if (CGAL::is_closed(mesh) && !PMP::is_outward_oriented(mesh))
      PMP::reverse_face_orientations(mesh);
    report(mesh);
    std::ofstream out(argv[2]);
    out.precision(9);
    out << mesh;
    return out.good() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "remesh_half: " << error.what() << '\n';
    return 1;
  }
}
