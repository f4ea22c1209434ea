// SPDX-License-Identifier: GPL-3.0-or-later
// A press is felt as ln k + sigma n with n standard normal. Of two presses with k2 = (1 + w) k1 the
// second seems stiffer where ln(1 + w) > sigma (n1 - n2), which is 75 % of them for
// ln(1 + w) = sqrt(2) z sigma, z = 0.6745. Ratings are linear in ln k between the softest and the
// stiffest region (G. T. Fechner, 1860), with a scale of its own for each participant.
#include "study/simulated_participant.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>

#include "core/error.hpp"
#include "study/random.hpp"

namespace palpate::study {
namespace {

constexpr double kQuartile = 0.6744897501960817;  // z of 75 %

double on_scale(const Question& q, double x) {
  const double steps = std::round((std::clamp(x, q.least, q.most) - q.least) / q.step);
  return std::min(q.least + steps * q.step, q.most);
}

}  // namespace

std::string simulation_json(const SimulationOptions& o) {
  if (!(o.weber >= 0.001 && o.weber <= 2) || !(o.rating_noise >= 0 && o.rating_noise <= 5))
    throw InputError(
        "a simulated participant has a Weber fraction of 0.001 to 2 and a rating "
        "noise of 0 to 5");
  return nlohmann::json{
      {"weber_fraction", o.weber}, {"rating_noise", o.rating_noise}, {"seed", o.seed}}
      .dump();
}

SimulatedParticipant::SimulatedParticipant(const Protocol& protocol,
                                           const SimulationOptions& options, Draw draw, Felt felt)
    : protocol_(protocol),
      options_(options),
      draw_(std::move(draw)),
      felt_(std::move(felt)),
      sigma_(std::log1p(options.weber) / (std::sqrt(2.0) * kQuartile)) {}

const Part& SimulatedParticipant::part(const std::string& id) const {
  return *std::find_if(protocol_.parts.begin(), protocol_.parts.end(),
                       [&](const Part& p) { return p.id == id; });
}

const std::vector<std::string>& SimulatedParticipant::order(const std::string& id) const {
  return std::find_if(draw_.orders.begin(), draw_.orders.end(),
                      [&](const PlannedOrder& o) { return o.part == id && o.round == 1; })
      ->regions;
}

double SimulatedParticipant::percept(const std::string& key, const std::string& region,
                                     double factor) {
  Random chance(options_.seed, "percept/" + key, static_cast<std::uint64_t>(draw_.order_index));
  return std::log(felt_(region, factor)) + sigma_ * chance.normal();
}

std::pair<double, double> SimulatedParticipant::range(const Part& p) {
  double low = 1e300, high = -1e300;
  for (const std::string& region : p.regions) {
    const double x = std::log(felt_(region, 1));
    low = std::min(low, x);
    high = std::max(high, x);
  }
  return {low, std::max(high, low + 1e-3)};
}

std::string SimulatedParticipant::answer(const Screen& screen) {
  switch (screen.kind) {
    case ScreenKind::consent:
      return "given";
    case ScreenKind::question:
      return answer_question(screen);
    case ScreenKind::choose:
      return choose(screen);
    default:
      return "done";
  }
}

std::string SimulatedParticipant::answer_question(const Screen& screen) {
  const Question& q = screen.question;
  const Part& where = part(screen.part);
  if (q.id == "rating" && where.kind == PartKind::experiment) return rate(screen);
  if (q.id == "stiffer" && where.kind == PartKind::discrimination) return compare(screen);
  if (where.kind == PartKind::tutorial) {  // the gate: can the two ends be told apart?
    const auto [low, high] = range(where);
    return high - low > sigma_ ? "yes" : "no";
  }
  Random chance(options_.seed, "answer/" + screen.key,
                static_cast<std::uint64_t>(draw_.order_index));
  switch (q.type) {
    case QuestionType::choice: {
      constexpr double kFirst = 0.7;  // of the participants take the first answer
      if (chance.uniform() < kFirst) return q.options.front().id;
      return q.options[1 + chance.below(q.options.size() - 1)].id;
    }
    case QuestionType::number:
      return fmt::format("{}", on_scale(q, q.least + 0.2 * chance.uniform() * (q.most - q.least)));
    case QuestionType::rating:
      return fmt::format("{}", on_scale(q, q.most - 1.5 + chance.normal()));
    case QuestionType::text:
      break;
  }
  return q.optional ? "" : "simulated words";
}

std::string SimulatedParticipant::rate(const Screen& screen) {
  const Question& q = screen.question;
  const std::string& region = order(screen.part)[static_cast<std::size_t>(screen.place - 1)];
  const auto [low, high] = range(part(screen.part));
  Random person(options_.seed, "scale", static_cast<std::uint64_t>(draw_.order_index));
  const double width = q.most - q.least;
  const double bottom = q.least + width * std::clamp(0.10 + 0.04 * person.normal(), 0.0, 0.3);
  const double top = q.most - width * std::clamp(0.15 + 0.06 * person.normal(), 0.0, 0.4);
  const std::string touch = screen.key.substr(0, screen.key.rfind('/'));
  const double place = (percept(touch, region, 1) - low) / (high - low);
  Random chance(options_.seed, "rating/" + screen.key,
                static_cast<std::uint64_t>(draw_.order_index));
  const double noise = options_.rating_noise * chance.normal();
  return fmt::format("{}", on_scale(q, bottom + place * (top - bottom) + noise));
}

std::string SimulatedParticipant::compare(const Screen& screen) {
  // What was touched in the two intervals follows from the draw alone, as next_screen() has it.
  const std::string base = screen.key.substr(0, screen.key.rfind('/'));
  const Part& where = part(screen.part);
  const auto series = static_cast<std::size_t>(
      std::stoi(base.substr(where.id.size() + 1, base.rfind('/') - where.id.size() - 1)));
  const std::string& region = order(where.id)[series - 1];
  const double one = percept(base + "/1", region, screen.factors[0]);
  const double two = percept(base + "/2", region, screen.factors[1]);
  return one > two ? "1" : "2";
}

std::string SimulatedParticipant::choose(const Screen& screen) {
  const auto& regions = order(screen.part);
  std::vector<std::pair<double, int>> felt;
  for (int place = 1; place <= screen.places; ++place) {
    if (std::find(screen.barred.begin(), screen.barred.end(), place) != screen.barred.end())
      continue;
    const std::string key = fmt::format("{}/{}", screen.part, place);
    felt.emplace_back(percept(key, regions[static_cast<std::size_t>(place - 1)], 1), place);
  }
  const bool toughest = screen.key.ends_with("/toughest");
  std::sort(felt.begin(), felt.end());
  if (toughest) std::reverse(felt.begin(), felt.end());
  std::vector<int> places;
  for (int i = 0; i < screen.choose; ++i)
    places.push_back(felt[static_cast<std::size_t>(i)].second);
  return fmt::format("{}", fmt::join(places, ","));
}

}  // namespace palpate::study
