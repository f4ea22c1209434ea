// SPDX-License-Identifier: GPL-3.0-or-later
// One unknown, u = ln w. The log-likelihood is scanned on a grid (lapses can make it bend twice),
// then the zero of its derivative next to the best grid point is bracketed and bisected; ends of
// the interval are zeros of a function of u as well. Bisection of a sign is exact to the last bits
// and cannot run away.
#include "study/statistics/psychometric.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>
#include <vector>

#include "core/error.hpp"
#include "study/statistics/distributions.hpp"

namespace palpate::study::statistics {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kZ75 = 0.674489750196081743;  ///< Phi(kZ75) = 0.75

/// [ln w] searched: a ten-thousandth to a hundredfold. What lies outside is reported as unbounded.
constexpr double kLowest = -9.2, kHighest = 4.6;
constexpr int kGrid = 60;  ///< steps of 0.23 for shape 1, where one choice's term takes 2 to turn;
                           ///< a steeper shape is scanned in proportionally finer steps
/// Exponents searched for the free shape.
constexpr int kShapeSteps = 25;  ///< leave 3e-5 of ln shape; the likelihood is flat there
constexpr double kLowestShape = 0.1, kHighestShape = 10;

/// A staircase returns to its levels: their choices are counted once.
struct Level {
  double log_level = 0, right = 0, wrong = 0;
};
std::vector<Level> levels_of(std::span<const ForcedChoice> choices) {
  std::map<double, Level> levels;
  for (const ForcedChoice& c : choices) {
    Level& level = levels[c.level];
    level.log_level = std::log(c.level);
    (c.correct ? level.right : level.wrong) += 1;
  }
  std::vector<Level> out;
  for (const auto& [value, level] : levels) out.push_back(level);
  return out;
}

struct Likelihood {
  std::vector<Level> levels;
  double lapse, shape;

