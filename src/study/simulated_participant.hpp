// SPDX-License-Identifier: GPL-3.0-or-later
// A participant who is a program: what people would answer if they felt as Weber's law says.
#pragma once
#include <functional>
#include <string>

#include "study/run.hpp"

namespace palpate::study {

struct SimulationOptions {
  /// [-] 0.001 to 2: of two presses one of which is (1 + weber) times as stiff, 75 % are told right
  double weber = 0.15;
  double rating_noise = 0.4;  ///< standard deviation of a rating beyond what was felt; 0 to 5
  std::uint64_t seed = 1;
};
/// For the study file. @throws InputError  an option out of range
[[nodiscard]] std::string simulation_json(const SimulationOptions& options);

/// Answers are a pure function of options, screen and what was answered before: a study that was
/// killed and goes on ends with the same answers as one that was not.
class SimulatedParticipant {
 public:
  /// [N/mm] force over depth of a press at that region, its curve times `factor`; > 0
  using Felt = std::function<double(const std::string& region, double factor)>;
  SimulatedParticipant(const Protocol& protocol, const SimulationOptions& options, Draw draw,
                       Felt felt);
  /// @param screen  not finished, not excused
  [[nodiscard]] std::string answer(const Screen& screen);
  /// ln of the stiffness as this participant has it in mind after the touch `key`.
  [[nodiscard]] double percept(const std::string& key, const std::string& region, double factor);

 private:
  [[nodiscard]] std::string answer_question(const Screen& screen);
  [[nodiscard]] std::string rate(const Screen& screen);
  [[nodiscard]] std::string compare(const Screen& screen);
  [[nodiscard]] std::string choose(const Screen& screen);
  [[nodiscard]] const Part& part(const std::string& id) const;
  [[nodiscard]] const std::vector<std::string>& order(const std::string& part) const;
  [[nodiscard]] std::pair<double, double> range(const Part& part);

  const Protocol& protocol_;
  SimulationOptions options_;
  Draw draw_;
  Felt felt_;
  double sigma_;  // of ln stiffness
};

}  // namespace palpate::study
