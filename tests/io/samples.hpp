// SPDX-License-Identifier: Apache-2.0
// Small meshes and heads for the tests and the fuzzer.
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/tissue_mesh.hpp"
#include "core/touchable_head.hpp"
#include "io/readers.hpp"

namespace palpate::io::test {

/// Octahedron subdivided `levels` times, pushed out to an ellipsoid of a head's size [mm].
SurfaceMesh ellipsoid(int levels);
/// A head with every status, a skull, and depths with a NaN.
TouchableHead sample_head(int levels = 2);
/// A ring of flesh tetrahedra about a bone one.
TissueMesh sample_tissue();

struct SampleFile {
  std::string extension;
  std::string label;  ///< of the variant: "ply-big", ...
  std::string bytes;
  ParsedMesh (*parse)(const Source&);
};
/// The ellipsoid in every format and variant that is read.
std::vector<SampleFile> sample_files(int levels);

std::string ply_text(const SurfaceMesh& mesh);
std::string ply_binary(const SurfaceMesh& mesh, bool big_endian);
std::string obj_text(const SurfaceMesh& mesh);
std::string off_text(const SurfaceMesh& mesh);
std::string stl_text(const SurfaceMesh& mesh);
std::string stl_binary(const SurfaceMesh& mesh);
std::string gltf_text(const SurfaceMesh& mesh);
std::string glb_bytes(const SurfaceMesh& mesh);

/// A folder of this process, removed at the end.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  std::filesystem::path path;
  std::filesystem::path write(const std::string& name, const std::string& bytes) const;
};

/// Small, fast, the same on every machine (splitmix64).
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}
  std::uint64_t next() {
    std::uint64_t z = state_ += 0x9e3779b97f4a7c15;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9;
    z = (z ^ z >> 27) * 0x94d049bb133111eb;
    return z ^ z >> 31;
  }
  std::size_t below(std::size_t n) { return n == 0 ? 0 : next() % n; }

 private:
  std::uint64_t state_;
};

/// Overwrites, flips, removes, doubles or cuts; one to four times.
std::string mutated(std::string bytes, Random& random);

}  // namespace palpate::io::test
