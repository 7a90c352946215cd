/// One scale of choices and ratings: against R (tests/stats/r/quality_scale.R), published scales, closed
/// forms.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <vector>

#include "stats/base/csv.hpp"
#include "stats/base/json.hpp"
#include "stats/preference/quality_scale.hpp"
#include "stats/quantiles.hpp"

namespace {

using json = base::Json;
using stats::ScaleData;
using stats::ScalePrior;

std::string r_file(const std::string& name) { return std::string(VIP_TEST_DIR) + "/stats/r/" + name; }

const json& from_r() {
  static const json made = [] {
    std::ifstream in(r_file("quality_scale.json"));
    return json::parse(in);
  }();
  return made;
}

/// The answers in a CSV file, of one scene or of all; conditions in alphabetical order, as in R.
ScaleData data_of(const std::string& file, const std::string& scene = "") {
  const base::CsvTable table(r_file(file));
  const auto person = table.find("person"), count = table.find("count"), scenes = table.find("scene");
  const auto first = table.column("first"), second = table.column("second"), chosen = table.column("chosen");
  std::map<std::string, int> conditions, people;
  for (const auto& row : table.rows()) conditions[row.fields[first]] = conditions[row.fields[second]] = 0;
  ScaleData out;
  for (auto& [name, number] : conditions) number = out.conditions++;
  out.people_known = person.has_value();
  for (const auto& row : table.rows()) {
    if (!scene.empty() && row.fields[*scenes] != scene) continue;
    const int who =
        person ? people.try_emplace(row.fields[*person], static_cast<int>(people.size())).first->second : 0;
    const double n = count ? std::stod(row.fields[*count]) : 1;
    const bool is_first = row.fields[chosen] == "first";
    out.pairs.push_back({who, conditions[row.fields[first]], conditions[row.fields[second]], is_first ? n : 0,
                         is_first ? 0 : n});
  }
  return out;
}

ScaleData data_of_case(const std::string& name) {
  if (name == "sound quality") return data_of("sound_quality.csv");
  if (name == "vegetables") return data_of("vegetables.csv");
  const std::string scene = name.substr(4);
  return data_of("tmo_choices.csv", scene.substr(0, scene.find(' ')));
}

void expect_all(const std::vector<double>& got, const json& want, double error, const std::string& what) {
  for (std::size_t i = 0; i < got.size(); ++i)
    EXPECT_NEAR(got[i], want.at(i).get<double>(), error * (1 + std::abs(got[i]))) << what << " " << i;
}

/// Three conditions in a chain, each chosen over the next in 75 of 100 answers (pwcmp's first example).
ScaleData chain() {
  return {.conditions = 3, .pairs = {{0, 0, 1, 25, 75}, {0, 1, 2, 25, 75}}, .ratings = {}};
}

/// People with tastes of their own, who choose among all pairs and rate all conditions.
ScaleData made(int people, int conditions, int ratings, unsigned seed, double order = 0) {
  ScaleData data{.conditions = conditions, .pairs = {}, .ratings = {}};
  std::uint64_t state = 0x9E3779B97F4A7C15ull * (seed + 1);
  const auto uniform = [&] {
    state ^= state << 13;
    state ^= state >> 7;
    state ^= state << 17;
    return (static_cast<double>(state >> 11) + 0.5) * 0x1.0p-53;
  };
  for (int i = 0; i < 50; ++i) uniform();
  const auto normal = [&] { return stats::normal_quantile(uniform()); };
  for (int p = 0; p < people; ++p) {
    std::vector<double> own;
    for (int i = 0; i < conditions; ++i) own.push_back(0.5 * i + 0.6 * normal());
    for (int i = 0; i < conditions; ++i)
      for (int j = i + 1; j < conditions; ++j) {
        const bool swap = uniform() < 0.5;
        const int a = swap ? j : i, b = swap ? i : j;
        const bool first = own[static_cast<std::size_t>(a)] - own[static_cast<std::size_t>(b)] + order +
                               stats::jod_sigma * normal() >
                           0;
        data.pairs.push_back({p, a, b, first ? 1.0 : 0.0, first ? 0.0 : 1.0});
      }
    const double offset = 0.5 * normal();
    for (int r = 0; r < ratings; ++r)
      for (int i = 0; i < conditions; ++i) {
        const double felt =
            4 + own[static_cast<std::size_t>(i)] - 0.25 * (conditions - 1) + offset + normal();
        data.ratings.push_back({p, i, static_cast<int>(std::lround(std::clamp(felt, 1.0, 7.0)))});
      }
  }
  return data;
}

TEST(QualityScale, EqualsThePublishedExampleOfPwcmp) {
  const base::CsvTable published(r_file("tmo_scaled.csv"));
  std::map<std::string, std::vector<double>> scenes;  // conditions in alphabetical order
  for (const auto& row : published.rows()) scenes[row.fields[0]].push_back(std::stod(row.fields[2]));
  ASSERT_EQ(scenes.size(), 5u);
  for (const auto& [scene, jod] : scenes) {
    const auto scale =
        stats::quality_scale(data_of("tmo_choices.csv", scene), {.prior = ScalePrior::Bounded});
    ASSERT_TRUE(scale) << scale.reason();
    const double mean = std::accumulate(jod.begin(), jod.end(), 0.0) / static_cast<double>(jod.size());
    ASSERT_EQ(jod.size(), scale->jod.size());
    // pwcmp holds the mean at 0 by a weak penalty and stops there at about 1e-4.
    for (std::size_t i = 0; i < jod.size(); ++i) EXPECT_NEAR(scale->jod[i], jod[i] - mean, 2e-5) << scene;
  }
}

TEST(QualityScale, NamesTheObserverThatPwcmpNames) {
  const auto scale = stats::quality_scale(data_of("tmo_choices.csv"));
  ASSERT_TRUE(scale) << scale.reason();
  // The page of pwcmp says of these 18 people that one has a score of 2.72.
  std::vector<double> scores;
  for (const auto& one : scale->observers) scores.push_back(one.score);
  const auto worst = std::max_element(scores.begin(), scores.end());
  EXPECT_NEAR(*worst, 2.72, 0.005);
  EXPECT_EQ(std::count_if(scores.begin(), scores.end(), [](double s) { return s > 1.5; }), 1);
  // This person answered most questions. Answer by answer nothing is unusual.
  const auto& person = scale->observers[static_cast<std::size_t>(worst - scores.begin())];
  EXPECT_EQ(person.answers, 85);
  EXPECT_LT(person.score_per_answer, 0.1);
}

TEST(QualityScale, OfChoicesAgreesWithR) {
  int intervals = 0, observers = 0;
  for (const auto& item : from_r().at("choices")) {
    const auto name = item.at("name").get<std::string>();
    const bool order = name.ends_with("order");
    const auto scale = stats::quality_scale(data_of_case(name), {.order_bias = order});
    ASSERT_TRUE(scale) << name << scale.reason();
    const std::size_t n = scale->jod.size();
    expect_all(scale->jod, item.at("jod"), 1e-7, name);
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(std::sqrt(scale->model_covariance[i * n + i]), item.at("model_se").at(i).get<double>(),
                  1e-7);
    if (order) {
      EXPECT_NEAR(*scale->order_bias, item.at("order").get<double>(), 1e-7);
    }
    EXPECT_EQ(scale->why_no_intervals.empty(), item.contains("se")) << name << scale->why_no_intervals;
    if (!item.contains("se")) continue;
    ++intervals;
    expect_all(scale->se, item.at("se"), 5e-6, name + " jackknife");
    expect_all(scale->se_sandwich, item.at("se_sandwich"), 1e-7, name + " sandwich");
    if (order) {
      EXPECT_NEAR(*scale->order_bias_se, item.at("se").at(n).get<double>(), 2e-5);
    }
    for (std::size_t i = 0; i < n; ++i)
      EXPECT_NEAR(scale->ci[i][0], item.at("low").at(i).get<double>(), 1e-4) << name;
    if (!item.contains("observers")) continue;
    for (std::size_t d = 0; d < scale->differences.size(); ++d)
      EXPECT_NEAR(*scale->differences[d].p, item.at("p").at(d).get<double>(), 1e-5) << name;
    for (std::size_t p = 0; p < scale->observers.size(); ++p, ++observers) {
      const auto& one = scale->observers[p];
      EXPECT_NEAR(one.log_likelihood, item.at("observers").at(p).get<double>(), 1e-4) << name;
      EXPECT_NEAR(one.score, item.at("scores").at(p).get<double>(), 1e-4) << name;
      EXPECT_NEAR(one.score_per_answer, item.at("scores_per_answer").at(p).get<double>(), 1e-4) << name;
    }
  }
  EXPECT_EQ(intervals, 6);
  EXPECT_GE(observers, 4 * 18 + 40);
}

TEST(QualityScale, OfChoicesAndRatingsAgreesWithR) {
  for (const auto& item : from_r().at("joint")) {
    ScaleData data{.conditions = item.at("items").get<int>(), .pairs = {}, .ratings = {}};
    for (const auto& row : item.at("pairs")) {
      const bool first = row.at(3) == 1;
      data.pairs.push_back({row.at(0).get<int>(), row.at(1).get<int>() - 1, row.at(2).get<int>() - 1,
                            first ? 1.0 : 0.0, first ? 0.0 : 1.0});
    }
    for (const auto& row : item.at("ratings"))
      data.ratings.push_back({row.at(0).get<int>(), row.at(1).get<int>() - 1, row.at(2).get<int>()});
    const bool normal = item.at("prior") == "normal";
    const auto scale = stats::quality_scale(
        data, {.prior = normal ? ScalePrior::Normal : ScalePrior::None, .order_bias = true});
    ASSERT_TRUE(scale) << scale.reason();
    auto got = scale->jod, errors = scale->se;
    got.insert(got.end(), {*scale->order_bias, *scale->slope});
    expect_all(got, item.at("estimates"), 2e-5, "estimate");
    expect_all(scale->thresholds, item.at("thresholds"), 2e-5, "threshold");
    errors.insert(errors.end(), {*scale->order_bias_se, *scale->slope_se});
    expect_all(errors, item.at("se"), 2e-4, "se");
  }
}

TEST(QualityScale, OfVegetablesIsNearGuilfords) {
  // Guilford's values (1954), by mean normal deviates, alphabetically; a JOD is 1.4826 normal deviates.
  const std::vector<double> guilford{.98, .65, .52, 1.12, 1.63, 1.44, 1.40, 1.14, 0};
  const auto scale = stats::quality_scale(data_of("vegetables.csv"));
  ASSERT_TRUE(scale) << scale.reason();
  for (std::size_t i = 0; i < guilford.size(); ++i)
    EXPECT_NEAR(scale->jod[i] - scale->jod[8], stats::jod_sigma * guilford[i], 0.07) << i;
  EXPECT_NE(scale->why_no_intervals, "");
  EXPECT_TRUE(scale->ci.empty());
  EXPECT_TRUE(scale->observers.empty());
  EXPECT_FALSE(scale->differences.front().ci || scale->differences.front().p);
}

TEST(QualityScale, OneJodIsChosenInThreeQuartersOfAnswers) {
  const auto scale = stats::quality_scale(chain());
  ASSERT_TRUE(scale) << scale.reason();
  for (const int i : {0, 1, 2}) EXPECT_NEAR(scale->jod[static_cast<std::size_t>(i)], i - 1, 1e-9);
  EXPECT_NEAR(scale->differences[0].probability, 0.25, 1e-9);
}

TEST(QualityScale, MoreAnswersOfTheSamePeopleAreNotMorePeople) {
  const ScaleData once = made(8, 4, 1, 1);
  ScaleData often = once;
  for (auto& pair : often.pairs) pair.first_chosen *= 25, pair.second_chosen *= 25;
  for (auto& rating : often.ratings) rating.count *= 25;
  const auto a = stats::quality_scale(once), b = stats::quality_scale(often);
  ASSERT_TRUE(a && b);
  EXPECT_EQ(b->people, 8);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(a->jod[i], b->jod[i], 1e-6);
    EXPECT_NEAR(a->se[i], b->se[i], 1e-4);
    EXPECT_NEAR(a->se_sandwich[i], b->se_sandwich[i], 1e-4);
    EXPECT_NEAR(a->model_covariance[i * 5], 25 * b->model_covariance[i * 5], 1e-4);
  }
}

