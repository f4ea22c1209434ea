// SPDX-License-Identifier: Apache-2.0
#include "io/csv.hpp"

#include <fmt/format.h>

namespace palpate::io {

std::vector<CsvRow> parse_csv(const Source& source) {
  std::vector<CsvRow> rows;
  CsvRow row{1, {""}};
  std::size_t line = 1;
  bool inside = false;
  const auto end_row = [&] {
    if (row.cells.size() > 1 || !row.cells[0].empty()) rows.push_back(std::move(row));
    row = {line + 1, {""}};
  };
  const std::string_view text = source.bytes;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (inside && c == '"' && i + 1 < text.size() && text[i + 1] == '"') {
      row.cells.back().push_back('"');
      ++i;
    } else if (c == '"') {
      inside = !inside;
    } else if (!inside && c == ',') {
      row.cells.emplace_back();
    } else if (!inside && c == '\n') {
      end_row();
    } else if (inside || c != '\r') {
      row.cells.back().push_back(c);
    }
    line += c == '\n';
  }
  if (inside) source.fail(fmt::format("line {}", row.line), "a quote is not closed", "close it");
  end_row();
  return rows;
}

}  // namespace palpate::io
