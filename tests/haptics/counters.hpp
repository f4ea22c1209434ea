// SPDX-License-Identifier: Apache-2.0
// Counts what the calling thread allocates and locks while a scope lives.
#pragma once

namespace palpate::haptics {

class QuietScope {
 public:
  QuietScope();
  ~QuietScope();
  QuietScope(const QuietScope&) = delete;
  QuietScope& operator=(const QuietScope&) = delete;
  [[nodiscard]] long allocations() const;
  [[nodiscard]] long locks() const;
};

/// The same for a thread that the test does not own, from start_counting() to its end.
void start_counting();
void stop_counting();
[[nodiscard]] long counted_allocations();
[[nodiscard]] long counted_locks();

}  // namespace palpate::haptics