TEST(QualityScale, RowsMayBeOrderedAndSplitInAnyWay) {
  const ScaleData data = made(6, 4, 1, 2);
  ScaleData other = data;
  std::reverse(other.pairs.begin(), other.pairs.end());
  for (auto& pair : other.pairs) {
    std::swap(pair.first, pair.second);
    std::swap(pair.first_chosen, pair.second_chosen);
  }
  other.pairs.push_back({0, 1, 2, 0.0, 0.0});
  const auto a = stats::quality_scale(data), b = stats::quality_scale(other);
  ASSERT_TRUE(a && b);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_NEAR(a->jod[i], b->jod[i], 1e-6);
    EXPECT_NEAR(a->se[i], b->se[i], 1e-4);
  }
}

TEST(QualityScale, RatingsPlaceAConditionThatNoPairHas) {
  ScaleData data = made(40, 5, 2, 3);
  std::erase_if(data.pairs, [](const auto& pair) { return pair.first == 4 || pair.second == 4; });
  const auto scale = stats::quality_scale(data);
  ASSERT_TRUE(scale) << scale.reason();
  // True: conditions 0.5 JOD apart; about three standard errors.
  EXPECT_NEAR(scale->jod[4] - scale->jod[0], 2, 0.6);
  EXPECT_GT(*scale->slope, 0.4);
  data.ratings.clear();
  EXPECT_EQ(stats::quality_scale(data).reason(), "2 groups of conditions that no answer links");
  EXPECT_EQ(stats::linked_groups(data), (std::vector<std::vector<int>>{{0, 1, 2, 3}, {4}}));
}

