#include "stats/inference/friedman.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "stats/inference/ranks.hpp"
#include "stats/inference/repeated_anova.hpp"
#include "tests/stats/known_fields.hpp"
#include "tests/stats/oracle.hpp"
#include "tests/stats/uniformity.hpp"

namespace {

using json = base::Json;
using stats::friedman_test;
using stats::repeated_anova;
using Values = std::vector<double>;

constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
/// Scale of p-values for the comparison with reference answers. It is so small that only errors relative to p
/// count.
constexpr double p_scale = 1e-290;

struct Table {
  Values rows;
  int k = 1;
};

Table table(const json& c) {
  Table out;
  for (const auto& row : c.at("input").at("matrix_rows_subjects")) {
    const auto values = oracle::numbers(row);
    out.rows.insert(out.rows.end(), values.begin(), values.end());
    out.k = static_cast<int>(values.size());
  }
  return out;
}

void expect_friedman(const json& c) {
  const auto [rows, k] = table(c);
  const auto got = friedman_test(rows, k);
  if (oracle::is_undefined(c)) return oracle::expect_refused(c, got);
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  oracle::expect_known_fields(c, {"n_used", "k", "chi2", "df", "p", "kendall_W", "iman_davenport_F",
                                  "iman_davenport_p", "mean_ranks"});
  oracle::expect_field(c, "n_used", got->n);
  oracle::expect_field(c, "k", got->k);
  oracle::expect_field(c, "chi2", got->chi2);
  oracle::expect_field(c, "df", got->df);
  oracle::expect_field(c, "p", got->p, p_scale);
  oracle::expect_field(c, "kendall_W", got->kendall_w);
  oracle::expect_field(c, "iman_davenport_F", got->iman_davenport_f);
  oracle::expect_field(c, "iman_davenport_p", got->iman_davenport_p, p_scale);
  if (!oracle::asks(c.at("expect"), "mean_ranks")) return;
  const auto& want = c.at("expect").at("mean_ranks");
  ASSERT_EQ(got->mean_ranks.size(), want.size()) << c.at("id");
  for (std::size_t i = 0; i < want.size(); ++i)
    oracle::expect_number(c.at("id").get<std::string>() + ": mean_ranks", got->mean_ranks[i], want[i],
                          c.at("rtol"));
}

void expect_anova(const json& c) {
  const auto [rows, k] = table(c);
  const auto got = repeated_anova(rows, k);
  if (oracle::is_undefined(c)) return oracle::expect_refused(c, got);
  ASSERT_TRUE(got) << c.at("id") << ": " << got.reason();
  oracle::expect_known_fields(
      c, {"n_used", "k", "ss_cond", "ss_subj", "ss_err", "F", "df1", "df2", "p", "eps_gg", "eps_hf_uncapped",
          "p_gg", "p_hf", "partial_eta2", "generalized_eta2"});
  const double total = got->ss_conditions + got->ss_subjects + got->ss_error;
  oracle::expect_field(c, "n_used", got->n);
  oracle::expect_field(c, "k", got->k);
  oracle::expect_field(c, "ss_cond", got->ss_conditions, total);
  oracle::expect_field(c, "ss_subj", got->ss_subjects, total);
  oracle::expect_field(c, "ss_err", got->ss_error, total);
  oracle::expect_field(c, "F", got->f);
  oracle::expect_field(c, "df1", got->df1);
  oracle::expect_field(c, "df2", got->df2);
  oracle::expect_field(c, "p", got->p, p_scale);
  oracle::expect_field(c, "eps_gg", got->epsilon_gg);
  oracle::expect_field(c, "eps_hf_uncapped", got->epsilon_hf);
  oracle::expect_field(c, "p_gg", got->p_gg, p_scale);
  oracle::expect_field(c, "p_hf", got->p_hf, p_scale);
  oracle::expect_field(c, "partial_eta2", got->partial_eta2);
  oracle::expect_field(c, "generalized_eta2", got->generalized_eta2);
}

TEST(RepeatedMeasures, AgreeWithTheReferenceAnswers) {
  for (const auto& c : oracle::cases("friedman")) {
    const std::string op = c.at("op");
    if (op == "friedman")
      expect_friedman(c);
    else if (op == "rmanova")
      expect_anova(c);
    else
      ADD_FAILURE() << c.at("id") << ": nobody tests " << op;
  }
}

/// Ratings of n participants who use the scale differently; if coarse, rounded to whole points (ties).
Values ratings(int n, int k, std::uint64_t seed, bool coarse) {
  uniformity::Draws draws(seed);
  Values out;
  for (int i = 0; i < n; ++i) {
    const double habit = draws.normal();
    for (int j = 0; j < k; ++j) {
      const double y = 4 + habit + draws.normal();
      out.push_back(coarse ? std::round(y) : y);
    }
  }
  return out;
}

/// The table with rows and columns in another order.
Values shuffled(const Values& rows, std::size_t k, const std::vector<std::size_t>& columns) {
  Values out;
  for (std::size_t row = rows.size() / k; row-- > 0;)
    for (const auto column : columns) out.push_back(rows[row * k + column]);
  return out;
}

TEST(RepeatedMeasures, OrderOfRowsAndColumnsDoesNotMatter) {
  const Values rows = ratings(14, 4, 1, true), other = shuffled(rows, 4, {2, 0, 3, 1});
  const auto f = friedman_test(rows, 4), g = friedman_test(other, 4);
  EXPECT_NEAR(f->chi2, g->chi2, 1e-12);
  EXPECT_NEAR(f->iman_davenport_p, g->iman_davenport_p, 1e-14);
  EXPECT_EQ(f->mean_ranks[2], g->mean_ranks[0]);
  const auto a = repeated_anova(rows, 4), b = repeated_anova(other, 4);
  EXPECT_NEAR(a->f, b->f, 1e-12);
  EXPECT_NEAR(a->p_gg, b->p_gg, 1e-13);
  EXPECT_NEAR(*a->epsilon_hf, *b->epsilon_hf, 1e-13);
  EXPECT_NEAR(a->means[2], b->means[0], 1e-14);
}

TEST(RepeatedMeasures, ShiftAndScaleDoNotMatter) {
  const Values rows = ratings(10, 5, 2, false);
  const auto a = repeated_anova(rows, 5);
  const auto f = friedman_test(rows, 5);
  for (const double scale : {-3.0, 1e-150, 1e150}) {
    Values other = rows;
    for (double& y : other) y *= scale;
    const auto b = repeated_anova(other, 5);
    ASSERT_TRUE(b) << scale << ": " << b.reason();
    EXPECT_NEAR(b->f / a->f, 1, 1e-12) << scale;
    EXPECT_NEAR(b->epsilon_gg, a->epsilon_gg, 1e-12) << scale;
    EXPECT_NEAR(friedman_test(other, 5)->chi2, f->chi2, 1e-12) << scale;
  }
  Values offset = rows;
  for (double& y : offset) y = std::round(y * 1024) / 1024;
  const auto exact = repeated_anova(offset, 5);
  for (double& y : offset) y += 0x1p40;  // exact in double
  const auto moved = repeated_anova(offset, 5);
  EXPECT_NEAR(moved->f / exact->f, 1, 1e-12);
  EXPECT_NEAR(moved->epsilon_gg / exact->epsilon_gg, 1, 1e-12);
  EXPECT_NEAR(moved->means[3] - 0x1p40, exact->means[3], 1e-3);
}

TEST(RepeatedMeasures, SumsOfSquaresAreTheTotal) {
  const Values rows = ratings(9, 4, 3, false);
  const auto a = repeated_anova(rows, 4);
  const double mean = std::accumulate(rows.begin(), rows.end(), 0.0) / 36;
  double total = 0;
  for (const double y : rows) total += (y - mean) * (y - mean);
  EXPECT_NEAR(a->ss_conditions + a->ss_subjects + a->ss_error, total, 1e-11);
  EXPECT_NEAR(a->generalized_eta2, a->ss_conditions / total, 1e-13);
}

TEST(RepeatedMeasures, TwoConditionsAreThePairedTest) {
  const Values rows = ratings(12, 2, 4, false);
  double mean = 0, squares = 0;
  for (std::size_t i = 0; i < rows.size(); i += 2) mean += (rows[i] - rows[i + 1]) / 12;
  for (std::size_t i = 0; i < rows.size(); i += 2) squares += std::pow(rows[i] - rows[i + 1] - mean, 2);
  const double t = mean / std::sqrt(squares / 11 / 12);
  const auto a = repeated_anova(rows, 2);
  EXPECT_NEAR(a->f, t * t, 1e-11);
  EXPECT_NEAR(a->epsilon_gg, 1, 1e-14);
  EXPECT_NEAR(a->p, a->p_gg, 1e-14);
}

TEST(RepeatedMeasures, ParticipantsWithoutAllConditionsAreDroppedAndCounted) {
  Values rows = ratings(8, 3, 5, true), complete(rows.begin() + 6, rows.end());
  rows[1] = unknown;
  rows[3] = rows[4] = unknown;
  const auto f = friedman_test(rows, 3), g = friedman_test(complete, 3);
  EXPECT_EQ(f->n, 6);
  EXPECT_EQ(f->n_missing, 2);
  EXPECT_EQ(f->chi2, g->chi2);
  const auto a = repeated_anova(rows, 3);
  EXPECT_EQ(a->n_missing, 2);
  EXPECT_EQ(a->f, repeated_anova(complete, 3)->f);
}

TEST(RepeatedMeasures, OneOrderForAllIsCompleteConcordance) {
  const auto f = friedman_test(Values{1, 2, 3, 4, 6, 9, -1, 0, 8}, 3);
  EXPECT_EQ(f->kendall_w, 1);
  EXPECT_EQ(f->iman_davenport_f, std::numeric_limits<double>::infinity());
  EXPECT_EQ(f->iman_davenport_p, 0);
  EXPECT_NEAR(f->p, std::exp(-3.0), 1e-15) << "chi-square of 6 with 2 df";
  const auto tied = friedman_test(Values{1, 1, 3, 4, 4, 9, 0, 0, 8}, 3);
  EXPECT_NEAR(tied->kendall_w, 1, 1e-15) << "ties everywhere, and all agree";
  Values pairs;
  for (int person = 0; person < 9; ++person) pairs.insert(pairs.end(), {1, 1, 2, 2, 3, 3});
  EXPECT_EQ(friedman_test(pairs, 6)->iman_davenport_f, std::numeric_limits<double>::infinity())
      << "9 people with 3 ties each: 162 / 5 is no double";
}

TEST(RepeatedMeasures, RefuseWhatHasNoAnswer) {
  const double inf = std::numeric_limits<double>::infinity();
  for (const auto& [rows, k] : std::vector<std::pair<Values, int>>{{{}, 3},
                                                                   {{1, 2, 3}, 3},
                                                                   {{1, 2, 3, unknown, 2, 3}, 3},
                                                                   {{1, 2, 3, 4}, 1},
                                                                   {{4, 4, 4, 4, 4, 4}, 3},
                                                                   {{1, 2, 3, 1, inf, 3}, 3}}) {
    EXPECT_NE(friedman_test(rows, k).reason(), "") << rows.size();
    EXPECT_NE(repeated_anova(rows, k).reason(), "") << rows.size();
  }
  EXPECT_NE(repeated_anova(Values{0.1, 0.2, 0.4, 0.7, 0.8, 1.0, 10.1, 10.2, 10.4}, 3).reason(), "")
      << "rows that differ by a constant leave no error";
  EXPECT_THROW(friedman_test(Values{1, 2, 3}, 2), std::invalid_argument);
  EXPECT_THROW(repeated_anova(Values{1, 2, 3}, 0), std::invalid_argument);
}

TEST(RepeatedMeasures, PIsUniformUnderTheNull) {
  Values anova, corrected, ranks;
  for (std::uint64_t study = 0; study < 2000; ++study) {
    const Values rows = ratings(26, 5, 100 + study, false);
    const auto a = repeated_anova(rows, 5);
    anova.push_back(a->p);
    corrected.push_back(*a->p_hf);
    ranks.push_back(friedman_test(rows, 5)->iman_davenport_p);
  }
  EXPECT_LT(uniformity::distance(anova), uniformity::critical);
  EXPECT_LT(uniformity::distance(corrected), uniformity::critical);
  // Ranks give p in steps, too small to detect with 2,000 studies.
  EXPECT_LT(uniformity::distance(ranks), uniformity::critical);
}

TEST(MeanRanks, ShareTheirPlaces) {
  EXPECT_EQ(stats::midranks(Values{3, 1, 3, 2, 3}).ranks, (Values{4, 1, 4, 2, 4}));
  EXPECT_EQ(stats::midranks(Values{}).ranks, Values{});
  EXPECT_EQ(stats::midranks(Values{0.0, -0.0}).ranks, (Values{1.5, 1.5}));
}

}  // namespace
