// SPDX-License-Identifier: GPL-3.0-or-later
// A web socket for a page that is not about the touch itself: the program posts what the page
// shows, the page's words wait until the program takes them.
#pragma once
#include <atomic>
#include <deque>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>

namespace palpate::serve {

inline constexpr std::size_t kLongestWord = 16384;  ///< [byte] of a page's message

/// All members may be called from any thread.
class Channel {
 public:
  /// @param key  a page must know it (?key=...); empty: none
  explicit Channel(std::string key = {}) : key_(std::move(key)) {}

  /// What pages show from now on. Only the latest is sent; a page that connects gets it at once.
  void post(std::string text);
  /// A picture in motion: dropped where the page has not taken the last one. Empty: nothing moves.
  void post_frame(std::string bytes);
  /// The next message of a page, in the order of arrival.
  [[nodiscard]] std::optional<std::string> take();
  [[nodiscard]] std::size_t pages() const { return pages_.load(); }

  // --- for the server
  struct Posted {
    std::uint64_t number = 0;  ///< grows with each post
    std::shared_ptr<const std::string> text;
  };
  [[nodiscard]] Posted posted() const;
  [[nodiscard]] Posted frame() const;
  /// False where too many wait: the page is too fast.
  bool put(std::string message);
  [[nodiscard]] const std::string& key() const { return key_; }
  void count(int change) { pages_ += static_cast<std::size_t>(change); }

 private:
  std::string key_;
  mutable std::mutex mutex_;
  Posted text_, frame_;
  std::deque<std::string> waiting_;
  std::atomic<std::size_t> pages_{0};
};

/// Path of the socket -> channel. The channels outlive the server.
using Channels = std::map<std::string, Channel*, std::less<>>;

}  // namespace palpate::serve
