// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/report.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "report/published.hpp"
#include "report/words.hpp"
#include "scenes.hpp"

namespace palpate::report {
namespace {

struct Folder {
  std::filesystem::path path =
      std::filesystem::temp_directory_path() / ("palpate_report_test_" + std::to_string(getpid()));
  Folder() { std::filesystem::create_directories(path); }
  ~Folder() { std::filesystem::remove_all(path); }
};

std::string page_of(const TouchableHead& head) {
  const Folder folder;
  write_report(folder.path / "a.html", head, {.picture_width = 200});
  return read_file(folder.path / "a.html");
}

/// The page without its pictures' letters.
std::string text_of(std::string page) {
  for (std::size_t at = 0; (at = page.find("base64,", at)) != std::string::npos; at += 7)
    page.erase(at + 7, page.find('"', at) - at - 7);
  return page;
}

TEST(Report, HasAllSectionsAndEscapesNames) {
  const std::string page = text_of(page_of(scenes::ball_head()));
  for (const char* id : {"scan", "skull", "depth", "stiffness", "coverage", "mesh", "record"})
    EXPECT_NE(page.find(std::string("<section id=\"") + id + "\""), std::string::npos) << id;
  EXPECT_NE(page.find("<title>a&lt;b&gt;&amp;&quot;c&quot;.ply</title>"), std::string::npos);
  EXPECT_EQ(page.find("<b>&"), std::string::npos);
  EXPECT_NE(page.find("watch &lt;out&gt;"), std::string::npos);
  EXPECT_NE(page.find("2 holes were closed &lt;here&gt;"), std::string::npos);
  EXPECT_NE(page.find("zygion, left (zy)"), std::string::npos);
  EXPECT_NE(page.find("Kendall tau 1.00"), std::string::npos);
  for (const char* bad : {">nan", " nan", "\"nan", ">-nan", ">inf"})
    EXPECT_EQ(page.find(bad), std::string::npos) << bad;
}

TEST(Report, ThePublishedRecipeIsCountedAndHasNoTool) {
  TouchableHead head = scenes::ball_head();
  EXPECT_TRUE(published_loads(head).empty());
  EXPECT_NE(text_of(page_of(head)).find("travel of a sphere of radius"), std::string::npos);
  ASSERT_GE(head.map.forces.size(), 2u);
  const auto site = [](std::vector<double> u, std::vector<int> inverted, std::vector<bool> rest) {
    return nlohmann::json{{"u_mm", u}, {"inverted_tets", inverted}, {"at_rest", rest}};
  };
  head.provenance["published_sites"] = {site({1, 2}, {0, 0}, {true, true}),
                                        site({3, 9}, {0, 4}, {true, true}),  // inside out
                                        site({8}, {0}, {false})};            // went no further
  const std::vector<PublishedLoad> loads = published_loads(head);
  ASSERT_EQ(loads.size(), head.map.forces.size());
  EXPECT_EQ(loads[0].good, 2);
  EXPECT_EQ(loads[0].restless, 1);
  EXPECT_DOUBLE_EQ(loads[0].median_good_u, 2);
  EXPECT_DOUBLE_EQ(loads[0].median_u, 3);
  EXPECT_EQ(loads[1].good, 1);
  EXPECT_EQ(loads[1].inverted, 1);
  EXPECT_EQ(loads[1].restless, 1);
  EXPECT_DOUBLE_EQ(loads[1].median_good_u, 2);
  const std::string page = text_of(page_of(head));
  EXPECT_NE(page.find("<section id=\"published\""), std::string::npos);
  EXPECT_EQ(page.find("travel of a sphere of radius"), std::string::npos);
  EXPECT_NE(page.find("the force acts on that one node"), std::string::npos);
}

TEST(Report, IsOneFileWithoutScripts) {
  const std::string page = page_of(scenes::ball_head());
  EXPECT_EQ(page.find("<script"), std::string::npos);
  EXPECT_EQ(page.find("<link"), std::string::npos);
  for (std::size_t at = 0; (at = page.find("src=\"", at)) != std::string::npos; at += 5)
    EXPECT_EQ(page.compare(at + 5, 22, "data:image/png;base64,"), 0);
  for (std::size_t at = 0; (at = page.find("href=\"", at)) != std::string::npos; at += 6)
    EXPECT_TRUE(page[at + 6] == '#' || page.compare(at + 6, 5, "data:") == 0);
  for (std::size_t at = 0; (at = page.find("http", at)) != std::string::npos; at += 4)
    EXPECT_EQ(page.compare(at, 26, "http://www.w3.org/2000/svg"), 0);
}

TEST(Report, SameHeadSameBytes) {
  EXPECT_EQ(page_of(scenes::ball_head()), page_of(scenes::ball_head()));
}

TEST(Report, LeavesOutWhatAHeadDoesNotCarry) {
  auto head = scenes::ball_head();
  head.provenance = nlohmann::json::object();
  head.run = nullptr;
  head.skull = {};
  head.depths.clear();
  head.landmarks.clear();
  const std::string page = page_of(head);
  EXPECT_EQ(page.find("id=\"skull\""), std::string::npos);
  EXPECT_EQ(page.find("id=\"mesh\""), std::string::npos);
  EXPECT_NE(page.find("id=\"stiffness\""), std::string::npos);
}

TEST(Report, AHeadWithoutAnyCurveIsShownAsSuch) {
  auto head = scenes::ball_head();
  head.map.status.assign(head.map.size(), VertexStatus::failed);
  head.map.displacement.assign(head.map.displacement.size(), NAN);
  const std::string page = page_of(head);
  EXPECT_NE(page.find("with care: a check did not hold"), std::string::npos);
}

TEST(Report, RefusesAMapThatDoesNotFitAndWritesNothing) {
  const Folder folder;
  auto head = scenes::ball_head();
  head.map.depth.pop_back();
  EXPECT_THROW(write_report(folder.path / "a.html", head), InputError);
  EXPECT_THROW(write_report(folder.path / "a.html", scenes::ball_head(), {.picture_width = 1}),
               InputError);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(Report, StopsWhenTheUserStops) {
  const Folder folder;
  const std::atomic<bool> stop{true};
  EXPECT_THROW(write_report(folder.path / "a.html", scenes::ball_head(), {.picture_width = 200},
                            Progress(nullptr, &stop)),
               Cancelled);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path));
}

TEST(Words, ReadWell) {
  EXPECT_EQ(with_unit("surface_error_mean_mm"), "surface error mean [mm]");
  EXPECT_EQ(with_unit("volume_flesh_mm3"), "volume flesh [mm³]");
  EXPECT_EQ(with_unit("nodes"), "nodes");
  EXPECT_EQ(grouped(999), "999");
  EXPECT_EQ(grouped(1234567), "1\u202f234\u202f567");
  EXPECT_EQ(fixed(-0.01, 1), "0.0");
  EXPECT_EQ(fixed(NAN, 1), "–");
  EXPECT_EQ(landmark_name("g"), "glabella (g)");
  EXPECT_EQ(landmark_name("sM2_right"), "supra-M2, right (sM2)");
  EXPECT_EQ(landmark_name("own"), "own");
}

}  // namespace
}  // namespace palpate::report
