// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/server.hpp"

#include <fmt/format.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <boost/asio/io_context.hpp>
#include <boost/asio/post.hpp>
#include <boost/asio/steady_timer.hpp>
#include <boost/beast/core/bind_handler.hpp>
#include <boost/beast/core/flat_buffer.hpp>
#include <boost/beast/http.hpp>
#include <boost/beast/websocket/rfc6455.hpp>
#include <optional>
#include <thread>

#include "core/error.hpp"
#include "serve/hub.hpp"

namespace palpate::serve {
namespace asio = boost::asio;
namespace beast = boost::beast;
namespace http = beast::http;
using asio::ip::tcp;

namespace {

constexpr std::uint32_t kMostHeader = 8192;             // [byte]
constexpr auto kReadTime = std::chrono::seconds(15);    // for a request to arrive
constexpr auto kWriteTime = std::chrono::seconds(300);  // for a head over a slow link
constexpr auto kAcceptPause = std::chrono::milliseconds(100);

std::string_view view(boost::string_view s) {
  return {s.data(), s.size()};
}

class HttpSession : public std::enable_shared_from_this<HttpSession> {
 public:
  HttpSession(tcp::socket socket, Hub& hub)
      : hub_(hub), count_(std::make_unique<OpenCount>(hub)), stream_(std::move(socket)) {}

  void read() {
    parser_.emplace();
    parser_->header_limit(kMostHeader);
    parser_->body_limit(0);
    stream_.expires_after(kReadTime);
    http::async_read(stream_, buffer_, *parser_,
                     beast::bind_front_handler(&HttpSession::on_read, shared_from_this()));
  }

 private:
  using Response = http::response<http::span_body<const char>>;

  void on_read(beast::error_code error, std::size_t) {
    if (error) {
      if (error != http::error::end_of_stream && error != beast::error::timeout) ++hub_.refused;
      return;
    }
    Request request = parser_->release();
    const RequestHeaders headers{view(request[http::field::host]),
                                 view(request[http::field::origin]),
                                 view(request[http::field::cookie]), view(request.target())};
    switch (judge(hub_.policy, headers)) {
      case Verdict::ok:
        return serve(std::move(request));
      case Verdict::ok_set_cookie:
        return hand_out_cookie(request);
      case Verdict::wrong_host:
        return refuse(request, "this server goes by 127.0.0.1 or localhost\n");
      case Verdict::wrong_origin:
        return refuse(request, "another site's page may not use this server\n");
      case Verdict::no_token:
        return refuse(request, "open the address that palpate printed, with its token\n");
    }
  }

  void serve(Request request) {
    const std::string path(path_of(view(request.target())));
    if (path == "/live" && hub_.live && beast::websocket::is_upgrade(request))
      return start_web_socket(std::move(stream_), std::move(request), hub_, std::move(count_));
    if (beast::websocket::is_upgrade(request) && start_channel(stream_, request, hub_, count_))
      return;
    if (request.method() != http::verb::get && request.method() != http::verb::head)
      return answer(request, http::status::method_not_allowed, kPlain, "GET or HEAD only\n");
    if (const auto made = hub_.made.find(path); made != hub_.made.end()) {
      sent_ = made->second;
      return answer(request, http::status::ok, sent_->type, sent_->bytes);
    }
    const auto file = hub_.files.find(path);
    if (file == hub_.files.end())
      return answer(request, http::status::not_found, kPlain, "no such page\n");
    answer(request, http::status::ok, file->second.type, file->second.bytes);
  }

  void hand_out_cookie(const Request& request) {
    if (hub_.live && beast::websocket::is_upgrade(request))
      return start_web_socket(std::move(stream_), request, hub_, std::move(count_));
    Response response = prepare(request, http::status::see_other, kPlain, "");
    response.set(http::field::set_cookie, fmt::format("{}={}; HttpOnly; SameSite=Strict; Path=/",
                                                      kCookieName, hub_.policy.token));
    response.set(http::field::location, std::string(path_of(view(request.target()))));
    write(std::move(response), request.method() == http::verb::head);
  }

