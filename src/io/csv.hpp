// SPDX-License-Identifier: Apache-2.0
// Comma-separated values (RFC 4180): quotes, commas and line ends inside quotes.
#pragma once
#include <string>
#include <vector>

#include "io/source.hpp"

namespace palpate::io {

struct CsvRow {
  std::size_t line = 0;  ///< where the row begins, from 1
  std::vector<std::string> cells;
};
/// All rows but blank ones. @throws InputError where a quote is not closed
[[nodiscard]] std::vector<CsvRow> parse_csv(const Source& source);

}  // namespace palpate::io
