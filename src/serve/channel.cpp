// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/channel.hpp"

#include <boost/asio/buffer.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/websocket.hpp>

#include "serve/hub.hpp"

namespace palpate::serve {
namespace beast = boost::beast;
namespace websocket = beast::websocket;

void Channel::post(std::string text) {
  const std::lock_guard lock(mutex_);
  text_ = {text_.number + 1, std::make_shared<const std::string>(std::move(text))};
}

void Channel::post_frame(std::string bytes) {
  const std::lock_guard lock(mutex_);
  if (bytes.empty() && (!frame_.text || frame_.text->empty())) return;
  frame_ = {frame_.number + 1, std::make_shared<const std::string>(std::move(bytes))};
}

std::optional<std::string> Channel::take() {
  const std::lock_guard lock(mutex_);
  if (waiting_.empty()) return {};
  std::string first = std::move(waiting_.front());
  waiting_.pop_front();
  return first;
}

bool Channel::put(std::string message) {
  constexpr std::size_t kMost = 64;
  const std::lock_guard lock(mutex_);
  if (waiting_.size() >= kMost) return false;
  waiting_.push_back(std::move(message));
  return true;
}

Channel::Posted Channel::posted() const {
  const std::lock_guard lock(mutex_);
  return text_;
}
Channel::Posted Channel::frame() const {
  const std::lock_guard lock(mutex_);
  return frame_;
}

namespace {

class ChannelSession final : public ChannelPage,
                             public std::enable_shared_from_this<ChannelSession> {
 public:
  ChannelSession(beast::tcp_stream stream, Hub& hub, Channel& channel,
                 std::unique_ptr<OpenCount> count)
      : hub_(hub), channel_(channel), count_(std::move(count)), socket_(std::move(stream)) {}
  ~ChannelSession() override { leave(); }
  ChannelSession(const ChannelSession&) = delete;
  ChannelSession& operator=(const ChannelSession&) = delete;

  void run(const Request& request) {
    websocket::stream_base::timeout limits{};
    limits.handshake_timeout = std::chrono::seconds(3);
    limits.idle_timeout = std::chrono::seconds(20);
    limits.keep_alive_pings = true;
    beast::get_lowest_layer(socket_).expires_never();
    socket_.set_option(limits);
    socket_.read_message_max(kLongestWord);
    socket_.async_accept(request,
                         beast::bind_front_handler(&ChannelSession::on_accept, shared_from_this()));
  }

  /// At display rate: the latest text if it is new, else the latest frame.
  void refresh() override {
    if (writing_ || !open_) return;
    const Channel::Posted text = channel_.posted();
    if (text.number != text_number_) {
      text_number_ = text.number;
      return write(text.text, false);
    }
    const Channel::Posted frame = channel_.frame();
    if (frame.number == frame_number_) return;
    frame_number_ = frame.number;
    if (!frame.text->empty()) write(frame.text, true);
  }

 private:
  void on_accept(beast::error_code error) {
    if (error) return;
    open_ = true;
    frame_number_ = channel_.frame().number;
    hub_.channel_pages.insert(this);
    channel_.count(1);
    refresh();
    read();
  }

  void read() {
    socket_.async_read(buffer_,
                       beast::bind_front_handler(&ChannelSession::on_read, shared_from_this()));
  }

  void on_read(beast::error_code error, std::size_t) {
    if (error) {
      if (broke_the_rules(error)) ++hub_.refused;
      return leave();
    }
    const auto data = buffer_.data();
    std::string message(static_cast<const char*>(data.data()), data.size());
    buffer_.consume(buffer_.size());
    if (socket_.got_binary() || !channel_.put(std::move(message))) {
      ++hub_.refused;
      leave();
      socket_.async_close({websocket::close_code::policy_error, "not wanted"},
                          [self = shared_from_this()](beast::error_code) {});
      return;
    }
    read();
  }

  void leave() {
    if (!open_) return;
    open_ = false;
    hub_.channel_pages.erase(this);
    channel_.count(-1);
  }

  void write(std::shared_ptr<const std::string> message, bool binary) {
    writing_ = true;
    on_its_way_ = std::move(message);
    socket_.binary(binary);
    socket_.async_write(boost::asio::buffer(*on_its_way_),
                        beast::bind_front_handler(&ChannelSession::on_write, shared_from_this()));
  }

  void on_write(beast::error_code error, std::size_t) {
    writing_ = false;
    on_its_way_.reset();
    if (error) return leave();
    refresh();
  }

  Hub& hub_;
  Channel& channel_;
  std::unique_ptr<OpenCount> count_;
  websocket::stream<beast::tcp_stream> socket_;
  beast::flat_buffer buffer_;
  std::shared_ptr<const std::string> on_its_way_;
  std::uint64_t text_number_ = 0, frame_number_ = 0;
  bool writing_ = false, open_ = false;
};

}  // namespace

bool start_channel(beast::tcp_stream& stream, const Request& request, Hub& hub,
                   std::unique_ptr<OpenCount>& count) {
  const std::string_view target(request.target().data(), request.target().size());
  const auto found = hub.channels.find(path_of(target));
  if (found == hub.channels.end()) return false;
  Channel& channel = *found->second;
  if (!channel.key().empty() && !same_secret(query_value(target, "key"), channel.key()))
    return false;
  std::make_shared<ChannelSession>(std::move(stream), hub, channel, std::move(count))->run(request);
  return true;
}

}  // namespace palpate::serve
