// SPDX-License-Identifier: GPL-3.0-or-later
// What a page may say about landmarks, and what is refused.
#include "serve/points.hpp"

#include <gtest/gtest.h>

#include "core/error.hpp"

namespace palpate::serve {
namespace {

const std::set<std::string> kNames = {"nose_tip", "chin"};

TEST(PointsRequest, TellsWhatIsAsked) {
  const auto save = parse_points_request(
      R"({"do":"save","points":{"nose_tip":[1.5,-2,1e2],"chin":[0,0,0]},"replace":true})", kNames);
  EXPECT_EQ(save.kind, PointsRequest::Kind::save);
  EXPECT_TRUE(save.replace);
  ASSERT_EQ(save.moved.size(), 2U);
  EXPECT_EQ(save.moved.at("nose_tip"), Vec3(1.5, -2, 100));
  const auto run = parse_points_request(R"({"do":"run","points":{}})", kNames);
  EXPECT_EQ(run.kind, PointsRequest::Kind::run);
  EXPECT_TRUE(run.moved.empty());
  EXPECT_EQ(parse_points_request(R"({"do":"stop"})", kNames).kind, PointsRequest::Kind::stop);
}

TEST(PointsRequest, EverythingElseIsRefused) {
  std::string many = R"({"do":"run","points":{"nose_tip":[0,0,0])";
  for (int i = 0; i < 100; ++i) many += ",\"n" + std::to_string(i) + "\":[0,0,0]";
  for (const std::string& text : {
           std::string(),
           std::string("{"),
           std::string("[]"),
           std::string("7"),
           std::string("\xff\xfe"),
           std::string(16000, '['),
           std::string(16000, '{'),
           std::string(R"({"do":"save"})"),
           std::string(R"({"do":"erase","points":{}})"),
           std::string(R"({"do":["save"],"points":{}})"),
           std::string(R"({"points":{"nose_tip":[0,0,0]}})"),
           std::string(R"({"do":"stop","points":{}})"),
           std::string(R"({"do":"run","points":{},"replace":true})"),
           std::string(R"({"do":"save","points":{},"replace":1})"),
           std::string(R"({"do":"save","points":{},"file":"/etc/passwd"})"),
           std::string(R"({"do":"save","points":[]})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,0,0]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,"1"]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,null]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,NaN]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,1e999]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[0,0,2001]}})"),
           std::string(R"({"do":"save","points":{"nose_tip":[[0],0,0]}})"),
           std::string(R"({"do":"save","points":{"toe":[0,0,0]}})"),
           std::string("{\"do\":\"save\",\"points\":{\"a\\nfixed chin 0 0 0\":[0,0,0]}}"),
           many + "}}",
       })
    EXPECT_THROW((void)parse_points_request(text, kNames), InputError) << text.substr(0, 80);
}

TEST(PointsRequest, PlainNamesFitIntoALine) {
  EXPECT_TRUE(is_plain_name("eye_outer_left"));
  for (const char* name : {"", "a b", "a\nb", "Nose", "nose\xc3\xa9", "../x"})
    EXPECT_FALSE(is_plain_name(name)) << name;
  EXPECT_FALSE(is_plain_name(std::string(41, 'a')));
}

}  // namespace
}  // namespace palpate::serve
