// SPDX-License-Identifier: Apache-2.0
// What the system grants a thread that must be on time.
#pragma once
#include <cstdint>
#include <string>
#include <vector>

namespace palpate::haptics {

/// [ns] of the monotonic clock.
[[nodiscard]] std::int64_t monotonic_ns() noexcept;
/// Sleeps until the monotonic clock shows `deadline_ns`; returns at once when it has passed.
void sleep_until_ns(std::int64_t deadline_ns) noexcept;

/// Asks for SCHED_FIFO at `priority` (1 to 99) for the calling thread and for locked memory for the
/// process. Returns one line per refusal, with the remedy; empty when all was granted.
[[nodiscard]] std::vector<std::string> ask_for_realtime(int priority);
/// Without a real-time priority the system rounds sleeps up by 50 us; not for the calling thread.
void sharpen_timer() noexcept;
/// Touches the stack so that the loop meets no page fault there.
void prefault_stack() noexcept;

}  // namespace palpate::haptics
