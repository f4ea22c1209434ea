// SPDX-License-Identifier: GPL-3.0-or-later
// Every statistic and p value against SciPy and R on 1000 random data sets
// (tools/statistics_table.py).
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <vector>

#include "study/statistics/assumptions.hpp"
#include "study/statistics/correlation.hpp"
#include "study/statistics/effect_sizes.hpp"
#include "study/statistics/kendall.hpp"
#include "study/statistics/multiple_testing.hpp"
#include "study/statistics/proportions.hpp"
#include "study/statistics/psychometric.hpp"
#include "study/statistics/ranks.hpp"
#include "study/statistics/t_tests.hpp"

namespace palpate::study::statistics {
namespace {

using Values = std::vector<double>;
using Named = std::map<std::string, double>;

constexpr double kReference = 5;     ///< of the one-sample test, as in the script
constexpr double kTolerance = 1e-9;  ///< relative
/// The same number may come out as 0 there and as a rounding rest of O(1) terms here.
constexpr double kRoundingOfZero = 1e-14;

const nlohmann::json& table() {
  static const nlohmann::json t = nlohmann::json::parse(
      std::ifstream(PALPATE_SOURCE_DIR "/tests/study/reference/statistics.json"));
  return t;
}

void add_tests_of_means(Named& out, const Values& a, const Values& b, const Values& pa,
                        const Values& pb) {
  const Moments ma = moments(a), mb = moments(b);
  out["mean"] = ma.mean, out["sd"] = ma.sd;
  out["median"] = median(a), out["quartile"] = quantile(a, 0.25);
  const TTest one = one_sample_t(ma, kReference);
  out["one_t"] = one.t, out["one_p"] = one.p;
  out["one_low"] = one.interval.low + kReference, out["one_high"] = one.interval.high + kReference;
  const TTest welch = welch_t(ma, mb);
  out["welch_t"] = welch.t, out["welch_p"] = welch.p, out["welch_df"] = welch.df;
  out["welch_low"] = welch.interval.low, out["welch_high"] = welch.interval.high;
  const TTest pair = paired_t(pa, pb);
  out["pair_t"] = pair.t, out["pair_p"] = pair.p;
  out["pair_low"] = pair.interval.low, out["pair_high"] = pair.interval.high;
  out["d"] = cohen_d(ma, mb), out["g"] = hedges_g(ma, mb);
  out["dz"] = standardised_mean(moments(differences(pa, pb)));
  const SpreadTest spread = brown_forsythe(a, b);
  out["bf_f"] = spread.f, out["bf_p"] = spread.p;
  const ShapiroWilk normal = shapiro_wilk(a);
  out["sw_w"] = normal.w, out["sw_p"] = normal.p;
}

void add_tests_of_ranks(Named& out, const Values& a, const Values& b, const Values& pa,
                        const Values& pb) {
  const MannWhitney mw = mann_whitney(a, b);
  out["mw_u"] = mw.u, out["mw_p"] = mw.p, out["mw_exact"] = mw.form == RankForm::exact;
  const Wilcoxon wx = wilcoxon_signed_rank(differences(pa, pb));
  out["wx_smaller"] = std::min(wx.w_plus, wx.w_minus);
  out["wx_p"] = wx.p, out["wx_exact"] = wx.form == RankForm::exact;
  const Kendall k = kendall(pa, pb);
  out["tau"] = k.tau_b, out["tau_p"] = k.p;
  const Correlation r = pearson(pa, pb), rho = spearman(pa, pb);
  out["r"] = r.r, out["r_p"] = r.p, out["r_low"] = r.interval.low, out["r_high"] = r.interval.high;
  out["rho"] = rho.r, out["rho_p"] = rho.p;
  const Line line = fitted_line(pa, pb);
  out["intercept"] = line.intercept, out["slope"] = line.slope;
  std::size_t successes = 0;
  for (const double v : a) successes += v >= kReference;
  const Proportion share = proportion(successes, a.size());
  out["wilson_low"] = share.wilson.low, out["wilson_high"] = share.wilson.high;
  out["cp_low"] = share.clopper_pearson.low, out["cp_high"] = share.clopper_pearson.high;
}

Named ours(const Values& a, const Values& b) {
  const std::size_t n = std::min(a.size(), b.size());
  const Values pa(a.begin(), a.begin() + static_cast<std::ptrdiff_t>(n));
  const Values pb(b.begin(), b.begin() + static_cast<std::ptrdiff_t>(n));
  Named out;
  add_tests_of_means(out, a, b, pa, pb);
  add_tests_of_ranks(out, a, b, pa, pb);
  const std::vector<std::string> family = {"one_p", "welch_p", "pair_p", "mw_p",
                                           "wx_p",  "tau_p",   "r_p"};
  Values p;
  for (const std::string& name : family) p.push_back(out[name]);
  const Values adjusted = holm(p);
  for (std::size_t i = 0; i < family.size(); ++i) out["holm_" + family[i]] = adjusted[i];
  return out;
}

/// Relative difference, 0 where both are the rounding of zero.
double apart(double value, double wanted) {
  const double difference = std::abs(value - wanted);
  return difference <= kRoundingOfZero ? 0 : difference / std::abs(wanted);
}

TEST(AgainstSciPyAndR, EveryStatisticAndPOfAThousandDataSets) {
  const auto& t = table();
  const auto names = t["names"].get<std::vector<std::string>>();
  std::size_t compared = 0, tied = 0, exact = 0;
  double worst = 0;
  std::string worst_name;
  for (const auto& set : t["sets"]) {
    const Named found = ours(set["a"].get<Values>(), set["b"].get<Values>());
    ASSERT_EQ(found.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      const auto& wanted = set["r"][i];
      const double value = found.at(names[i]);
      if (wanted.is_null()) {
        EXPECT_TRUE(std::isnan(value)) << names[i] << " = " << value << " of " << set["a"].dump();
        continue;
      }
      const double error = apart(value, wanted.get<double>());
      EXPECT_LE(error, kTolerance) << names[i] << ": " << value << " and not " << wanted << " of "
                                   << set["a"].dump() << set["b"].dump();
      if (error > worst) worst = error, worst_name = names[i];
      ++compared;
    }
    (found.at("mw_exact") == 1 ? exact : tied) += 1;
  }
  EXPECT_EQ(t["sets"].size(), 1000U);
  EXPECT_GT(tied, 400U);
  EXPECT_GT(exact, 100U);
  RecordProperty("worst", std::to_string(worst));
  std::printf(
      "%zu values compared, worst relative difference %.1e (%s); %zu sets with ties or large, %zu "
      "exact\n",
      compared, worst, worst_name.c_str(), tied, exact);
}

TEST(AgainstSciPyAndR, WeberFractionAndItsInterval) {
  double worst = 0;
  for (const auto& run : table()["forced_choice"]) {
    std::vector<ForcedChoice> choices;
    for (std::size_t i = 0; i < run["level"].size(); ++i)
      choices.push_back({run["level"][i].get<double>(), run["correct"][i].get<int>() == 1});
    const PsychometricFit fit = fit_weber_fraction(choices);
    for (const auto& [value, wanted] : {std::pair{fit.weber_fraction, run["w"].get<double>()},
                                        std::pair{fit.interval.low, run["low"].get<double>()},
                                        std::pair{fit.interval.high, run["high"].get<double>()}}) {
      EXPECT_LE(apart(value, wanted), kTolerance);
      worst = std::max(worst, apart(value, wanted));
    }
    EXPECT_GE(fit.shape_p, 0);
    EXPECT_LE(fit.shape_p, 1);
  }
  std::printf("worst relative difference %.1e\n", worst);
}

}  // namespace
}  // namespace palpate::study::statistics
