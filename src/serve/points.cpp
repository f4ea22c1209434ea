// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/points.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/error.hpp"
#include "serve/live_protocol.hpp"

namespace palpate::serve {

using nlohmann::json;

namespace {

[[noreturn]] void refuse(const std::string& why) {
  throw InputError("the page's message was not understood: " + why);
}

/// Nothing deeper than {"points": {name: [number]}} is built, whatever is sent.
json parse_shallow(std::string_view text) {
  constexpr int kDeepest = 3;
  bool deep = false;
  const auto watch = [&](int depth, json::parse_event_t event, json&) {
    const bool opens =
        event == json::parse_event_t::object_start || event == json::parse_event_t::array_start;
    deep = deep || (opens && depth >= kDeepest);
    return !deep;
  };
  json parsed = json::parse(text, watch, false);  // a number beyond a double's range is no JSON
  if (deep) refuse("it is nested too deep");
  if (!parsed.is_object()) refuse("it is not a JSON object");
  return parsed;
}

Vec3 place(const std::string& name, const json& value) {
  if (!value.is_array() || value.size() != 3) refuse(name + " is not three numbers");
  Vec3 p;
  for (int k = 0; k < 3; ++k) {
    const json& x = value[static_cast<std::size_t>(k)];
    if (!x.is_number()) refuse(name + " is not three numbers");
    p[k] = x.get<double>();
    if (!std::isfinite(p[k]) || std::abs(p[k]) > kFarthest)
      refuse(fmt::format("{} is not within {} mm", name, kFarthest));
  }
  return p;
}

std::map<std::string, Vec3> points(const json& list, const std::set<std::string>& names) {
  if (!list.is_object()) refuse("its points are no object");
  if (list.size() > kMostPoints) refuse(fmt::format("more than {} points", kMostPoints));
  std::map<std::string, Vec3> out;
  for (const auto& [name, value] : list.items()) {
    if (!names.contains(name)) refuse("it names a point that this head has not");
    out[name] = place(name, value);
  }
  return out;
}

std::optional<PointsRequest::Kind> kind_of(const json& word) {
  if (word == "save") return PointsRequest::Kind::save;
  if (word == "run") return PointsRequest::Kind::run;
  if (word == "stop") return PointsRequest::Kind::stop;
  return {};
}

}  // namespace

bool is_plain_name(std::string_view name) {
  constexpr std::size_t kLongest = 40;
  return !name.empty() && name.size() <= kLongest &&
         std::all_of(name.begin(), name.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_';
         });
}

PointsRequest parse_points_request(std::string_view text, const std::set<std::string>& names) {
  const json message = parse_shallow(text);
  const auto kind = message.contains("do") ? kind_of(message["do"]) : std::nullopt;
  if (!kind) refuse("it does not say save, run or stop");
  PointsRequest request;
  request.kind = *kind;
  const bool with_points = *kind != PointsRequest::Kind::stop;
  if (with_points != message.contains("points")) refuse("points go with save and run");
  for (const auto& [key, value] : message.items()) {
    if (key == "do") continue;
    if (key == "points") {
      request.moved = points(value, names);
    } else if (key == "replace" && *kind == PointsRequest::Kind::save && value.is_boolean()) {
      request.replace = value.get<bool>();
    } else {
      refuse("it has a key that is not known");
    }
  }
  return request;
}

}  // namespace palpate::serve
