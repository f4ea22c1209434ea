// SPDX-License-Identifier: GPL-3.0-or-later
// What of a head can be trusted, in sentences.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "report/summary.hpp"

namespace palpate::report {

/// How the depths compare with the published table, at landmarks that have an SD and were reached.
struct DepthAgreement {
  std::size_t compared = 0;
  std::size_t within = 0;  ///< |z| <= kDepthSd
};
inline constexpr double kDepthSd = 1.5;  ///< [SD] a true skull has 87 % of its depths within
[[nodiscard]] DepthAgreement depth_agreement(const std::vector<DepthRow>& depths);
/// (depth - published) / SD [-]; NaN where there is no SD or no depth.
[[nodiscard]] double z_score(const DepthRow& row);

struct Verdict {
  std::vector<std::string> trust;  ///< what the figures of this head support
  std::vector<std::string> care;   ///< what they do not, or what no head's figures can
  bool sound = true;               ///< false where a figure misses what it should reach
};
[[nodiscard]] Verdict judge(const TouchableHead& head, const RegionSummary& summary);

}  // namespace palpate::report
