// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>
#include <vector>

namespace palpate::plot::test {

/// Empty where `xml` is one element tree with matched tags, quoted attributes without '<', no
/// attribute twice, and no bare '&'; else what is wrong and where.
inline std::string xml_fault(std::string_view xml) {
  std::vector<std::string> open;
  bool seen_root = false;
  const auto fault = [](std::string_view what, std::size_t at) {
    return std::string(what) + " at byte " + std::to_string(at);
  };
  const auto entity_ok = [&](std::size_t at) {
    for (const std::string_view e : {"&amp;", "&lt;", "&gt;", "&quot;", "&#39;"})
      if (xml.substr(at, e.size()) == e) return true;
    return false;
  };
  for (std::size_t i = 0; i < xml.size(); ++i) {
    if (xml[i] == '&' && !entity_ok(i)) return fault("bare &", i);
    if (xml[i] != '<') {
      if (open.empty() && xml[i] != '\n') return fault("text outside the root", i);
      continue;
    }
    if (open.empty() && seen_root) return fault("second root", i);
    const bool closing = xml.substr(i, 2) == "</";
    std::size_t p = i + (closing ? 2 : 1);
    const std::size_t name_end = xml.find_first_of(" />\n", p);
    if (name_end == std::string_view::npos) return fault("unfinished tag", i);
    const std::string name(xml.substr(p, name_end - p));
    std::vector<std::string> attributes;
    p = name_end;
    bool empty = false;
    while (p < xml.size() && xml[p] != '>') {
      if (xml[p] == ' ' || xml[p] == '\n') {
        ++p;
      } else if (xml[p] == '/') {
        empty = true;
        ++p;
      } else {
        const std::size_t equals = xml.find('=', p);
        if (equals == std::string_view::npos || xml[equals + 1] != '"')
          return fault("attribute without a quoted value", p);
        for (const auto& a : attributes)
          if (a == xml.substr(p, equals - p)) return fault("attribute twice", p);
        attributes.emplace_back(xml.substr(p, equals - p));
        const std::size_t end = xml.find('"', equals + 2);
        if (end == std::string_view::npos) return fault("unfinished attribute", p);
        for (std::size_t k = equals + 2; k < end; ++k)
          if (xml[k] == '<' || (xml[k] == '&' && !entity_ok(k))) return fault("bare < or &", k);
        p = end + 1;
      }
    }
    if (p >= xml.size()) return fault("unfinished tag", i);
    if (closing) {
      if (open.empty() || open.back() != name) return fault("</" + name + "> closes nothing", i);
      open.pop_back();
    } else if (!empty) {
      open.push_back(name);
    }
    seen_root = true;
    i = p;
  }
  return open.empty() && seen_root ? "" : "unclosed element";
}

}  // namespace palpate::plot::test
