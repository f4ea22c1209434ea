// SPDX-License-Identifier: GPL-3.0-or-later
// Landmarks moved over the page's socket, as `palpate view` keeps and fits them.
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>

#include "core/atomic_file.hpp"
#include "io/head_file.hpp"
#include "serve/raw_client.hpp"
#include "serve/real_head.hpp"

namespace palpate {
namespace {
namespace fs = std::filesystem;
using nlohmann::json;
using serve::raw::Client;
using serve::raw::frame;

/// `palpate view` of a head, ended with the test.
class Viewer {
 public:
  explicit Viewer(const fs::path& head) {
    std::string command = PALPATE_PROGRAM;
    command.append(" view '").append(head.string());
    command.append("' --no-open --json --port 0 2>/dev/null & echo $!; wait");
    pipe_ = popen(command.c_str(), "r");
    char line[512] = {};
    if (fgets(line, sizeof line, pipe_)) pid_ = std::atoi(line);
    if (fgets(line, sizeof line, pipe_)) {
      const std::string url = json::parse(line)["url"];
      port_ = static_cast<unsigned short>(
          std::stoi(url.substr(url.rfind(':') + 1)));  // http://127.0.0.1:PORT/
    }
  }
  ~Viewer() {
    if (pid_ > 0) kill(pid_, SIGINT);
    pclose(pipe_);
  }
  Viewer(const Viewer&) = delete;
  Viewer& operator=(const Viewer&) = delete;
  [[nodiscard]] unsigned short port() const { return port_; }

 private:
  FILE* pipe_ = nullptr;
  pid_t pid_ = 0;
  unsigned short port_ = 0;
};

/// The page's end of the socket: what the program posts, message by message.
class PointsPage {
 public:
  explicit PointsPage(unsigned short port) : client_(port) {
    const std::string answer =
        client_.get("/points",
                    "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                    "Sec-WebSocket-Key: dGhlIHNhbXBsZSBub25jZQ==\r\n");
    EXPECT_TRUE(answer.starts_with("HTTP/1.1 101"));
    bytes_ = answer.substr(answer.find("\r\n\r\n") + 4);  // the first state may have come along
  }
  void say(const json& message) { client_.send(frame(message.dump(), 1)); }
  void say(const std::string& text) { client_.send(frame(text, 1)); }
  /// The first state from now on that is `wanted`; null after `seconds`.
  json wait_for(const std::function<bool(const json&)>& wanted, int seconds) {
    using clock = std::chrono::steady_clock;
    const auto end = clock::now() + std::chrono::seconds(seconds);
    while (clock::now() < end && client_.open()) {
      bytes_ += client_.receive(200);
      client_.send(frame("", 0xA));  // a pong: still there
      while (const auto text = next_message()) {
        const json state = json::parse(*text, nullptr, false);
        if (state.is_object() && wanted(state)) return state;
      }
    }
    return nullptr;
  }
  /// The next note after this one.
  json note(int seconds = 20) {
    const json state = wait_for(
        [&](const json& s) { return s["note"].is_object() && s["note"]["number"] > noted_; },
        seconds);
    if (state.is_null()) return state;
    noted_ = state["note"]["number"];
    return state["note"];
  }

 private:
  /// One unmasked text frame (RFC 6455) of less than 64 KiB; what is not one yet stays.
  std::optional<std::string> next_message() {
    const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes_[i]); };
    while (bytes_.starts_with(std::string_view("\x89\0", 2))) bytes_.erase(0, 2);  // a ping
    if (bytes_.size() < 2) return {};
    std::size_t size = byte(1), head = 2;
    if (size == 126) {
      if (bytes_.size() < 4) return {};
      size = byte(2) * 256U + byte(3);
      head = 4;
    }
    if (bytes_.size() < head + size) return {};
    std::string text = bytes_.substr(head, size);
    bytes_.erase(0, head + size);
    return text;
  }

  Client client_;
  std::string bytes_;
  int noted_ = 0;
};

/// Position of the line "fixed NAME ..." [mm], scan frame; nothing where there is none.
std::optional<Vec3> fixed_point(const fs::path& file, const std::string& name, double unit_mm) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    std::istringstream words(line);
    std::string state, mark;
    Vec3 p;
    if (words >> state >> mark >> p.x() >> p.y() >> p.z() && state == "fixed" && mark == name)
      return unit_mm * p;
  }
  return {};
}

class TouchPoints : public testing::Test {
 protected:
  // Of this test and process alone: tests run side by side.
  fs::path folder_ =
      fs::path(testing::TempDir()) /
      fmt::format("palpate touch points {} {}",
                  testing::UnitTest::GetInstance()->current_test_info()->name(), getpid());
  fs::path head_file_ = folder_ / "head.glb", points_ = folder_ / "head.landmarks.txt";
  TouchableHead head_ = serve::real_head(fs::path(PALPATE_SOURCE_DIR) / "data/head.ply");
  void SetUp() override {
    fs::remove_all(folder_);
    fs::create_directories(folder_);
    io::write_head(head_file_, head_);
  }
  void TearDown() override { fs::remove_all(folder_); }
  /// A vertex of the skin `mm` above the nose tip, head frame.
  Vec3 skin_above_nose(double mm) const {
    const Vec3 wanted =
        head_.frame.to_head(head_.landmarks.at("nose_tip").position) + Vec3(0, mm, 0);
    Vec3 best = Vec3::Zero();
    for (const Vec3& p : head_.skin.points) {
      const Vec3 q = head_.frame.to_head(head_.unit_mm * p);
      if ((q - wanted).norm() < (best - wanted).norm()) best = q;
    }
    return best;
  }
  static json request(const char* what, const Vec3& nose) {
    return {{"do", what}, {"points", {{"nose_tip", {nose.x(), nose.y(), nose.z()}}}}};
  }
};