  void refuse(const Request& request, std::string_view why) {
    ++hub_.refused;
    Response response = prepare(request, http::status::forbidden, kPlain, why);
    response.keep_alive(false);
    write(std::move(response), request.method() == http::verb::head);
  }

  void answer(const Request& request, http::status status, std::string_view type,
              std::string_view bytes) {
    write(prepare(request, status, type, bytes), request.method() == http::verb::head);
  }

  /// `bytes` must outlive the session: a file of the hub, a literal, or `sent_`.
  static Response prepare(const Request& request, http::status status, std::string_view type,
                          std::string_view bytes) {
    Response r(status, request.version());
    r.set(http::field::content_type, boost::string_view(type.data(), type.size()));
    r.set(http::field::cache_control, "no-cache");
    r.set("X-Content-Type-Options", "nosniff");
    r.set("Referrer-Policy", "no-referrer");
    r.set("Cross-Origin-Resource-Policy", "same-origin");
    r.set("Content-Security-Policy",
          "default-src 'self'; img-src 'self' data: blob:; style-src 'self' 'unsafe-inline'; "
          "object-src 'none'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'");
    r.keep_alive(request.keep_alive());
    r.body() = {bytes.data(), bytes.size()};
    r.prepare_payload();
    return r;
  }

  void write(Response response, bool head_only) {
    response_.emplace(std::move(response));
    serializer_.emplace(*response_);
    stream_.expires_after(kWriteTime);
    auto done = beast::bind_front_handler(&HttpSession::on_write, shared_from_this());
    if (head_only)
      http::async_write_header(stream_, *serializer_, std::move(done));
    else
      http::async_write(stream_, *serializer_, std::move(done));
  }

  void on_write(beast::error_code error, std::size_t) {
    if (error) return;
    if (response_->keep_alive()) return read();
    stream_.socket().shutdown(tcp::socket::shutdown_send, error);
  }

  static constexpr std::string_view kPlain = "text/plain; charset=utf-8";
  Hub& hub_;
  std::unique_ptr<OpenCount> count_;
  beast::tcp_stream stream_;
  beast::flat_buffer buffer_{2 * kMostHeader};
  std::optional<http::request_parser<http::empty_body>> parser_;
  std::shared_ptr<const PageFile> sent_;  // a newer one may take its place in the hub meanwhile
  std::optional<Response> response_;
  std::optional<http::response_serializer<http::span_body<const char>>> serializer_;
};

AccessPolicy policy_of(const ServerOptions& options) {
  beast::error_code error;
  const auto address = asio::ip::make_address(options.address, error);
  if (error)
    throw InputError(fmt::format(
        "'{}' is not a numeric address; give 127.0.0.1, 0.0.0.0 or the like", options.address));
  if (!address.is_loopback() && options.token.empty())
    throw InputError(fmt::format("{} is open to other machines: give a token", options.address));
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '-' ||
           c == '_';
  };
  constexpr std::size_t kShortestToken = 8;
  if (!options.token.empty() && (options.token.size() < kShortestToken ||
                                 !std::all_of(options.token.begin(), options.token.end(), plain)))
    throw InputError(
        fmt::format("a token has {} or more letters, digits, - and _: it is part of the address",
                    kShortestToken));
  if (options.max_connections < 1 ||
      !(options.display_rate_hz >= 1 && options.display_rate_hz <= 240))
    throw InputError("the server takes at least 1 connection and 1 to 240 states a second");
  return {address.is_loopback(), options.token};
}

}  // namespace

struct Server::Inner {
  Inner(const ServerOptions& o, PageFiles files, LiveTouch* live, Channels channels)
      : options(o),
        hub(std::move(files), policy_of(o), live, std::move(channels), o.max_connections) {
    const tcp::endpoint at(asio::ip::make_address(o.address), o.port);
    try {
      acceptor.open(at.protocol());
      acceptor.set_option(asio::socket_base::reuse_address(true));
      acceptor.bind(at);
      acceptor.listen();
      port = acceptor.local_endpoint().port();
    } catch (const boost::system::system_error& error) {
      throw InputError(fmt::format("cannot serve at {} port {}: {}; give another --port", o.address,
                                   o.port, error.code().message()));
    }
    accept();
    show();
    report();
    thread = std::thread([this] { run(); });
  }