TEST(QualityScale, IsRefusedWithoutOneFiniteScale) {
  ScaleData data{
      .conditions = 3, .pairs = {{0, 0, 1, 3, 1}, {0, 1, 2, 4, 0}, {1, 0, 2, 2, 0}}, .ratings = {}};
  const std::string loses = "item 3 loses every comparison with the others";
  EXPECT_EQ(stats::quality_scale(data).reason(), loses);
  EXPECT_EQ(stats::quality_scale(data, {.prior = ScalePrior::Bounded}).reason(), loses);
  const auto held = stats::quality_scale(data, {.prior = ScalePrior::Normal});
  ASSERT_TRUE(held);
  EXPECT_LT(held->jod[2], held->jod[1]);
  EXPECT_NE(held->why_no_intervals, "");

  // A rating above one of another condition bounds the scale.
  data.ratings = {{0, 0, 3}, {0, 1, 2}, {0, 2, 3}, {1, 0, 4}, {1, 1, 4}, {1, 2, 1}};
  EXPECT_TRUE(stats::quality_scale(data)) << stats::quality_scale(data).reason();
  data.ratings = {{0, 0, 3}, {0, 1, 2}, {0, 2, 2}, {1, 0, 4}, {1, 1, 4}, {1, 2, 1}};
  EXPECT_EQ(stats::quality_scale(data).reason(), loses);

  EXPECT_EQ(stats::quality_scale({.conditions = 1, .pairs = {}, .ratings = {}}).reason(),
            "fewer than two conditions");
  data.pairs.clear();
  EXPECT_NE(stats::quality_scale(data).reason().find("ratings alone"), std::string::npos);
}

