// SPDX-License-Identifier: GPL-3.0-or-later
// Numbers and names as people read them.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace palpate::report {

[[nodiscard]] std::string grouped(std::size_t count);         ///< 12345 -> "12 345" (thin spaces)
[[nodiscard]] std::string plain_words(std::string_view key);  ///< "nose_tip" -> "nose tip"
[[nodiscard]] std::string with_unit(
    std::string_view key);  ///< "mean_depth_mm" -> "mean depth [mm]"
[[nodiscard]] std::string fixed(double value, int decimals);  ///< "–" for NaN
[[nodiscard]] std::string plain_value(
    const nlohmann::json& v);  ///< scalars and short lists as text
/// "zy_left" -> "zygion, left (zy)"; an unknown code stays as it is.
[[nodiscard]] std::string landmark_name(std::string_view code);

}  // namespace palpate::report
