// SPDX-License-Identifier: GPL-3.0-or-later
// What a verification says: figures with their limits, gathered in sections.
#pragma once
#include <string>
#include <vector>

#include "plot/figures.hpp"
#include "report/page.hpp"

namespace palpate::verify {

enum class Verdict { met, missed, not_run };
[[nodiscard]] const char* name(Verdict v);

/// One measured number beside the number it is held to.
struct Figure {
  std::string what;
  double value = 0;
  double limit = 0;
  bool at_least = false;  ///< the value must reach the limit; else it must not exceed it
  Verdict verdict = Verdict::missed;
  std::string note{};  ///< why it was not run, or what the value was measured on
};
/// A number that fails its comparison, or is NaN, is missed.
[[nodiscard]] Figure at_most(std::string what, double value, double limit, std::string note = {});
[[nodiscard]] Figure at_least(std::string what, double value, double limit, std::string note = {});
[[nodiscard]] Figure not_run(std::string what, double limit, std::string reason);

struct Section {
  std::string id, title, text;
  std::vector<Figure> figures{};
  std::vector<report::Page::Table> tables{};
  std::vector<plot::LinePlot> plots{};
  double seconds = 0;
};

}  // namespace palpate::verify