TEST(QualityScale, HasNoIntervalsWithoutThreePeople) {
  ScaleData data = chain();
  EXPECT_NE(stats::quality_scale(data)->why_no_intervals.find("one person"), std::string::npos);
  data.pairs[1].person = 1;
  EXPECT_NE(stats::quality_scale(data)->why_no_intervals.find("two people"), std::string::npos);
  // Three people who answer alike show no spread between people.
  data.pairs.clear();
  for (const int person : {0, 1, 2})
    data.pairs.insert(data.pairs.end(), {{person, 0, 1, 25, 75}, {person, 1, 2, 25, 75}});
  EXPECT_NE(stats::quality_scale(data)->why_no_intervals.find("alike"), std::string::npos);
  // One of three people holds the scale together.
  data.pairs = {{0, 0, 1, 2, 1}, {1, 0, 1, 1, 1}, {2, 0, 1, 1, 2}, {2, 1, 2, 1, 1}};
  const auto scale = stats::quality_scale(data);
  ASSERT_TRUE(scale);
  EXPECT_EQ(scale->without, 2);
  EXPECT_TRUE(scale->observers.empty());
}

TEST(QualityScale, RefusesDataThatCannotBe) {
  const auto bad = [](const ScaleData& data) {
    EXPECT_THROW(stats::quality_scale(data), std::invalid_argument);
  };
  bad({.conditions = 2, .pairs = {{0, 0, 2, 1, 1}}, .ratings = {}});
  bad({.conditions = 2, .pairs = {{0, 1, 1, 1, 1}}, .ratings = {}});
  bad({.conditions = 2, .pairs = {{0, 0, 1, -1, 1}}, .ratings = {}});
  bad({.conditions = 2, .pairs = {{0, 0, 1, std::nan(""), 1}}, .ratings = {}});
  bad({.conditions = 2, .pairs = {{0, 0, 1, 1, 1}}, .ratings = {{0, 5, 1}}});
  EXPECT_THROW(stats::quality_scale(chain(), {.confidence = 1}), std::invalid_argument);
}

