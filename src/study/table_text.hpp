// SPDX-License-Identifier: GPL-3.0-or-later
// Rows of text for CSV and TSV; private to this folder.
#pragma once
#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::study {

/// Shortest decimal text that reads back to the same double; `missing` for NaN and infinities.
[[nodiscard]] std::string number_cell(double value, std::string_view missing = "");

/// A table in RFC 4180's form: cells with a comma, a quote or a line break are quoted. A cell that
/// a spreadsheet would run as a formula gets a leading apostrophe, unless it is a number.
class CsvText {
 public:
  explicit CsvText(std::initializer_list<std::string_view> head);
  void row(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// Tabs between cells; tabs and line breaks inside become spaces; an empty cell becomes "n/a".
class TsvText {
 public:
  explicit TsvText(const std::vector<std::string>& head);
  void row(const std::vector<std::string>& cells);
  [[nodiscard]] std::string text() && { return std::move(text_); }

 private:
  std::string text_;
};

/// 2026-03-01T09:30:00.125Z; empty for 0.
[[nodiscard]] std::string utc_text(std::int64_t milliseconds);

}  // namespace palpate::study
