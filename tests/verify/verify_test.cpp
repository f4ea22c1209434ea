// SPDX-License-Identifier: GPL-3.0-or-later
// The quick form of every section, and how results are told. Comparisons with programs that are not
// installed say so and fail nothing.
#include "verify/verify.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "core/error.hpp"
#include "verify/bonded_layer.hpp"

namespace palpate::verify {
namespace {

const std::string kTable = PALPATE_SOURCE_DIR "/data/bonded_layer_indentation.csv";

VerifyOptions quick(const std::string& id) {
  VerifyOptions o;
  o.quick = true;
  o.only = {id};
  o.exact_layer_csv = kTable;
  return o;
}

class EverySection : public testing::TestWithParam<std::string> {};

TEST_P(EverySection, MeetsItsFigures) {
  const auto sections = run_verification(quick(GetParam()), Progress());
  ASSERT_EQ(sections.size(), 1u);
  for (const Figure& f : sections[0].figures) {
    std::printf("%s: %.3g (limit %.3g) %s %s\n", f.what.c_str(), f.value, f.limit, name(f.verdict),
                f.note.c_str());
    EXPECT_NE(f.verdict, Verdict::missed) << f.what << ": " << f.value << " " << f.note;
  }
}

INSTANTIATE_TEST_SUITE_P(Verify, EverySection, testing::ValuesIn(section_ids()),
                         [](const auto& one) { return one.param; });

// Near-incompressible layers lock coarse meshes; the rule for nu > 0.45 must not.
TEST(BondedLayer, TheHardestRowsAreWithinTwoPercent) {
  for (const ExactRow& row : read_exact_rows(kTable)) {
    if (row.nu != 0.495 || row.a_over_h != 0.5) continue;
    const double error = press_layer(row, LayerMesh::standard).error;
    std::printf("%s: %+.2f %%\n", row.sphere ? "sphere" : "punch", 100 * error);
    EXPECT_LT(std::abs(error), 0.02);
  }
}

TEST(BondedLayer, RefusesATableThatIsNone) {
  EXPECT_THROW((void)read_exact_rows("/nowhere/table.csv"), InputError);
}

TEST(Verification, WordsItsVerdicts) {
  EXPECT_EQ(at_most("a", 1, 2).verdict, Verdict::met);
  EXPECT_EQ(at_most("a", 3, 2).verdict, Verdict::missed);
  EXPECT_EQ(at_least("a", 1, 2).verdict, Verdict::missed);
  EXPECT_EQ(at_most("a", std::numeric_limits<double>::quiet_NaN(), 2).verdict, Verdict::missed);
  Section s{"x", "X", "text"};
  s.figures = {at_most("small <enough>", 1, 2), not_run("other", 1, "not run: install it")};
  EXPECT_TRUE(all_met({s}));
  const std::string text = text_table({s}), page = html_page({s});
  EXPECT_NE(text.find("not run: install it"), std::string::npos);
  EXPECT_NE(page.find("small &lt;enough&gt;"), std::string::npos);
  EXPECT_EQ(page.find("http://"), std::string::npos);
  s.figures.push_back(at_most("b", 3, 2));
  EXPECT_FALSE(all_met({s}));
  EXPECT_THROW((void)run_verification(quick("nothing"), Progress()), InputError);
}

}  // namespace
}  // namespace palpate::verify
