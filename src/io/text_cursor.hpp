// SPDX-License-Identifier: Apache-2.0
// Walks over text by token and by line; numbers without locale (std::from_chars).
#pragma once
#include <charconv>
#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <string_view>

namespace palpate::io {

/// A finite or non-finite number, the whole token or nothing. Too small for a double is 0, too
/// large is infinite.
[[nodiscard]] inline std::optional<double> parse_number(std::string_view token) {
  if (!token.empty() && token.front() == '+') token.remove_prefix(1);
  if (token.empty() || token.front() == '+') return std::nullopt;
  double value = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end || error == std::errc::invalid_argument) return std::nullopt;
  if (error == std::errc::result_out_of_range) {
    const std::size_t e = token.find_first_of("eE");
    const bool tiny = e != std::string_view::npos && e + 1 < token.size() && token[e + 1] == '-';
    return tiny ? 0.0 : std::numeric_limits<double>::infinity();
  }
  return value;
}

[[nodiscard]] inline std::optional<std::int64_t> parse_integer(std::string_view token) {
  if (token.size() > 1 && token.front() == '+' && token[1] != '-') token.remove_prefix(1);
  std::int64_t value = 0;
  const char* const end = token.data() + token.size();
  const auto [stop, error] = std::from_chars(token.data(), end, value);
  if (stop != end || error != std::errc()) return std::nullopt;
  return value;
}

[[nodiscard]] constexpr bool is_blank(char c) {
  return c == ' ' || c == '\t' || c == '\f' || c == '\v';
}
[[nodiscard]] constexpr bool is_line_end(char c) {
  return c == '\n' || c == '\r';
}

/// The next token of a line; empty at its end.
[[nodiscard]] inline std::string_view next_token(std::string_view& line) {
  std::size_t at = 0;
  while (at < line.size() && is_blank(line[at])) ++at;
  std::size_t end = at;
  while (end < line.size() && !is_blank(line[end])) ++end;
  const std::string_view token = line.substr(at, end - at);
  line.remove_prefix(end);
  return token;
}

/// Lines may end in LF, CRLF or CR; they are counted from 1.
class TextCursor {
 public:
  explicit TextCursor(std::string_view text) : text_(text) {}

  /// Next line without its end; false at the end of the text.
  bool next_line(std::string_view& line) {
    if (at_ >= text_.size()) return false;
    number_ = passed_ + 1;
    std::size_t end = at_;
    while (end < text_.size() && !is_line_end(text_[end])) ++end;
    line = text_.substr(at_, end - at_);
    at_ = end;
    if (at_ < text_.size()) skip_line_end();
    return true;
  }
  /// Next token across line ends; empty at the end of the text.
  std::string_view next_word() {
    while (at_ < text_.size()) {
      if (is_line_end(text_[at_]))
        skip_line_end();
      else if (is_blank(text_[at_]))
        ++at_;
      else
        break;
    }
    number_ = passed_ + 1;
    const std::size_t begin = at_;
    while (at_ < text_.size() && !is_blank(text_[at_]) && !is_line_end(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }
  /// Of the line or word read last.
  [[nodiscard]] std::size_t line_number() const { return number_; }
  [[nodiscard]] std::string_view rest() const { return text_.substr(at_); }
  /// The text's last line has no line end.
  [[nodiscard]] bool ends_open() const { return !text_.empty() && !is_line_end(text_.back()); }

 private:
  void skip_line_end() {
    at_ += (text_[at_] == '\r' && at_ + 1 < text_.size() && text_[at_ + 1] == '\n') ? 2 : 1;
    ++passed_;
  }

  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t passed_ = 0;  ///< line ends behind `at_`
  std::size_t number_ = 0;
};

}  // namespace palpate::io
