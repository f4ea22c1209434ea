// SPDX-License-Identifier: GPL-3.0-or-later
// Closes every border of a surface with a triangulated, refined patch (CGAL, after Liepa 2003).
//
// The input's vertices keep their numbers; new ones follow them, hole by hole.
// Usage: fill_holes IN.off OUT.off
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/Surface_mesh.h>

#include <fstream>
#include <iostream>
#include <iterator>
#include <stdexcept>
#include <string>
#include <vector>

namespace PMP = CGAL::Polygon_mesh_processing;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

int main(int argc, char** argv) {
  if (argc != 3) {
    std::cerr << "usage: fill_holes IN.off OUT.off\n";
    return 2;
  }
  try {
    Mesh mesh;
    std::ifstream in(argv[1]);
    if (!(in >> mesh)) throw std::runtime_error(std::string(argv[1]) + ": not a manifold OFF mesh");
    std::vector<Mesh::Halfedge_index> borders;
    PMP::extract_boundary_cycles(mesh, std::back_inserter(borders));
    for (auto h : borders) {
      std::vector<Mesh::Face_index> faces;
      std::vector<Mesh::Vertex_index> vertices;
      PMP::triangulate_and_refine_hole(mesh, h, std::back_inserter(faces),
                                       std::back_inserter(vertices));
      std::cout << "hole closed: " << faces.size() << " triangles, " << vertices.size()
                << " new vertices\n";
    }
    std::cout << mesh.num_vertices() << " vertices, " << mesh.num_faces() << " faces, closed "
              << CGAL::is_closed(mesh) << ", self-intersecting " << PMP::does_self_intersect(mesh)
              << '\n';
    std::ofstream out(argv[2]);
    out.precision(9);
    out << mesh;
    return out.good() ? 0 : 1;
  } catch (const std::exception& error) {
    std::cerr << "fill_holes: " << error.what() << '\n';
    return 1;
  }
}
