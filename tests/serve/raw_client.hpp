// SPDX-License-Identifier: GPL-3.0-or-later
// A client without manners, for the tests and the benchmark of the server: it sends the bytes that
// it is given.
#pragma once
#include <arpa/inet.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <array>
#include <random>
#include <string>
#include <string_view>

namespace palpate::serve::raw {

class Client {
 public:
  explicit Client(unsigned short port) : socket_(::socket(AF_INET, SOCK_STREAM, 0)) {
    sockaddr_in to{};
    to.sin_family = AF_INET;
    to.sin_port = htons(port);
    to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    open_ = ::connect(socket_, reinterpret_cast<const sockaddr*>(&to), sizeof to) == 0;
    const int on = 1;
    ::setsockopt(socket_, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
  }
  ~Client() {
    // Where the server has not closed: reset instead of a lingering close, since a flood would use
    // up the ports.
    const linger now{1, 0};
    if (open_) ::setsockopt(socket_, SOL_SOCKET, SO_LINGER, &now, sizeof now);
    ::close(socket_);
  }
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  [[nodiscard]] bool open() const { return open_; }
  bool send(std::string_view bytes) {
    while (!bytes.empty()) {
      const ssize_t n = ::send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (n <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(n));
    }
    return true;
  }
  /// What has come within `ms`; empty after that, or at the end.
  std::string receive(int ms) {
    pollfd p{socket_, POLLIN, 0};
    if (::poll(&p, 1, ms) <= 0) return {};
    std::string bytes(65536, '\0');
    const ssize_t n = ::recv(socket_, bytes.data(), bytes.size(), 0);
    open_ = n > 0;
    bytes.resize(n > 0 ? static_cast<std::size_t>(n) : 0);
    return bytes;
  }
  /// Reads on until `mark` has come, the end, or nothing for `ms`.
  std::string receive_until(std::string_view mark, int ms) {
    std::string all;
    while (open_ && all.find(mark) == std::string::npos) {
      const std::string more = receive(ms);
      if (more.empty()) break;
      all += more;
    }
    return all;
  }
  /// The server has closed within `ms`.
  bool closed_within(int ms) {
    for (int i = 0; i < 200 && open_; ++i)
      if (receive(ms).empty()) break;
    return !open_;
  }
  std::string get(std::string_view target, std::string_view more_headers = "",
                  std::string_view host = "localhost") {
    std::string request = "GET ";
    request.append(target).append(" HTTP/1.1\r\nHost: ").append(host).append("\r\n");
    request.append(more_headers).append("\r\n");
    send(request);
    return receive_until("\r\n\r\n", 3000);
  }
  bool upgrade(std::string_view more_headers = "", std::string_view target = "/live") {
    std::string headers =
        "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
        "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n";
    headers += more_headers;
    return get(target, headers).starts_with("HTTP/1.1 101");
  }

 private:
  int socket_;
  bool open_ = false;
};

/// One client-to-server frame as RFC 6455 wants it.
inline std::string frame(std::string_view payload, unsigned opcode = 2, bool masked = true) {
  std::string f;
  f += static_cast<char>(0x80U | opcode);
  f += static_cast<char>((masked ? 0x80U : 0U) | payload.size());  // below 126
  const std::array<char, 4> mask = {'\x12', '\x34', '\x56', '\x78'};
  if (masked) f.append(mask.data(), mask.size());
  for (std::size_t i = 0; i < payload.size(); ++i)
    f += masked ? static_cast<char>(payload[i] ^ mask[i % 4]) : payload[i];
  return f;
}

/// A frame that no server should accept: a broken header, or a message that is no command.
inline std::string malformed(std::mt19937_64& random) {
  std::string payload(8 + random() % 33, '\0');
  for (char& c : payload) c = static_cast<char>(random());
  payload[3] = '\x7f';  // no command is of this kind
  switch (random() % 8) {
    case 0:
      return frame(payload, 2, false);  // not masked
    case 1:
      return frame(payload, 3 + random() % 5);  // reserved opcode
    case 2: {
      std::string f = frame(payload);
      f[0] = static_cast<char>(f[0] | 0x70);  // reserved bits
      return f;
    }
    case 3:  // announces 2^60 bytes
      return std::string("\x82\xff\x10\x00\x00\x00\x00\x00\x00\x00", 10) + payload;
    case 4:
      return frame(payload, 1);  // text
    case 5: {
      std::string f = frame(payload, 9);
      f[0] = '\x09';  // a ping in pieces
      return f;
    }
    case 6:
      return frame(payload.substr(0, random() % 8));  // too short
    default:
      return frame(payload);
  }
}

}  // namespace palpate::serve::raw
