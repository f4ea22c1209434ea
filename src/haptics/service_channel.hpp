// SPDX-License-Identifier: Apache-2.0
// A WebSocket client for a service on this machine; private to the Inverse3 backend.
#pragma once
#include <fmt/format.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <string>

#include "core/error.hpp"

namespace palpate::haptics {

/// A WebSocket client with a deadline on each step; runs its own event loop on the caller's thread.
class ServiceChannel {
 public:
  ServiceChannel(boost::asio::io_context& io, const std::string& host, unsigned short port,
                 double timeout)
      : io_(io),
        socket_(io),
        timeout_(std::chrono::milliseconds(static_cast<int>(1000 * timeout))) {
    boost::beast::error_code error;
    const auto address = boost::asio::ip::make_address(host, error);
    if (error) throw InputError(fmt::format("'{}' is not an address", host));
    auto& tcp = boost::beast::get_lowest_layer(socket_);
    step([&](auto done) { tcp.async_connect(boost::asio::ip::tcp::endpoint(address, port), done); },
         "connect");
    boost::beast::error_code ignored;
    tcp.socket().set_option(boost::asio::ip::tcp::no_delay(true), ignored);
    const std::string where = fmt::format("{}:{}", host, port);
    step([&](auto done) { socket_.async_handshake(where, "/", done); }, "shake hands");
    socket_.read_message_max(kLargestMessage);
  }

  void send(const std::string& text) {
    step(
        [&](auto done) {
          socket_.async_write(boost::asio::buffer(text),
                              [done](boost::beast::error_code e, std::size_t) { done(e); });
        },
        "send");
  }
  [[nodiscard]] std::string receive() {
    boost::beast::flat_buffer buffer;
    step(
        [&](auto done) {
          socket_.async_read(buffer, [done](boost::beast::error_code e, std::size_t) { done(e); });
        },
        "receive");
    return boost::beast::buffers_to_string(buffer.data());
  }
  /// Reads one message whenever it comes; `told` gets it while other steps run.
  template <class Told>
  void listen(Told told) {
    boost::beast::get_lowest_layer(socket_).expires_never();
    socket_.async_read(unasked_, [this, told](boost::beast::error_code e, std::size_t) {
      if (e) return;
      told(boost::beast::buffers_to_string(unasked_.data()));
      unasked_.consume(unasked_.size());
      listen(told);
    });
  }

 private:
  static constexpr std::size_t kLargestMessage = 1 << 20;  // [byte]; an inventory has some KB

  template <class Start>
  void step(Start start, const char* what) {
    boost::beast::get_lowest_layer(socket_).expires_after(timeout_);
    bool finished = false;
    boost::beast::error_code error;
    start([&](boost::beast::error_code e) {
      error = e;
      finished = true;
    });
    io_.restart();
    while (!finished && io_.run_one() > 0) {
    }
    if (error == boost::beast::error::timeout)
      throw InputError(fmt::format("cannot {}: no answer", what));
    if (error) throw InputError(fmt::format("cannot {}: {}", what, error.message()));
  }

  boost::asio::io_context& io_;
  boost::beast::websocket::stream<boost::beast::tcp_stream> socket_;
  std::chrono::milliseconds timeout_;
  boost::beast::flat_buffer unasked_;
};

}  // namespace palpate::haptics
