// SPDX-License-Identifier: GPL-3.0-or-later
// The table of touch: what was asked, what was measured, whether it holds.
#pragma once
#include <fmt/format.h>

#include <string>
#include <vector>

namespace palpate::bench {

struct Row {
  std::string what, asked, measured;
  bool holds = true;
};

class Table {
 public:
  void add(std::string what, std::string asked, std::string measured, bool holds) {
    rows_.push_back({std::move(what), std::move(asked), std::move(measured), holds});
    const Row& r = rows_.back();
    fmt::print("{} {:<34} {:<28} {}\n", r.holds ? "  " : "!!", r.what, r.asked, r.measured);
    std::fflush(stdout);
  }
  /// A line that is not judged.
  void note(const std::string& text) {
    fmt::print("   {}\n", text);
    std::fflush(stdout);
  }
  [[nodiscard]] std::size_t missed() const {
    std::size_t n = 0;
    for (const Row& r : rows_) n += !r.holds;
    return n;
  }

 private:
  std::vector<Row> rows_;
};

}  // namespace palpate::bench
