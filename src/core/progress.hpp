// SPDX-License-Identifier: Apache-2.0
// How long work tells the person in front of it how far it is, and how they stop it.
#pragma once
#include <atomic>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "core/error.hpp"

namespace palpate {

/// Handed down by reference; the default-constructed one is silent and never stops.
/// step() may be called from several threads at once.
class Progress {
 public:
  using Listener = std::function<void(std::string_view stage, double fraction)>;
  Progress() = default;
  /// @param listener  told the stage's name and the done fraction in [0, 1]; calls are serialised
  /// @param stop      set from a signal handler; may be null
  explicit Progress(Listener listener, const std::atomic<bool>* stop = nullptr)
      : listener_(std::move(listener)), stop_(stop) {}

  /// @throws Cancelled when the user asked to stop
  void step(std::string_view stage, double fraction) const {
    if (stop_ && stop_->load(std::memory_order_relaxed)) throw Cancelled();
    if (!listener_) return;
    const std::lock_guard lock(mutex_);
    listener_(stage, fraction);
  }

 private:
  Listener listener_;
  const std::atomic<bool>* stop_ = nullptr;
  mutable std::mutex mutex_;
};

}  // namespace palpate
