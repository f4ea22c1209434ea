// SPDX-License-Identifier: GPL-3.0-or-later
// A page of one file: sections, tables and figures; no script, nothing from outside. It follows the
// reader's light or dark scheme and prints.
#pragma once
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate::report {

/// Text is escaped here and nowhere else; *_html arguments are taken as they are.
class Page {
 public:
  /// @param title  shown large and in the browser's tab
  Page(std::string_view title, std::string_view subtitle);

  void section(std::string_view id, std::string_view title);  ///< also an entry of the contents
  void subsection(std::string_view title);
  void paragraph(std::string_view text);
  void list(const std::vector<std::string>& items, std::string_view css_class = "");

  struct Tile {
    std::string value, label;
    bool good = true;
  };
  void tiles(const std::vector<Tile>& tiles);
  /// The box on top: what can be trusted beside what cannot.
  void verdict(std::string_view headline, bool sound, const std::vector<std::string>& trust,
               const std::vector<std::string>& care);

  struct Table {
    std::vector<std::string> head;
    std::vector<std::vector<std::string>> rows;
    std::vector<std::size_t> marked{};  ///< rows to point out
    std::size_t text_columns = 1;       ///< the first ones are text, the rest numbers
  };
  void table(const Table& table);
  /// Two columns, name and value.
  void facts(const std::vector<std::pair<std::string, std::string>>& rows);

  void figure(std::string_view svg_html, std::string_view caption);
  struct Picture {
    std::string data_url, caption;
  };
  /// Pictures side by side, with a legend under them.
  void pictures(const std::vector<Picture>& pictures, std::string_view legend_svg_html,
                std::string_view caption);
  /// Closed until clicked; open in print.
  void begin_details(std::string_view summary);
  void end_details();

  [[nodiscard]] std::string finish() &&;

 private:
  std::string title_, subtitle_, contents_, body_;
  bool in_section_ = false;
};

}  // namespace palpate::report
