// SPDX-License-Identifier: GPL-3.0-or-later
// Verification as a product: every claim about the mechanics measured again, on this machine, with
// this build, and set beside exact solutions and two solvers that are not ours.
#pragma once
#include <filesystem>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "fem/element.hpp"
#include "verify/figure.hpp"

namespace palpate::verify {

struct VerifyOptions {
  bool quick = false;               ///< fewer states, rows and loads: a minute instead of ten
  std::vector<std::string> only{};  ///< ids of the sections to run; empty: all
  std::filesystem::path exact_layer_csv{};  ///< the table of exact indentation forces
};

/// Ids in the order of the report.
[[nodiscard]] std::vector<std::string> section_ids();
/// @throws InputError  an id in `only` that there is not, an unreadable table
/// @throws Cancelled   from progress
/// @note A solve that fails inside a section is a missed figure, not an exception.
[[nodiscard]] std::vector<Section> run_verification(const VerifyOptions& options,
                                                    const Progress& progress);

/// True where no figure was missed; what was not run does not count.
[[nodiscard]] bool all_met(const std::vector<Section>& sections);
/// The figures as lines for a terminal.
[[nodiscard]] std::string text_table(const std::vector<Section>& sections);
/// One self-contained page: figures, tables, plots.
[[nodiscard]] std::string html_page(const std::vector<Section>& sections);

// The sections, each alone.
[[nodiscard]] Section check_derivatives(const VerifyOptions& options);
[[nodiscard]] Section check_patch(const VerifyOptions& options);
[[nodiscard]] Section check_convergence(const VerifyOptions& options);
/// [mm] root mean square error of the manufactured solution on a unit cube of cells^3 cells.
[[nodiscard]] double displacement_error(fem::ElementOrder order, int cells);
[[nodiscard]] Section check_bonded_layer(const VerifyOptions& options);
[[nodiscard]] Section compare_getfem(const VerifyOptions& options, const Progress& progress);
[[nodiscard]] Section compare_calculix(const VerifyOptions& options, const Progress& progress);
[[nodiscard]] Section study_rim_and_mesh(const VerifyOptions& options);
[[nodiscard]] Section compare_methods(const VerifyOptions& options);

}  // namespace palpate::verify
