// SPDX-License-Identifier: GPL-3.0-or-later
#include "serve/access.hpp"

#include <gtest/gtest.h>

#include <fstream>

#include "serve/page_files.hpp"

namespace palpate::serve {
namespace {

RequestHeaders from(std::string_view host, std::string_view origin = "",
                    std::string_view target = "/", std::string_view cookie = "") {
  return {host, origin, cookie, target};
}

TEST(Access, OnlyThisMachinesNamesOnLoopback) {
  const AccessPolicy policy{true, ""};
  for (const char* host :
       {"localhost", "localhost:8733", "127.0.0.1:1", "127.0.0.2:1", "[::1]:80", "[::1]"})
    EXPECT_EQ(judge(policy, from(host)), Verdict::ok) << host;
  for (const char* host : {"", "evil.com", "localhost.evil.com", "127.0.0.1.evil.com", "[::1].x",
                           "[::1", "192.168.0.2"})
    EXPECT_EQ(judge(policy, from(host)), Verdict::wrong_host) << host;
}

TEST(Access, AnOriginMustBeOurOwn) {
  const AccessPolicy policy{true, ""};
  EXPECT_EQ(judge(policy, from("localhost:1", "http://localhost:1")), Verdict::ok);
  for (const char* origin : {"http://evil.com", "null", "http://localhost:2", "https://localhost:1",
                             "http://127.0.0.1:1", "http://localhost:1.evil.com"})
    EXPECT_EQ(judge(policy, from("localhost:1", origin)), Verdict::wrong_origin) << origin;
}

TEST(Access, BeyondLoopbackNeedsTheToken) {
  const AccessPolicy policy{false, "s3cret"};
  EXPECT_EQ(judge(policy, from("pc:1")), Verdict::no_token);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/?token=s3cre")), Verdict::no_token);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/?token=s3crets")), Verdict::no_token);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/?xtoken=s3cret")), Verdict::no_token);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/?a=b&token=s3cret")), Verdict::ok_set_cookie);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/", "a=b; palpate_token=s3cret")), Verdict::ok);
  EXPECT_EQ(judge(policy, from("pc:1", "", "/", "palpate_token=wrong; b=s3cret")),
            Verdict::no_token);
  EXPECT_EQ(judge({false, ""}, from("pc:1")), Verdict::no_token) << "no token is no key";
  EXPECT_EQ(judge({true, "s3cret"}, from("localhost")), Verdict::no_token);
}

TEST(Access, Tokens) {
  EXPECT_EQ(new_token().size(), 32U);
  EXPECT_NE(new_token(), new_token());
  EXPECT_FALSE(same_secret("", "a"));
  EXPECT_FALSE(same_secret("a", ""));
  EXPECT_TRUE(same_secret("abc", "abc"));
  for (const char* a : {"127.0.0.1", "127.8.9.1", "::1"}) EXPECT_TRUE(is_loopback(a)) << a;
  for (const char* a : {"0.0.0.0", "::", "10.0.0.1", "localhost", ""})
    EXPECT_FALSE(is_loopback(a)) << a;
}

TEST(PageFiles, HoldsTheFolderAndNothingBesideIt) {
  namespace fs = std::filesystem;
  const fs::path root = fs::temp_directory_path() / "palpate_page_test";
  fs::remove_all(root);
  fs::create_directories(root / "page" / "assets");
  std::ofstream(root / "secret.txt") << "secret";
  std::ofstream(root / "page" / "index.html") << "index";
  std::ofstream(root / "page" / "assets" / "a.js") << "script";
  fs::create_symlink(root / "secret.txt", root / "page" / "link.txt");
  fs::create_directory_symlink(root, root / "page" / "up");
  const PageFiles files = load_page(root / "page");
  EXPECT_EQ(files.size(), 3U);
  EXPECT_EQ(files.at("/").bytes, "index");
  EXPECT_EQ(files.at("/assets/a.js").type, "text/javascript; charset=utf-8");
  fs::remove_all(root);
  EXPECT_NE(load_page(root / "page").at("/").bytes.find("not built"), std::string::npos);
}

}  // namespace
}  // namespace palpate::serve
