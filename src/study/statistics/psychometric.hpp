// SPDX-License-Identifier: GPL-3.0-or-later
// Discrimination thresholds from two-interval forced choice: how much stiffer must the stiffer of
// two be to be told apart?
#pragma once
#include <cstddef>
#include <span>

#include "study/statistics/moments.hpp"

namespace palpate::study::statistics {

struct ForcedChoice {
  double level = 0;      ///< [-] relative difference of the two stimuli, > 0
  bool correct = false;  ///< the stiffer one was named
};

struct PsychometricOptions {
  double lapse = 0.02;  ///< [-] share of choices made without attending, half of them right;
                        ///< 0 <= lapse < 1. Without it one slip far above the threshold decides.
  double confidence = 0.95;
  bool check_shape = true;  ///< fit the free exponent too; most of the time goes there
};

struct PsychometricFit {
  std::size_t trials = 0, correct = 0;
  /// Relative difference at which an attending observer is right in 75 % of the choices; NaN where
  /// the choices do not bound it from both sides (all right, or no better than guessing).
  double weber_fraction = 0;
  Interval interval{};  ///< likelihood ratio; low 0 or high infinite where unbounded
  double log_likelihood = 0;
  /// Free exponent of the level: a test of the straight-line model. NaN with no weber_fraction
  /// or where it was not asked for.
  double shape = 0, shape_p = 0;
};

/// P(correct) = lapse/2 + (1 - lapse) Phi(z75 (level/w)^shape), shape = 1: sensitivity proportional
/// to the difference, Gaussian noise, no bias between the intervals. w maximises the likelihood;
/// the interval holds every w whose log-likelihood is within chi^2_1(confidence)/2 of the maximum.
/// @throws InputError  names the first level that is not positive, or an option out of range
/// @note Deterministic; no random numbers.
/// @cite Green & Swets 1966, "Signal Detection Theory and Psychophysics"; Wichmann & Hill 2001,
/// "The psychometric function" (lapses)
[[nodiscard]] PsychometricFit fit_weber_fraction(std::span<const ForcedChoice> choices,
                                                 const PsychometricOptions& options = {});

/// P(correct) of the model at a level.
[[nodiscard]] double share_correct(double level, double weber_fraction, double lapse,
                                   double shape = 1);

}  // namespace palpate::study::statistics
