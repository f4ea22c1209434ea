// SPDX-License-Identifier: Apache-2.0
// The texts behind write_tissue, and the reader of one of them.
#pragma once
#include <string>

#include "core/tissue_mesh.hpp"
#include "io/source.hpp"

namespace palpate::io {

[[nodiscard]] std::string tissue_vtu(const TissueMesh& mesh);
[[nodiscard]] std::string tissue_veg(const TissueMesh& mesh);
[[nodiscard]] std::string tissue_inp(const TissueMesh& mesh);
[[nodiscard]] std::string tissue_msh(const TissueMesh& mesh);
/// @throws InputError  names the line
[[nodiscard]] TissueMesh parse_tissue_msh(const Source& source);

}  // namespace palpate::io