TEST_F(TouchPoints, AreKeptBesideTheHeadInTheScansOwnUnit) {
  const Viewer viewer(head_file_);
  PointsPage page(viewer.port());
  const Vec3 to = skin_above_nose(3);
  page.say(request("save", to));
  const json note = page.note();
  ASSERT_EQ(note["kind"], "saved") << note;
  const auto kept = fixed_point(points_, "nose_tip", head_.unit_mm);
  ASSERT_TRUE(kept);
  EXPECT_LT((head_.frame.to_head(*kept) - to).norm(), 1e-9);
  EXPECT_FALSE(fixed_point(points_, "eye_outer_left", head_.unit_mm)) << "not moved: found anew";
  page.say(request("save", skin_above_nose(5)));
  EXPECT_EQ(page.note()["kind"], "saved") << "its own file, again";
  write_file(points_, "# a colleague's\n");
  page.say(request("save", to));
  EXPECT_EQ(page.note()["kind"], "exists");
  EXPECT_EQ(read_file(points_), "# a colleague's\n");
  json replace = request("save", to);
  replace["replace"] = true;
  page.say(replace);
  EXPECT_EQ(page.note()["kind"], "saved");
  EXPECT_TRUE(fixed_point(points_, "nose_tip", head_.unit_mm));
  for (const auto& entry : fs::directory_iterator(folder_))
    EXPECT_TRUE(entry.path() == head_file_ || entry.path() == points_) << entry.path();
  PointsPage other(viewer.port());
  EXPECT_FALSE(
      other.wait_for([](const json& s) { return s["saved"].contains("nose_tip"); }, 20).is_null());
}

TEST_F(TouchPoints, WhatIsNoPointOfThisHeadIsRefused) {
  const Viewer viewer(head_file_);
  PointsPage page(viewer.port());
  for (const std::string& text :
       {std::string("{"), std::string(R"({"do":"save","points":{"toe":[0,0,0]}})"),
        std::string(R"({"do":"save","points":{"nose_tip":[0,0,NaN]}})"),
        std::string(R"({"do":"save","points":{"nose_tip":[0,0,900]}})")}) {  // far off the skin
    page.say(text);
    EXPECT_EQ(page.note()["kind"], "refused") << text;
  }
  EXPECT_FALSE(fs::exists(points_));
  EXPECT_FALSE(Client(viewer.port()).upgrade("Origin: http://evil.com\r\n", "/points"));
}

TEST_F(TouchPoints, AFitWithThemKeepsThemWhereTheyWerePut) {
  const Viewer viewer(head_file_);
  PointsPage page(viewer.port());
  const Vec3 to = skin_above_nose(2);
  page.say(request("run", to));
  EXPECT_FALSE(page.wait_for([](const json& s) { return s["run"].is_object(); }, 20).is_null());
  page.say(request("run", to));
  EXPECT_EQ(page.note()["kind"], "refused") << "one at a time";
  page.say(json{{"do", "stop"}});
  EXPECT_EQ(page.note()["kind"], "stopped");
  page.say(request("run", to));
  const json done = page.note(300);
  ASSERT_TRUE(done.is_object()) << "no end within five minutes";
  ASSERT_EQ(done["kind"], "fitted") << done;
  Client client(viewer.port());
  std::string file = client.get("/fit.glb");
  ASSERT_TRUE(file.starts_with("HTTP/1.1 200"));
  const auto start = file.find("\r\n\r\n") + 4;
  while (file.size() < start + 20) file += client.receive(1000);
  const std::size_t length = static_cast<unsigned char>(file[start + 12]) +
                             256U * static_cast<unsigned char>(file[start + 13]) +
                             65536U * static_cast<unsigned char>(file[start + 14]);
  for (std::string more; file.size() < start + 20 + length; file += more)
    if ((more = client.receive(5000)).empty()) break;
  const json document = json::parse(file.substr(start + 20, length), nullptr, false);
  ASSERT_TRUE(document.is_object());
  const json& nose = document["extras"]["palpate_fit"]["landmarks"]["nose_tip"]["position_mm"];
  const Vec3 there(nose[0].get<double>(), nose[1].get<double>(), nose[2].get<double>());
  EXPECT_LT((head_.frame.to_head(there) - to).norm(), 1e-6);
  const std::size_t depths = document["meshes"][1]["primitives"][0]["attributes"]["_DEPTH"];
  EXPECT_EQ(document["accessors"][depths]["count"], head_.skin.points.size());
  EXPECT_FALSE(fs::exists(points_)) << "a fit alone keeps nothing in the user's folder";
}

}  // namespace
}  // namespace palpate
