// SPDX-License-Identifier: GPL-3.0-or-later
// What all connections of a server share; private to this folder, used by the server's thread only
// (the counts may be read from any).
#pragma once
#include <atomic>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/http/empty_body.hpp>
#include <boost/beast/http/message.hpp>
#include <boost/beast/websocket/error.hpp>
#include <deque>
#include <set>

#include "serve/access.hpp"
#include "serve/channel.hpp"
#include "serve/live.hpp"
#include "serve/page_files.hpp"

namespace palpate::serve {

using Request = boost::beast::http::request<boost::beast::http::empty_body>;

/// One page's live socket.
class Page {
 public:
  virtual ~Page() = default;
  /// Text is kept until sent; a state is dropped while an earlier message is still on its way.
  virtual void send_text(std::shared_ptr<const std::string> message) = 0;
  virtual void send_state(std::shared_ptr<const std::string> message) = 0;
};

/// One page's socket of a channel.
class ChannelPage {
 public:
  virtual ~ChannelPage() = default;
  virtual void refresh() = 0;  ///< sends what is new
};

struct Hub {
  Hub(PageFiles page_files, AccessPolicy access, LiveTouch* live_touch, Channels all_channels,
      std::size_t most)
      : files(std::move(page_files)),
        policy(std::move(access)),
        live(live_touch),
        channels(std::move(all_channels)),
        max_connections(most) {}
  PageFiles files;
  /// Made while the server runs; before `files`. Replaced as a whole, so that who is sending an
  /// older one keeps it.
  std::map<std::string, std::shared_ptr<const PageFile>, std::less<>> made;
  AccessPolicy policy;
  LiveTouch* live;  ///< null where no touch is served
  Channels channels;
  std::set<ChannelPage*> channel_pages;
  std::size_t max_connections;
  std::set<Page*> pages;
  std::uint64_t next_client = 1;
  std::atomic<std::size_t> open{0}, page_count{0};
  std::atomic<std::uint64_t> accepted{0}, refused{0};
};

/// Whether a socket ended because of what came over it: a broken frame or one too long, to which
/// Beast has answered with the close that it deserves.
inline bool broke_the_rules(boost::beast::error_code error) {
  using boost::beast::websocket::error::closed;
  return error != closed && error.category() == boost::beast::error_code(closed).category();
}

/// Counts a connection as open while it lives.
class OpenCount {
 public:
  explicit OpenCount(Hub& hub) : hub_(hub) { ++hub_.open; }
  ~OpenCount() { --hub_.open; }
  OpenCount(const OpenCount&) = delete;
  OpenCount& operator=(const OpenCount&) = delete;

 private:
  Hub& hub_;
};

/// Answers the upgrade and lives on by itself until the connection ends.
void start_web_socket(boost::beast::tcp_stream stream, Request request, Hub& hub,
                      std::unique_ptr<OpenCount> count);

/// Takes the stream over where the request is for a channel and knows its key; else leaves it.
bool start_channel(boost::beast::tcp_stream& stream, const Request& request, Hub& hub,
                   std::unique_ptr<OpenCount>& count);

}  // namespace palpate::serve