/// Share of intervals of differences from the first condition that hold the truth.
double held(int people, int conditions, int ratings, int studies, ScalePrior prior, int& refused) {
  int inside = 0, all = 0;
  for (int s = 0; s < studies; ++s) {
    const auto scale = stats::quality_scale(
        made(people, conditions, ratings, static_cast<unsigned>(1000 * people + s)), {.prior = prior});
    if (!scale || !scale->why_no_intervals.empty()) {
      ++refused;
      std::printf("refused: %s\n", scale ? scale->why_no_intervals.c_str() : scale.reason().c_str());
      continue;
    }
    // The tastes of people (sd 0.6 each) widen a difference: the scale of all people is narrower.
    const double narrow = stats::jod_sigma / std::sqrt(stats::jod_sigma * stats::jod_sigma + 2 * 0.36);
    for (const auto& one : scale->differences) {
      const double truth = -0.5 * (one.j - one.i) * narrow;
      inside += (*one.ci)[0] <= truth && truth <= (*one.ci)[1];
      ++all;
    }
  }
  return static_cast<double>(inside) / all;
}

TEST(QualityScaleSlow, IntervalsHoldTheScale) {
  for (const int ratings : {0, 1}) {
    for (const int people : {8, 16, 30}) {
      int refused = 0;
      const double share = held(people, 5, ratings, 400, ScalePrior::Normal, refused);
      std::printf("%d ratings, %2d people: held %.3f, refused %d of 400\n", ratings, people, share, refused);
      EXPECT_GT(share, 0.93);
      EXPECT_LT(share, 0.98);
    }
  }
}

}  // namespace
