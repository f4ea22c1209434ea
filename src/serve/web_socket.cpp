// SPDX-License-Identifier: GPL-3.0-or-later
#include <boost/asio/buffer.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include "serve/hub.hpp"

namespace palpate::serve {
namespace beast = boost::beast;
namespace websocket = beast::websocket;

namespace {

constexpr std::size_t kMostQueued = 4;  // texts; a page that is so far behind is gone

class PageSession final : public Page, public std::enable_shared_from_this<PageSession> {
 public:
  PageSession(beast::tcp_stream stream, Hub& hub, std::unique_ptr<OpenCount> count)
      : hub_(hub),
        count_(std::move(count)),
        socket_(std::move(stream)),
        client_(hub.next_client++) {}
  ~PageSession() override {
    hub_.live->forget(client_);
    if (hub_.pages.erase(this) > 0) --hub_.page_count;
  }
  PageSession(const PageSession&) = delete;
  PageSession& operator=(const PageSession&) = delete;

  void run(const Request& request) {
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::seconds(3);  // and for a close to be answered
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    beast::get_lowest_layer(socket_).expires_never();  // the socket's own limits take over
    socket_.set_option(limits);
    socket_.read_message_max(kLongestCommand);
    socket_.binary(true);
    socket_.async_accept(request,
                         beast::bind_front_handler(&PageSession::on_accept, shared_from_this()));
  }

  void send_text(std::shared_ptr<const std::string> message) override {
    if (texts_.size() < kMostQueued) texts_.push_back(std::move(message));
    write_next();
  }
  void send_state(std::shared_ptr<const std::string> message) override {
    if (writing_ || closing_) return;
    on_its_way_ = std::move(message);
    write(true);
  }

 private:
  void on_accept(beast::error_code error) {
    if (error) return;
    hub_.pages.insert(this);
    ++hub_.page_count;
    send_text(std::make_shared<const std::string>(hub_.live->hello().dump()));
    read();
  }

  void read() {
    socket_.async_read(buffer_,
                       beast::bind_front_handler(&PageSession::on_read, shared_from_this()));
  }

  void on_read(beast::error_code error, std::size_t) {
    if (error) {
      if (broke_the_rules(error)) ++hub_.refused;
      return leave();
    }
    const auto data = buffer_.data();
    const std::string_view bytes(static_cast<const char*>(data.data()), data.size());
    const auto command = socket_.got_binary() ? parse_command(bytes) : std::nullopt;
    if (!command) return refuse();
    hub_.live->apply(*command, client_);
    buffer_.consume(buffer_.size());
    read();
  }

  void refuse() {
    ++hub_.refused;
    leave();
    socket_.async_close({websocket::close_code::policy_error, "malformed command"},
                        [self = shared_from_this()](beast::error_code) {});
  }

  /// No more states: the write that may be under way is the last to hold this session.
  void leave() {
    closing_ = true;
    texts_.clear();
    if (hub_.pages.erase(this) > 0) --hub_.page_count;
    hub_.live->forget(client_);
  }

  void write_next() {
    if (writing_ || closing_ || texts_.empty()) return;
    on_its_way_ = std::move(texts_.front());
    texts_.pop_front();
    write(false);
  }

  void write(bool binary) {
    writing_ = true;
    socket_.binary(binary);
    socket_.async_write(boost::asio::buffer(*on_its_way_),
                        beast::bind_front_handler(&PageSession::on_write, shared_from_this()));
  }

  void on_write(beast::error_code error, std::size_t) {
    writing_ = false;
    on_its_way_.reset();
    if (error) return leave();
    write_next();
  }

  Hub& hub_;
  std::unique_ptr<OpenCount> count_;
  websocket::stream<beast::tcp_stream> socket_;
  std::uint64_t client_;
  beast::flat_buffer buffer_;
  std::deque<std::shared_ptr<const std::string>> texts_;
  std::shared_ptr<const std::string> on_its_way_;
  bool writing_ = false, closing_ = false;
};

}  // namespace

void start_web_socket(beast::tcp_stream stream, Request request, Hub& hub,
                      std::unique_ptr<OpenCount> count) {
  std::make_shared<PageSession>(std::move(stream), hub, std::move(count))->run(request);
}

}  // namespace palpate::serve
