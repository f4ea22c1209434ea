// SPDX-License-Identifier: GPL-3.0-or-later
// The study file: one SQLite database per study (docs/formats.md, study file).
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "study/records.hpp"

namespace palpate::study {

inline constexpr int kStoreVersion = 2;  ///< of the schema; PRAGMA user_version

/// An order as it was drawn for one participant; written when they enrol and never changed.
struct PlannedOrder {
  std::string part;
  int round = 1;                     ///< 1-based; a tutorial has several
  std::vector<std::string> regions;  ///< in the order of appearance
};

/// All members are for one thread at a time. Every writing member commits before it returns.
class Store {
 public:
  enum class Access {
    read,  ///< beside a runner or another reader; changes nothing
    run,   ///< one at a time: a second one is refused
  };
  /// How hard a commit tries: `full` survives a power cut, `process` a kill of the program.
  enum class Durability { full, process };

  /// @throws InputError  the file exists already
  /// @throws FileError   it cannot be written
  [[nodiscard]] static Store create(const std::filesystem::path& path, const Study& study,
                                    Durability durability = Durability::full);
  /// Brings an older schema up to date when opened to run.
  /// @throws InputError  not a study file; damaged or cut short; of a later version; of an older
  ///                     version (when reading); in use by another runner. One line, file untouched
  [[nodiscard]] static Store open(const std::filesystem::path& path, Access access,
                                  Durability durability = Durability::full);
  Store(Store&&) noexcept;
  Store& operator=(Store&&) noexcept;
  ~Store();

  // --- reading. Orders: participants as enrolled; all else per participant in order of time.
  [[nodiscard]] Study study() const;
  [[nodiscard]] std::vector<Participant> participants() const;
  [[nodiscard]] std::vector<Session> sessions() const;
  [[nodiscard]] std::vector<TrialRecord> trials() const;
  [[nodiscard]] std::vector<Choice> choices() const;
  [[nodiscard]] std::vector<Comparison> comparisons() const;
  [[nodiscard]] std::vector<Answer> answers() const;
  [[nodiscard]] std::vector<Answer> answers(const std::string& pseudonym) const;
  [[nodiscard]] std::vector<PlannedOrder> plan(const std::string& pseudonym) const;
  [[nodiscard]] std::vector<Event> events() const;
  /// Summaries of all blocks of a trial, or of all trials where `trial` is 0, without their
  /// samples.
  [[nodiscard]] std::vector<SampleBlock> block_summaries(std::int64_t trial = 0) const;
  /// Calls `visit` with each block, samples decoded; one block in memory at a time.
  /// @throws InputError  a block whose check sum fails; names its trial
  void for_each_block(std::int64_t trial,
                      const std::function<void(const SampleBlock&)>& visit) const;

  // --- writing; needs Access::run.
  /// Takes the next pseudonym and order index. @param orders  recorded as drawn
  Participant enrol(bool simulated, const std::vector<PlannedOrder>& orders);
  /// The next participant's order index: 0 for the first.
  [[nodiscard]] int next_order_index() const;
  [[nodiscard]] std::int64_t begin_session(const std::string& pseudonym);
  void end_session(std::int64_t session);
  /// Begins a trial, or another attempt at it where one was cut short. Gives the trial's id.
  [[nodiscard]] std::int64_t begin_trial(std::int64_t session, const TrialRecord& trial);
  void end_trial(std::int64_t trial);
  /// @param trial  that it is about; 0 for none
  /// @throws InputError  the screen was answered before
  void add_answer(std::int64_t session, std::int64_t trial, const Answer& answer);
  /// Appends to the trial's blocks; at most a second of ticks.
  void add_samples(std::int64_t trial, std::span<const HapticSample> samples);
  void set_state(const std::string& pseudonym, ParticipantState state);
  void set_simulation(const std::string& json);
  void add_event(const std::string& pseudonym, const std::string& kind, const std::string& detail);
  /// Deletes all that came from the participant, overwrites it on disk and empties the log. What
  /// stays: pseudonym, order index and the time of the withdrawal.
  /// @throws InputError  there is no such participant
  void withdraw(const std::string& pseudonym);

  [[nodiscard]] const std::filesystem::path& path() const;

 private:
  struct Inner;
  explicit Store(std::unique_ptr<Inner> inner);
  std::unique_ptr<Inner> inner_;
};

/// What is wrong with a study file, one line each, after SQLite's own integrity check and ours:
/// check sums of answers, protocol and sample blocks, gaps between blocks, answers without a place
/// in the protocol's order, orders that are not permutations. Empty: nothing. Changes nothing.
/// @throws InputError  the file cannot be opened as a study at all
[[nodiscard]] std::vector<std::string> check_store(const std::filesystem::path& path);

/// [ms] now, UTC.
[[nodiscard]] Moment now();

}  // namespace palpate::study
