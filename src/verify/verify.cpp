// SPDX-License-Identifier: GPL-3.0-or-later
#include "verify/verify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <functional>

#include "core/error.hpp"

namespace palpate::verify {
namespace {

struct Entry {
  const char* id;
  std::function<Section(const VerifyOptions&, const Progress&)> run;
};

template <class Check>
auto without_progress(Check check) {
  return [check](const VerifyOptions& o, const Progress&) { return check(o); };
}

const std::vector<Entry>& entries() {
  static const std::vector<Entry> all = {{"derivatives", without_progress(check_derivatives)},
                                         {"patch", without_progress(check_patch)},
                                         {"convergence", without_progress(check_convergence)},
                                         {"layer", without_progress(check_bonded_layer)},
                                         {"getfem", compare_getfem},
                                         {"calculix", compare_calculix},
                                         {"mesh", without_progress(study_rim_and_mesh)},
                                         {"methods", without_progress(compare_methods)}};
  return all;
}

}  // namespace

std::vector<std::string> section_ids() {
  std::vector<std::string> ids;
  for (const Entry& e : entries()) ids.push_back(e.id);
  return ids;
}

std::vector<Section> run_verification(const VerifyOptions& options, const Progress& progress) {
  const std::vector<std::string> known = section_ids();
  for (const std::string& id : options.only)
    if (std::find(known.begin(), known.end(), id) == known.end())
      throw InputError(fmt::format("no section \"{}\"; there are: {}", id, fmt::join(known, ", ")));
  std::vector<Section> sections;
  for (std::size_t i = 0; i < entries().size(); ++i) {
    const Entry& e = entries()[i];
    const bool wanted = options.only.empty() || std::find(options.only.begin(), options.only.end(),
                                                          e.id) != options.only.end();
    if (!wanted) continue;
    progress.step(e.id, static_cast<double>(i) / static_cast<double>(entries().size()));
    const auto start = std::chrono::steady_clock::now();
    try {
      sections.push_back(e.run(options, progress));
    } catch (const SolveError& error) {
      sections.push_back({e.id, e.id, "A solve failed; nothing of this section can be said."});
      sections.back().figures = {
          {std::string(e.id) + ", all figures", 0, 0, false, Verdict::missed, error.what()}};
    }
    sections.back().seconds =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  }
  return sections;
}

bool all_met(const std::vector<Section>& sections) {
  for (const Section& s : sections)
    for (const Figure& f : s.figures)
      if (f.verdict == Verdict::missed) return false;
  return true;
}

}  // namespace palpate::verify
