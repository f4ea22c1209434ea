// SPDX-License-Identifier: Apache-2.0
// Takes every tick from the loop and writes it to disk from a thread of its own.
#pragma once
#include <atomic>
#include <filesystem>
#include <memory>
#include <string>
#include <thread>

#include "haptics/recording.hpp"
#include "haptics/spsc_queue.hpp"

namespace palpate::haptics {

/// What the recorder notes beside the tick's own input and output.
struct TickNotes {
  std::int64_t time_ns = 0;
  std::int64_t late_ns = 0;
  std::uint32_t buttons = 0;
  std::uint8_t trip = 0;
};

/// The loop fills blocks of half a second that were allocated beforehand; the writer's thread
/// encodes, appends and syncs them. When the disk cannot keep up, ticks are dropped and counted,
/// and the next block starts with the state of that moment, so that what is there replays exactly.
class Recorder {
 public:
  /// Creates the file and starts the writer. @throws FileError  cannot create it
  Recorder(const std::filesystem::path& path, const TickSetup& setup, const std::string& device,
           double rate_hz = 1000);
  ~Recorder();  ///< finish(), with errors left in error()
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  /// For the loop's thread, around each tick: no allocation, no lock, no system call.
  void before_tick(const TickState& state) noexcept;
  void after_tick(const TickInput& input, const TickOutput& out, const TickNotes& notes) noexcept;

  /// Writes what is left and closes the file; the loop must have stopped. @throws FileError
  void finish();
  [[nodiscard]] std::uint64_t written() const { return written_.load(std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }
  /// The first failure of the writer; empty while all is well. Any thread.
  [[nodiscard]] std::string error() const;

 private:
  static constexpr std::size_t kTicksPerBlock = 500;
  static constexpr std::size_t kBlocks = 16;  // 8 s at 1 kHz before ticks are dropped
  struct Slot {
    TickState state;
    std::uint64_t dropped = 0;
    std::size_t count = 0;
    std::array<RecordedTick, kTicksPerBlock> ticks;
  };
  void write_blocks();
  void write_slot(const Slot& slot);
  void append(const std::string& bytes);

  std::filesystem::path path_;
  int file_ = -1;
  std::unique_ptr<std::array<Slot, kBlocks>> slots_;
  SpscQueue<std::size_t, kBlocks + 1> empty_, full_;
  std::size_t current_ = kBlocks;  // slot that is being filled; kBlocks for none
  std::uint64_t lost_ = 0;         // since the last block
  std::atomic<std::uint64_t> written_{0}, dropped_{0};
  std::atomic<bool> stop_{false};
  std::atomic<int> errno_{0};
  std::thread writer_;
};

}  // namespace palpate::haptics
