// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "report/figures_of_map.hpp"
#include "report/words.hpp"

namespace palpate::report {
namespace {

// What a head should reach (docs/method/tissue.md, docs/method/stiffness.md).
constexpr double kFewestWithin = 0.70, kMostWithin = 0.95;  // [-] share within kDepthSd
constexpr double kLowestTau = 0.7;                          // [-]
constexpr double kBlendingError = 0.20;                     // [-] 95th percentile
constexpr double kSureLandmark = 0.5;                       // [-] confidence
constexpr double kFailedShare = 0.01;                       // [-] of the vertices

/// Checks that failed come before what holds for every head.
class Judge {
 public:
  void say(bool good, std::string text) { (good ? trust_ : failed_).push_back(std::move(text)); }
  void care(std::string text) { care_.push_back(std::move(text)); }
  [[nodiscard]] Verdict verdict() && {
    Verdict v;
    v.sound = failed_.empty();
    v.trust = std::move(trust_);
    v.care = std::move(failed_);
    v.care.insert(v.care.end(), care_.begin(), care_.end());
    return v;
  }

 private:
  std::vector<std::string> trust_, failed_, care_;
};

void judge_curves(Judge& out, const StiffnessMap& map) {
  const double all = std::max<double>(1, static_cast<double>(map.size()));
  const auto count = [&](VertexStatus s) {
    return static_cast<std::size_t>(std::count(map.status.begin(), map.status.end(), s));
  };
  const std::size_t solved = count(VertexStatus::solved), blended = count(VertexStatus::blended);
  const double share = static_cast<double>(solved + blended) / all;
  out.say(solved > 0, fmt::format("{:.0f} % of the vertices carry a force-travel curve: {} solved "
                                  "in full, {} blended from their neighbours.",
                                  100 * share, grouped(solved), grouped(blended)));
  std::size_t on_organs = 0;
  for (std::size_t v = 0; v < map.size(); ++v) on_organs += stands_on_organ(map, v);
  const std::vector<double> error = errors_on_bone(map);
  const double p95 = quantile(error, 0.95);
  if (std::isfinite(p95))
    out.say(p95 <= kBlendingError,
            fmt::format("Estimated error of the travel between solved points: {:.1f} % (median), "
                        "{:.1f} % (95th percentile).",
                        100 * quantile(error, 0.5), 100 * p95));
  if (const std::size_t failed = count(VertexStatus::failed))
    out.say(static_cast<double>(failed) <= kFailedShare * all,
            fmt::format("{} vertices failed to converge; they carry no curve and are painted red.",
                        grouped(failed)));
  const std::size_t inverted = count(VertexStatus::inverted);
  const std::size_t restless = count(VertexStatus::unsettled);
  if (inverted + restless > 0)
    out.say(false, fmt::format("The published recipe turns tissue inside out at {} vertices and "
                               "does not come to rest at {}, pressed there or at the nearest site; "
                               "they carry no curve.",
                               grouped(inverted), grouped(restless)));
  const std::size_t none = count(VertexStatus::no_bone), held = count(VertexStatus::held);
  if (none + held > 0)
    out.care(
        fmt::format("No curve where no bone lies under the skin ({} vertices: neck, shoulders, "
                    "ears) and where other organs carry it ({}: eyes, nose, lips).",
                    grouped(none), grouped(held)));
  if (on_organs > 0)
    out.care(
        fmt::format("At {} vertices on eyes and nose, globe and cartilage carry the skin; how "
                    "far they give way is an assumption, and the error there says so.",
                    grouped(on_organs)));
}

void judge_depths(Judge& out, const std::vector<DepthRow>& depths) {
  const DepthAgreement a = depth_agreement(depths);
  if (a.compared == 0) {
    out.care("The skull was not compared with published tissue depths.");
    return;
  }
  const double share = static_cast<double>(a.within) / static_cast<double>(a.compared);
  const std::string figures =
      fmt::format("{} of {} tissue depths ({:.0f} %) lie within {} SD of the published ones",
                  a.within, a.compared, 100 * share, kDepthSd);
  if (share < kFewestWithin)
    out.say(false, figures + "; a true skull has about 87 %, so the bone is misplaced in places.");
  else if (share > kMostWithin)
    out.say(false, figures +
                       "; a true skull has about 87 %: this one is fitted to the table more "
                       "closely than real skulls are.");
  else
    out.say(true, figures + ", as those of a true skull do (about 87 %).");
}

void judge_order(Judge& out, const RegionSummary& summary) {
  if (!summary.kendall_tau) {
    out.care("Too few regions carry curves to compare their order with the published one.");
    return;
  }
  const bool all = summary.order.size() == kPublishedOrder.size();
  const bool good = *summary.kendall_tau >= kLowestTau;
  out.say(good, fmt::format(
                    "The order of {} regions from stiff to soft {} the published one: Kendall tau "
                    "{:.2f} (1 is the same order, 0 is chance){}.",
                    all ? "the seven" : fmt::format("{} of seven", summary.order.size()),
                    good ? "agrees with" : "differs from", *summary.kendall_tau,
                    summary.order.back() == SkinRegion::cheek ? "; the cheek is softest" : ""));
}

void judge_landmarks(Judge& out, const LandmarkSet& landmarks) {
  std::string unsure;
  for (const auto& [key, mark] : landmarks)
    if (mark.confidence < kSureLandmark) unsure += (unsure.empty() ? "" : ", ") + plain_words(key);
  if (!unsure.empty())
    out.say(false, fmt::format("Uncertain landmarks: {}. Check them in the picture; --landmark "
                               "name=x,y,z sets one by hand.",
                               unsure));
}

}  // namespace

double z_score(const DepthRow& row) {
  return row.sd_mm > 0 && row.reached ? (row.depth_mm - row.published_mm) / row.sd_mm : NAN;
}

DepthAgreement depth_agreement(const std::vector<DepthRow>& depths) {
  DepthAgreement a;
  for (const DepthRow& row : depths) {
    const double z = z_score(row);
    if (!std::isfinite(z)) continue;
    ++a.compared;
    a.within += std::abs(z) <= kDepthSd;
  }
  return a;
}

/// Of a face alone.
static void judge_completion(Judge& out, const std::vector<std::uint8_t>& completed) {
  const auto marked =
      static_cast<std::size_t>(std::count(completed.begin(), completed.end(), std::uint8_t{1}));
  if (marked > 0)
    out.care(
        fmt::format("The scan is a face alone and its head was completed from another: at {} of "
                    "{} vertices the result rests on skin that nobody scanned.",
                    grouped(marked), grouped(completed.size())));
}

Verdict judge(const TouchableHead& head, const RegionSummary& summary) {
  Judge out;
  judge_curves(out, head.map);
  judge_depths(out, head.depths);
  judge_order(out, summary);
  judge_landmarks(out, head.landmarks);
  judge_completion(out, head.completed);
  out.care(
      "The skull is inferred from the skin, not seen: a single depth can be several "
      "millimetres off, and the travel at that place with it.");
  out.care(
      "All flesh is one material with values from the literature: compare regions and heads, "
      "do not read the newtons as measured on this person.");
  return std::move(out).verdict();
}

}  // namespace palpate::report
