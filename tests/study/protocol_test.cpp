// SPDX-License-Identifier: GPL-3.0-or-later
// Protocols: the shipped ones are read; what is wrong is refused with its line.
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/regions.hpp"
#include "study/protocol.hpp"

namespace palpate::study {
namespace {
namespace fs = std::filesystem;

const fs::path kFolder = fs::path(PALPATE_SOURCE_DIR) / "protocols";
std::string published() {
  return read_file(kFolder / "head-stiffness-2015.toml");
}

std::string refusal(const std::string& text) {
  try {
    (void)parse_protocol(text, "p.toml");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

/// The shipped protocol with one text replaced, once.
std::string with(const std::string& old_text, const std::string& new_text) {
  std::string text = published();
  const std::size_t at = text.find(old_text);
  EXPECT_NE(at, std::string::npos) << old_text;
  return text.replace(at, old_text.size(), new_text);
}
int line_of(const std::string& text, const std::string& what) {
  return 1 + static_cast<int>(std::count(
                 text.begin(), text.begin() + static_cast<std::ptrdiff_t>(text.find(what)), '\n'));
}

TEST(Protocol, ThePublishedStudyIsWholeAndInOrder) {
  const Protocol p = read_protocol(kFolder / "head-stiffness-2015.toml");
  EXPECT_EQ(p.participants, 25);
  ASSERT_EQ(p.regions.size(), 7U);
  std::vector<std::string> ids;
  for (const Part& part : p.parts) ids.push_back(part.id);
  EXPECT_EQ(ids, (std::vector<std::string>{"consent", "background", "tutorial", "touch", "sight",
                                           "rationality", "closing"}));
  EXPECT_EQ(p.parts[2].orders, (std::vector{OrderKind::random, OrderKind::stiffness}));
  EXPECT_EQ(p.parts[2].least_s, 10);
  EXPECT_EQ(p.parts[2].most_s, 15);
  EXPECT_FALSE(p.parts[3].head_visible);
  EXPECT_TRUE(p.parts[3].where.text.empty());
  EXPECT_TRUE(p.parts[4].head_visible);
  EXPECT_FALSE(p.parts[4].where.text.empty());
  EXPECT_EQ(p.parts[3].toughest, 2);
  EXPECT_EQ(p.parts[3].rating.most, 10);
  ASSERT_EQ(p.analysis.reference_order.size(), 7U);
  for (std::size_t i = 0; i < 7; ++i)
    EXPECT_EQ(p.analysis.reference_order[i], name(kPublishedOrder[i]));
  EXPECT_EQ(p.analysis.rationality_reference, 8);
}

TEST(Protocol, EveryShippedProtocolIsRead) {
  int count = 0;
  for (const auto& entry : fs::directory_iterator(kFolder))
    if (entry.path().extension() == ".toml") {
      EXPECT_NO_THROW((void)read_protocol(entry.path())) << entry.path();
      ++count;
    }
  EXPECT_GE(count, 2);
}

// Each key of both protocols, misspelt in turn by doubling its first letter.
TEST(Protocol, AnyMisspeltKeyIsNamedWithItsLine) {
  const std::regex key("(^|[{,]\\s*)([a-z][a-z-]*)\\s*=",
                       std::regex::ECMAScript | std::regex::multiline);
  int tried = 0;
  for (const char* file : {"head-stiffness-2015.toml", "stiffness-discrimination.toml"}) {
    const std::string text = read_file(kFolder / file);
    std::vector<std::size_t> places;
    bool in_text = false, at_line_start = true;
    for (auto i = std::sregex_iterator(text.begin(), text.end(), key); i != std::sregex_iterator();
         ++i) {
      const auto at = static_cast<std::size_t>(i->position(2));
      // Words of a text block are no keys.
      std::size_t quotes = 0;
      for (std::size_t q = text.find("\"\"\""); q < at; q = text.find("\"\"\"", q + 3)) ++quotes;
      in_text = quotes % 2 == 1;
      at_line_start = (*i)[1].length() == 0;
      if (at_line_start && at > 0 && text[at - 1] != '\n') continue;
      if (!in_text) places.push_back(at);
    }
    for (const std::size_t at : places) {
      std::string broken = text;
      broken.insert(at, 1, text[at]);
      const std::string said = refusal(broken);
      const std::string word = broken.substr(at, broken.find_first_of(" =", at) - at);
      const auto line =
          1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
      // A required key is missed first, at its table's line; all others are named at their own.
      const bool named = said.starts_with("p.toml:" + std::to_string(line) + ":") &&
                         said.find(word) != std::string::npos;
      const bool missed = said.find(word.substr(1) + ": is missing") != std::string::npos ||
                          said.find("format: expects 1") != std::string::npos;
      EXPECT_TRUE(named || missed) << word << " in line " << line << ": " << said;
      EXPECT_TRUE(said.starts_with("p.toml:")) << said;
      EXPECT_EQ(said.find('\n'), std::string::npos) << said;
      ++tried;
    }
  }
  EXPECT_GT(tried, 120);
}

TEST(Protocol, RefusesWhatIsOutOfRangeAtItsLine) {
  struct Case {
    const char* old_text;
    const char* new_text;
    const char* said;
    const char* place = nullptr;  // on the line that is named, where that is not the change's
  };
  for (const Case& c : std::vector<Case>{
           {"format = 1", "format = 2", "expects 1"},
           {"participants = 25", "participants = 0", "from 1 to 9999"},
           {"participants = 25", "participants = \"many\"", "whole number"},
           {"\"cranium\", \"forehead\"", "\"cranium\", \"forhead\"", "there is no region forhead"},
           {"\"cranium\", \"forehead\"", "\"cranium\", \"cranium\"", "appears twice"},
           {"seconds = [10, 15]", "seconds = [15, 10]", "most >= least"},
           {"seconds = [10, 15]", "seconds = [10]", "expects 2 numbers"},
           {"seconds = [5, 60]", "seconds = [-5, 60]", "expects 2 numbers"},
           {"order = \"balanced\"", "order = \"balance\"", "none of random, balanced"},
           {"orders = [\"random\", \"stiffness\"]", "orders = []", "not empty"},
           {"screen = \"head\"", "screen = \"dark\"", "only where screen", "describe ="},
           {"toughest = 2", "toughest = 8", "from 0 to 7"},
           {"softest = 2", "softest = 6", "more than 7"},
           {"least = 18", "least = 218", "expects more than 218", "most = 110"},
           {"step = 0.5", "step = 0", "expects a number"},
           {"kind = \"tutorial\"", "kind = \"tutoral\"", "none of consent"},
           {"id = \"touch\"", "id = \"tutorial\"", "appears twice"},
           {"id = \"gender\"", "id = \"Gender\"", "small letters"},
           {"id = \"gender\"", "id = \"rating\"", "used by the program"},
           {"type = \"number\"", "type = \"integer\"", "none of choice"},
           {"touch-only = \"touch\"", "touch-only = \"tuch\"", "no part of kind"},
           {"group = \"background/haptic-experience\"", "group = \"experience\"", "no part asks"},
           {"rationality-reference = 8.0", "rationality-reference = \"8\"", "expects a number"},
           {"title = \"About you\"", "title = \"\"", "is empty"},
           {"participants = 25", "participants = ", "not TOML"}}) {
    const std::string text = with(c.old_text, c.new_text);
    const std::string said = refusal(text);
    EXPECT_NE(said.find(c.said), std::string::npos) << c.new_text << ": " << said;
    EXPECT_TRUE(said.starts_with("p.toml:")) << said;
    if (std::string(c.said).find("appears twice") == std::string::npos)
      EXPECT_TRUE(said.starts_with(
          "p.toml:" + std::to_string(line_of(text, c.place ? c.place : c.new_text)) + ":"))
          << said;
    EXPECT_EQ(said.find('\n'), std::string::npos);
  }
}

TEST(Protocol, AMissingFileIsOneLine) {
  EXPECT_THROW((void)read_protocol("no/such.toml"), InputError);
}

}  // namespace
}  // namespace palpate::study
