// SPDX-License-Identifier: Apache-2.0
#include "fake_inverse_service.hpp"

#include <boost/asio/ip/tcp.hpp>
#include <boost/beast/core.hpp>
#include <boost/beast/websocket.hpp>
#include <chrono>
#include <mutex>
#include <nlohmann/json.hpp>
#include <thread>
#include <vector>

namespace palpate::haptics {

namespace asio = boost::asio;
namespace beast = boost::beast;
using asio::ip::tcp;
using Socket = beast::websocket::stream<tcp::socket>;

struct FakeInverseService::Server {
  FakeInverseService& owner;
  Behaviour behaviour;
  asio::io_context io;
  tcp::acceptor simulation{io, {asio::ip::make_address("127.0.0.1"), 0}};
  tcp::acceptor events{io, {asio::ip::make_address("127.0.0.1"), 0}};
  std::atomic<bool> unplugged{false}, no_position{false}, stop{false};
  std::mutex mutex;
  std::vector<std::unique_ptr<Socket>> listeners;
  std::vector<int> open_sockets;
  std::vector<std::thread> threads;

  Server(FakeInverseService& o, const Behaviour& b) : owner(o), behaviour(b) {
    threads.emplace_back([this] { accept_simulation(); });
    threads.emplace_back([this] { accept_events(); });
  }
  ~Server() {
    stop = true;
    const std::size_t first = 2;
    for (tcp::acceptor* a : {&simulation, &events}) ::shutdown(a->native_handle(), SHUT_RDWR);
    {
      const std::lock_guard lock(mutex);
      for (const int s : open_sockets) ::shutdown(s, SHUT_RDWR);
    }
    threads[0].join();
    threads[1].join();
    for (std::size_t i = first; i < threads.size(); ++i) threads[i].join();
  }

  void accept_simulation() {
    while (!stop) {
      tcp::socket s(io);
      beast::error_code e;
      simulation.accept(s, e);
      if (e || stop) return;
      const std::lock_guard lock(mutex);
      open_sockets.push_back(::dup(s.native_handle()));
      threads.emplace_back([this, socket = std::make_shared<Socket>(std::move(s))] {
        try {
          converse(*socket);
        } catch (const std::exception&) {
          // The client went away: what a service expects.
        }
      });
    }
  }
  void accept_events() {
    while (!stop) {
      tcp::socket s(io);
      beast::error_code e;
      events.accept(s, e);
      if (e || stop) return;
      auto socket = std::make_unique<Socket>(std::move(s));
      socket->accept(e);
      const std::lock_guard lock(mutex);
      if (!e) listeners.push_back(std::move(socket));
    }
  }

  std::string state(bool inventory) const {
    if (!behaviour.speaks_json) return "hello";
    nlohmann::json device = {{"device_id", "049D"}, {"status", {{"ready", true}}}};
    if (inventory) device["config"] = {{"type", "inverse3"}, {"handedness", "right"}};
    auto& s = device["state"];
    const bool applies = behaviour.applies_force;
    if (behaviour.has_position)
      s["cursor_position"] = {{"x", owner.x.load()}, {"y", owner.y.load()}, {"z", owner.z.load()}};
    if (no_position) s["cursor_position"]["y"] = nullptr;
    s["cursor_velocity"] = {{"x", 0.1}, {"y", 0.2}, {"z", 0.3}};
    s["current_cursor_force"] = {{"x", applies ? owner.force_x.load() : 0},
                                 {"y", applies ? owner.force_y.load() : 0},
                                 {"z", applies ? owner.force_z.load() : 0}};
    nlohmann::json message = {{"inverse3", nlohmann::json::array()}};
    if (behaviour.lists_device && !unplugged) message["inverse3"].push_back(device);
    if (behaviour.lists_second) {
      device["device_id"] = "1234";
      message["inverse3"].push_back(device);
    }
    message["wireless_verse_grip"] = {
        {{"device_id", "61548"},
         {"state",
          {{"buttons", {{"a", false}, {"b", owner.button_b.load()}, {"c", false}}},
           {"orientation", {{"w", 1}, {"x", 0}, {"y", 0}, {"z", 0}}}}}}};
    return message.dump();
  }

  void converse(Socket& socket) {
    socket.accept();
    socket.write(asio::buffer(state(true)));
    for (int n = 0; !stop; ++n) {
      if (n == behaviour.close_after) return;
      beast::flat_buffer buffer;
      socket.read(buffer);
      const auto command =
          nlohmann::json::parse(beast::buffers_to_string(buffer.data()), nullptr, false);
      try {
        const auto& v =
            command.at("inverse3").at(0).at("commands").at("set_cursor_force").at("vector");
        if (command.at("inverse3").at(0).at("device_id") != "049D") ++owner.malformed;
        owner.force_x = v.at("x").get<double>();
        owner.force_y = v.at("y").get<double>();
        owner.force_z = v.at("z").get<double>();
      } catch (const std::exception&) {
        ++owner.malformed;
      }
      if (behaviour.reply_delay_ms > 0)
        std::this_thread::sleep_for(std::chrono::milliseconds(behaviour.reply_delay_ms));
      ++owner.messages;
      socket.write(asio::buffer(state(false)));
    }
  }
};

FakeInverseService::FakeInverseService(const Behaviour& behaviour)
    : server_(std::make_unique<Server>(*this, behaviour)) {}
FakeInverseService::~FakeInverseService() = default;
unsigned short FakeInverseService::port() const {
  return server_->simulation.local_endpoint().port();
}
unsigned short FakeInverseService::event_port() const {
  return server_->events.local_endpoint().port();
}
void FakeInverseService::unplug() {
  server_->unplugged = true;
}
void FakeInverseService::lose_position(bool on) {
  server_->no_position = on;
}
void FakeInverseService::trigger_safety_stop() {
  const std::lock_guard lock(server_->mutex);
  for (auto& l : server_->listeners) {
    beast::error_code e;
    l->write(asio::buffer(std::string(R"({"event":"device-safety-triggered","device_id":"049D"})")),
             e);
  }
}

}  // namespace palpate::haptics