  ~Inner() {
    context.stop();
    thread.join();
  }

  void run() {
    constexpr int kLower = 5;  // nice value: the loop and the browser come first
    setpriority(PRIO_PROCESS, static_cast<id_t>(gettid()), kLower);
    context.run();
  }

  void accept() {
    acceptor.async_accept([this](beast::error_code error, tcp::socket socket) {
      if (error) {  // out of files, or a connection that went away: others may still come
        pause.expires_after(kAcceptPause);
        pause.async_wait([this](beast::error_code stopped) {
          if (!stopped) accept();
        });
        return;
      }
      ++hub.accepted;
      beast::error_code ignored;
      socket.set_option(tcp::no_delay(true), ignored);
      if (hub.open < hub.max_connections)
        std::make_shared<HttpSession>(std::move(socket), hub)->read();
      else
        ++hub.refused;
      accept();
    });
  }

  void show() {
    using namespace std::chrono;
    display.expires_after(
        duration_cast<nanoseconds>(duration<double>(1 / options.display_rate_hz)));
    display.async_wait([this](beast::error_code stopped) {
      if (stopped) return;
      // A page may leave while it is refreshed.
      const auto open = hub.channel_pages;
      for (ChannelPage* page : open) page->refresh();
      if (hub.live) hub.live->keep();
      if (!hub.pages.empty()) {
        const auto state = std::make_shared<const std::string>(hub.live->state());
        for (Page* page : hub.pages) page->send_state(state);
      }
      show();
    });
  }

  void report() {
    health.expires_after(std::chrono::milliseconds(500));
    health.async_wait([this](beast::error_code stopped) {
      if (stopped) return;
      if (!hub.pages.empty()) {
        auto facts = hub.live->health();
        facts["pages"] = hub.pages.size();
        const auto text = std::make_shared<const std::string>(facts.dump());
        for (Page* page : hub.pages) page->send_text(text);
      }
      report();
    });
  }

  ServerOptions options;
  Hub hub;
  asio::io_context context{1};
  tcp::acceptor acceptor{context};
  asio::steady_timer pause{context}, display{context}, health{context};
  unsigned short port = 0;
  std::thread thread;
};

Server::Server(const ServerOptions& options, PageFiles files, LiveTouch& live, Channels channels)
    : inner_(std::make_unique<Inner>(options, std::move(files), &live, std::move(channels))) {}
Server::Server(const ServerOptions& options, PageFiles files, Channels channels)
    : inner_(std::make_unique<Inner>(options, std::move(files), nullptr, std::move(channels))) {}
Server::~Server() = default;

void Server::publish(std::string path, PageFile file) {
  asio::post(inner_->context, [&hub = inner_->hub, at = std::move(path),
                               made = std::make_shared<const PageFile>(std::move(file))]() mutable {
    hub.made[std::move(at)] = std::move(made);
  });
}

unsigned short Server::port() const {
  return inner_->port;
}

std::string Server::url() const {
  const auto address = asio::ip::make_address(inner_->options.address);
  const std::string host = address.is_unspecified() ? [] {
    char name[256] = "localhost";
    gethostname(name, sizeof name - 1);
    return std::string(name);
  }() : address.is_v6() ? "[" + inner_->options.address + "]" : inner_->options.address;
  const std::string& token = inner_->options.token;
  return fmt::format("http://{}:{}/{}", host, inner_->port, token.empty() ? "" : "?token=" + token);
}

Server::Counts Server::counts() const {
  const Hub& hub = inner_->hub;
  return {hub.open, hub.page_count, hub.accepted, hub.refused};
}

}  // namespace palpate::serve
