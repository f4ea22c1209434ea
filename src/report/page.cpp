// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/page.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "plot/svg_writer.hpp"

namespace palpate::report {
namespace {

using plot::escape_xml;

constexpr std::string_view kStyle = R"css(
:root{color-scheme:light dark;--paper:#fcfcfb;--card:#fff;--ink:#1c2126;--soft:#5c6670;--line:#dfe3e6;
--good:#1f7a4d;--care:#b4541c;--good-back:#eef7f1;--care-back:#fdf3ea}
@media (prefers-color-scheme:dark){:root{--paper:#15181b;--card:#1c2024;--ink:#e6e9eb;--soft:#9aa5ae;
--line:#323940;--good:#6fcf9a;--care:#f0a06a;--good-back:#17261e;--care-back:#2a1f17}}
*{box-sizing:border-box}
body{margin:0;background:var(--paper);color:var(--ink);font:16px/1.55 system-ui,"Segoe UI","Helvetica Neue",Arial,sans-serif;
-webkit-print-color-adjust:exact;print-color-adjust:exact}
main{max-width:1040px;margin:0 auto;padding:40px 28px 80px}
h1{font-size:30px;line-height:1.2;margin:0 0 4px;letter-spacing:-.01em;overflow-wrap:anywhere}
h2{font-size:21px;margin:56px 0 10px;padding-top:14px;border-top:1px solid var(--line)}
h3{font-size:16px;margin:28px 0 8px}
p{max-width:72ch;margin:8px 0 12px}
.sub{color:var(--soft);margin:0 0 18px;max-width:none;overflow-wrap:anywhere}
nav{display:flex;flex-wrap:wrap;gap:4px 18px;font-size:14px;margin:18px 0 4px}
nav a{color:var(--soft);text-decoration:none;border-bottom:1px solid var(--line)}
.verdict{background:var(--card);border:1px solid var(--line);border-left:5px solid var(--good);border-radius:6px;padding:16px 22px 10px;margin:18px 0}
.verdict.warn{border-left-color:var(--care)}
.verdict>p{font-size:18px;font-weight:600;margin:2px 0 10px}
.sides{display:grid;grid-template-columns:1fr 1fr;gap:8px 36px}
.sides h3{margin:4px 0;font-size:14px;color:var(--good)}
.sides .care h3{color:var(--care)}
.sides ul{margin:4px 0 12px;padding-left:18px;font-size:15px}
li{margin:3px 0}
.tiles{display:grid;grid-template-columns:repeat(auto-fit,minmax(150px,1fr));gap:12px;margin:18px 0}
.tile{background:var(--card);border:1px solid var(--line);border-radius:6px;padding:12px 16px}
.tile b{display:block;font-size:24px;line-height:1.2;font-variant-numeric:tabular-nums}
.tile.care b{color:var(--care)}
.tile span{font-size:13px;color:var(--soft)}
.scroll{overflow-x:auto;margin:12px 0 18px}
table{border-collapse:collapse;font-size:14px;font-variant-numeric:tabular-nums}
th,td{padding:4px 14px 4px 0;text-align:right;border-bottom:1px solid var(--line);white-space:nowrap}
th{color:var(--soft);font-weight:600;vertical-align:bottom;white-space:normal;line-height:1.3}
th.t,td.t{text-align:left}
td.t:nth-child(2){white-space:normal}
tr.mark td{background:var(--care-back)}
table.facts td{text-align:left;white-space:normal;overflow-wrap:anywhere}
table.facts td:first-child{color:var(--soft);padding-right:28px;white-space:nowrap}
figure{margin:20px 0 26px}
figure svg{max-width:100%;height:auto;display:block}
.row{display:grid;gap:10px;align-items:end}
.row>div{text-align:center}
.row img{width:100%;height:auto;display:block}
.row small{color:var(--soft)}
figcaption{font-size:14px;color:var(--soft);margin-top:8px;max-width:80ch}
ul.care li::marker{color:var(--care)}
details{margin:10px 0}summary{cursor:pointer;color:var(--soft);font-size:15px}
@media (max-width:700px){main{padding:22px 14px 40px}.sides{grid-template-columns:1fr}}
@media print{:root{color-scheme:light;--paper:#fff;--card:#fff;--ink:#111;--soft:#555;--line:#ccc;--good:#1f7a4d;--care:#b4541c;--care-back:#fdf3ea}
body{font-size:10.5pt}main{max-width:none;padding:0}nav{display:none}h2{margin-top:26px;break-after:avoid}
h3{break-after:avoid}figure,.verdict,.tiles,tr{break-inside:avoid}.scroll{overflow:visible}}
)css";

std::string_view open_cell(bool text) {
  return text ? "<td class=\"t\">" : "<td>";
}

}  // namespace

Page::Page(std::string_view title, std::string_view subtitle)
    : title_(escape_xml(title)), subtitle_(escape_xml(subtitle)) {}

void Page::section(std::string_view id, std::string_view title) {
  if (in_section_) body_ += "</section>\n";
  in_section_ = true;
  body_ += fmt::format("<section id=\"{}\">\n<h2>{}</h2>\n", escape_xml(id), escape_xml(title));
  contents_ += fmt::format("<a href=\"#{}\">{}</a>\n", escape_xml(id), escape_xml(title));
}

void Page::subsection(std::string_view title) {
  body_ += fmt::format("<h3>{}</h3>\n", escape_xml(title));
}

void Page::paragraph(std::string_view text) {
  body_ += fmt::format("<p>{}</p>\n", escape_xml(text));
}

void Page::list(const std::vector<std::string>& items, std::string_view css_class) {
  body_ += css_class.empty() ? "<ul>\n" : fmt::format("<ul class=\"{}\">\n", css_class);
  for (const std::string& item : items) body_ += fmt::format("<li>{}</li>\n", escape_xml(item));
  body_ += "</ul>\n";
}

void Page::tiles(const std::vector<Tile>& tiles) {
  body_ += "<div class=\"tiles\">\n";
  for (const Tile& t : tiles)
    body_ += fmt::format("<div class=\"tile{}\"><b>{}</b><span>{}</span></div>\n",
                         t.good ? "" : " care", escape_xml(t.value), escape_xml(t.label));
  body_ += "</div>\n";
}

void Page::verdict(std::string_view headline, bool sound, const std::vector<std::string>& trust,
                   const std::vector<std::string>& care) {
  body_ += fmt::format("<div class=\"verdict{}\"><p>{}</p>\n<div class=\"sides\">\n",
                       sound ? "" : " warn", escape_xml(headline));
  body_ += "<div><h3>✓ Can be trusted</h3>\n";
  list(trust);
  body_ += "</div>\n<div class=\"care\"><h3>! Not, or with care</h3>\n";
  list(care);
  body_ += "</div>\n</div>\n</div>\n";
}

void Page::table(const Table& t) {
  body_ += "<div class=\"scroll\"><table>\n<thead><tr>";
  for (std::size_t i = 0; i < t.head.size(); ++i)
    body_ += fmt::format("<th{}>{}</th>", i < t.text_columns ? " class=\"t\"" : "",
                         escape_xml(t.head[i]));
  body_ += "</tr></thead>\n<tbody>\n";
  for (std::size_t r = 0; r < t.rows.size(); ++r) {
    const bool marked = std::find(t.marked.begin(), t.marked.end(), r) != t.marked.end();
    body_ += marked ? "<tr class=\"mark\">" : "<tr>";
    for (std::size_t i = 0; i < t.rows[r].size(); ++i)
      body_ += fmt::format("{}{}</td>", open_cell(i < t.text_columns), escape_xml(t.rows[r][i]));
    body_ += "</tr>\n";
  }
  body_ += "</tbody></table></div>\n";
}

void Page::facts(const std::vector<std::pair<std::string, std::string>>& rows) {
  if (rows.empty()) return;
  body_ += "<div class=\"scroll\"><table class=\"facts\"><tbody>\n";
  for (const auto& [name, value] : rows)
    body_ += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", escape_xml(name), escape_xml(value));
  body_ += "</tbody></table></div>\n";
}

void Page::figure(std::string_view svg_html, std::string_view caption) {
  body_ += fmt::format("<figure>{}", svg_html);
  if (!caption.empty()) body_ += fmt::format("<figcaption>{}</figcaption>", escape_xml(caption));
  body_ += "</figure>\n";
}

void Page::pictures(const std::vector<Picture>& pictures, std::string_view legend_svg_html,
                    std::string_view caption) {
  body_ +=
      fmt::format("<figure><div class=\"row\" style=\"grid-template-columns:repeat({},1fr)\">\n",
                  std::max<std::size_t>(1, pictures.size()));
  for (const Picture& p : pictures)
    body_ += fmt::format("<div><img alt=\"{0}\" src=\"{1}\"><small>{0}</small></div>\n",
                         escape_xml(p.caption), p.data_url);
  body_ += fmt::format("</div>\n{}", legend_svg_html);
  if (!caption.empty()) body_ += fmt::format("<figcaption>{}</figcaption>", escape_xml(caption));
  body_ += "</figure>\n";
}

void Page::begin_details(std::string_view summary) {
  body_ += fmt::format("<details><summary>{}</summary>\n", escape_xml(summary));
}
void Page::end_details() {
  body_ += "</details>\n";
}

std::string Page::finish() && {
  if (in_section_) body_ += "</section>\n";
  const auto first = body_.find("<section");
  const std::size_t head_end = first == std::string::npos ? body_.size() : first;
  return fmt::format(
      "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
      "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n"
      "<title>{0}</title>\n<style>{1}</style>\n</head>\n<body>\n<main>\n<h1>{0}</h1>\n"
      "<p class=\"sub\">{2}</p>\n{3}<nav>\n{4}</nav>\n{5}</main>\n</body>\n</html>\n",
      title_, kStyle, subtitle_, std::string_view(body_).substr(0, head_end), contents_,
      std::string_view(body_).substr(head_end));
}

}  // namespace palpate::report
