// SPDX-License-Identifier: GPL-3.0-or-later
// HTTP and web socket in one thread beside the touch loop.
#pragma once
#include <memory>
#include <string>

#include "serve/channel.hpp"
#include "serve/live.hpp"
#include "serve/page_files.hpp"

namespace palpate::serve {

struct ServerOptions {
  std::string address = "127.0.0.1";  ///< numeric, v4 or v6; beyond loopback only with a token
  unsigned short port = 0;            ///< 0 takes a free one
  std::string token;                  ///< empty: none, on loopback only
  std::size_t max_connections = 256;  ///< more are closed at once; >= 1
  double display_rate_hz = 60;        ///< [Hz] state messages; 1 to 240
};

/// Serves `files` and, under /live, the socket (docs/formats.md). Requests are bounded: 8 KiB of
/// header, no body, 40 bytes a message; what is malformed closes its own connection and nothing
/// else. A page that reads too slowly misses states, the others do not wait for it.
class Server {
 public:
  /// Binds and starts the thread, whose priority is lowered so that the loop comes first.
  /// @param live  outlives the server; used by the server's thread alone from here on
  /// @throws InputError  the address or port cannot be bound, or a token is missing
  /// @param channels  sockets beside /live, at their paths
  Server(const ServerOptions& options, PageFiles files, LiveTouch& live, Channels channels = {});
  /// Serves `files` and the channels' sockets at their paths, no touch.
  /// @throws InputError  as above
  Server(const ServerOptions& options, PageFiles files, Channels channels);
  ~Server();  ///< closes all connections
  Server(const Server&) = delete;
  Server& operator=(const Server&) = delete;

  /// From now on `path` gives `file`, whatever was there. From any thread.
  void publish(std::string path, PageFile file);

  [[nodiscard]] unsigned short port() const;
  /// What to type into a browser, token included.
  [[nodiscard]] std::string url() const;
  struct Counts {
    std::size_t open = 0;        ///< connections now
    std::size_t pages = 0;       ///< of these, live sockets
    std::uint64_t accepted = 0;  ///< since the start
    std::uint64_t refused = 0;   ///< closed for a malformed message or a missing right
  };
  [[nodiscard]] Counts counts() const;

 private:
  struct Inner;
  std::unique_ptr<Inner> inner_;
};

}  // namespace palpate::serve