  /// sum of ln P(choice) at ln w = u
  [[nodiscard]] double value(double u) const {
    double sum = 0;
    for (const Level& at : levels) {
      const double arg = kZ75 * std::exp(shape * (at.log_level - u));
      if (at.right > 0) sum += at.right * std::log(0.5 * lapse + (1 - lapse) * normal_lower(arg));
      if (at.wrong > 0) sum += at.wrong * std::log(0.5 * lapse + (1 - lapse) * normal_upper(arg));
    }
    return sum;
  }
  /// d value / d u: the argument of Phi falls by shape * arg per unit of u.
  [[nodiscard]] double slope(double u) const {
    double sum = 0;
    for (const Level& at : levels) {
      const double arg = kZ75 * std::exp(shape * (at.log_level - u));
      const double density =
          std::exp(-0.5 * arg * arg) / std::sqrt(2 * std::numbers::pi) * shape * arg * (1 - lapse);
      if (density == 0) continue;
      sum -= at.right * density / (0.5 * lapse + (1 - lapse) * normal_lower(arg));
      if (at.wrong > 0) sum += at.wrong * density / (0.5 * lapse + (1 - lapse) * normal_upper(arg));
    }
    return sum;
  }
};

/// Zero of f between a and b, where its signs differ.
double bisect(double a, double b, const std::function<double(double)>& f) {
  const bool rising = f(a) < 0;
  for (int i = 0; i < 200 && std::abs(b - a) > 1e-15 * (std::abs(a) + std::abs(b)); ++i) {
    const double middle = 0.5 * (a + b);
    ((f(middle) < 0) == rising ? a : b) = middle;
  }
  return 0.5 * (a + b);
}

struct Peak {
  double u = kNan, value = -std::numeric_limits<double>::infinity();
  bool inside = false;  ///< a maximum, not an end of the range
};

Peak highest(const Likelihood& l) {
  const int steps = static_cast<int>(kGrid * std::max(1.0, l.shape));
  const double step = (kHighest - kLowest) / steps;
  int best = 0;
  Peak out;
  for (int i = 0; i <= steps; ++i)
    if (const double v = l.value(kLowest + i * step); v > out.value) out.value = v, best = i;
  out.u = kLowest + best * step;
  const double a = out.u - step, b = out.u + step;
  if (best == 0 || best == steps || !(l.slope(a) > 0) || !(l.slope(b) < 0)) return out;
  out.u = bisect(a, b, [&](double u) { return l.slope(u); });
  out.value = l.value(out.u);
  out.inside = true;
  return out;
}

Interval likelihood_interval(const Likelihood& l, const Peak& peak, double confidence) {
  const double floor = peak.value - 0.5 * chi_squared_quantile(confidence, 1);
  const auto above = [&](double u) { return l.value(u) - floor; };
  const double low_end = std::min(kLowest, peak.u), high_end = std::max(kHighest, peak.u);
  return {above(low_end) >= 0 ? 0.0 : std::exp(bisect(low_end, peak.u, above)),
          above(high_end) >= 0 ? std::numeric_limits<double>::infinity()
                               : std::exp(bisect(peak.u, high_end, above))};
}

/// Golden-section search over ln shape; each step fits w anew.
double best_shape(Likelihood l) {
  const auto value = [&](double log_shape) {
    l.shape = std::exp(log_shape);
    return highest(l).value;
  };
  const double golden = 0.5 * (std::sqrt(5.0) - 1);
  double a = std::log(kLowestShape), b = std::log(kHighestShape);
  double c = b - golden * (b - a), d = a + golden * (b - a);
  double at_c = value(c), at_d = value(d);
  for (int i = 0; i < kShapeSteps; ++i) {
    if (at_c > at_d) {
      b = d, d = c, at_d = at_c;
      c = b - golden * (b - a);
      at_c = value(c);
    } else {
      a = c, c = d, at_c = at_d;
      d = a + golden * (b - a);
      at_d = value(d);
    }
  }
  return std::exp(0.5 * (a + b));
}

void check(std::span<const ForcedChoice> choices, const PsychometricOptions& options) {
  for (std::size_t i = 0; i < choices.size(); ++i)
    if (!(choices[i].level > 0) || !std::isfinite(choices[i].level))
      throw InputError(
          fmt::format("forced choice {}: level {} must be above 0", i + 1, choices[i].level));
  if (!(options.lapse >= 0 && options.lapse < 1))
    throw InputError(fmt::format("lapse {} must be at least 0 and below 1", options.lapse));
  if (!(options.confidence > 0 && options.confidence < 1))
    throw InputError(fmt::format("confidence {} must lie between 0 and 1", options.confidence));
}

}  // namespace

double share_correct(double level, double weber_fraction, double lapse, double shape) {
  return 0.5 * lapse + (1 - lapse) * normal_lower(kZ75 * std::pow(level / weber_fraction, shape));
}

PsychometricFit fit_weber_fraction(std::span<const ForcedChoice> choices,
                                   const PsychometricOptions& options) {
  check(choices, options);
  PsychometricFit out;
  out.trials = choices.size();
  for (const ForcedChoice& c : choices) out.correct += c.correct;
  out.weber_fraction = out.shape = out.shape_p = out.log_likelihood = kNan;
  out.interval = {0, std::numeric_limits<double>::infinity()};
  if (choices.empty()) return out;

  Likelihood line{levels_of(choices), options.lapse, 1};
  const Peak peak = highest(line);
  out.log_likelihood = peak.value;
  out.interval = likelihood_interval(line, peak, options.confidence);
  if (!peak.inside) return out;
  out.weber_fraction = std::exp(peak.u);
  if (!options.check_shape) return out;

  line.shape = out.shape = best_shape(line);
  const double gain = std::max(0.0, highest(line).value - peak.value);
  out.shape_p = chi_squared_upper(2 * gain, 1);
  return out;
}

}  // namespace palpate::study::statistics
