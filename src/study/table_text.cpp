// SPDX-License-Identifier: GPL-3.0-or-later
#include "study/table_text.hpp"

#include <fmt/format.h>

#include <charconv>
#include <chrono>
#include <cmath>

namespace palpate::study {
namespace {

bool is_number(std::string_view cell) {
  double value = 0;
  const auto [end, error] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size();
}

std::string csv_cell(const std::string& cell) {
  std::string text;
  if (!cell.empty() && std::string_view("=+-@\t\r").find(cell[0]) != std::string_view::npos &&
      !is_number(cell))
    text = '\'';
  text += cell;
  if (text.find_first_of(",\"\n\r") == std::string::npos) return text;
  std::string quoted = "\"";
  for (const char c : text) {
    if (c == '"') quoted += '"';
    quoted += c;
  }
  return quoted + '"';
}

std::string tsv_cell(const std::string& cell) {
  if (cell.empty()) return "n/a";
  std::string text = cell;
  for (char& c : text)
    if (static_cast<unsigned char>(c) < 0x20) c = ' ';
  return text;
}

}  // namespace

std::string number_cell(double value, std::string_view missing) {
  if (!std::isfinite(value)) return std::string(missing);
  return fmt::format("{}", value == 0 ? 0.0 : value);
}

CsvText::CsvText(std::initializer_list<std::string_view> head) {
  row(std::vector<std::string>(head.begin(), head.end()));
}
void CsvText::row(const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += ',';
    text_ += csv_cell(cells[i]);
  }
  text_ += '\n';
}

TsvText::TsvText(const std::vector<std::string>& head) {
  row(head);
}
void TsvText::row(const std::vector<std::string>& cells) {
  for (std::size_t i = 0; i < cells.size(); ++i) {
    if (i > 0) text_ += '\t';
    text_ += tsv_cell(cells[i]);
  }
  text_ += '\n';
}

std::string utc_text(std::int64_t milliseconds) {
  if (milliseconds == 0) return "";
  using namespace std::chrono;
  const sys_time<std::chrono::milliseconds> at{std::chrono::milliseconds(milliseconds)};
  const auto day = floor<days>(at);
  const year_month_day date{day};
  const hh_mm_ss time{at - day};
  return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}.{:03}Z", static_cast<int>(date.year()),
                     static_cast<unsigned>(date.month()), static_cast<unsigned>(date.day()),
                     time.hours().count(), time.minutes().count(), time.seconds().count(),
                     time.subseconds().count());
}

}  // namespace palpate::study
