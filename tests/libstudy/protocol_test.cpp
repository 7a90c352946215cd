#include "libstudy/protocol/protocol.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <map>
#include <set>
#include <sstream>
#include <string>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/protocols.hpp"

namespace {

using test::shipped_text;
using testing::HasSubstr;

study::Protocol parsed(const std::string& name) {
  return study::parse_protocol(shipped_text(name), name + ".toml");
}

const study::Block& block_of(const study::Protocol& protocol, study::BlockKind kind) {
  return *std::find_if(protocol.blocks.begin(), protocol.blocks.end(),
                       [&](const auto& block) { return block.kind == kind; });
}

TEST(Protocol, PilotHasThePapers21Settings) {
  const auto protocol = parsed("ptpe_pilot");
  std::set<std::pair<double, double>> cells;
  for (const auto& cell : protocol.design.cells) {
    EXPECT_EQ(cell.setting.duration_s, 10);
    EXPECT_LT(cell.setting.sd, cell.setting.mean);
    EXPECT_EQ(cell.stimulus, (study::StimulusSpec{"data/scenes/single_dam.toml", "HiRes", "32k"}));
    cells.emplace(cell.setting.mean, cell.setting.sd);
  }
  EXPECT_EQ(protocol.design.cells.size(), 21u);
  EXPECT_EQ(cells.size(), 21u);
  for (double mean = 10; mean <= 50; mean += 10) {
    for (double sd = 0; sd <= 20 && sd < mean; sd += 5) EXPECT_TRUE(cells.count({mean, sd}));
  }
}

TEST(Protocol, PilotIsThatOfThePaper) {
  const auto protocol = parsed("ptpe_pilot");
  EXPECT_EQ(protocol.participants, 16);
  EXPECT_EQ(protocol.pacing.mean, study::FpsMean::Harmonic);
  EXPECT_EQ(protocol.pacing.fps_min, 4);
  EXPECT_FALSE(protocol.pacing.fps_max);
  EXPECT_EQ(protocol.content.content_step_s, 1.0 / 60);
  EXPECT_FALSE(protocol.needs_gaze);
  EXPECT_FALSE(protocol.test_data);
  EXPECT_EQ(protocol.sha256, base::sha256_hex(shipped_text("ptpe_pilot")));
  const auto& ratings = block_of(protocol, study::BlockKind::Stimulus);
  ASSERT_EQ(ratings.steps.size(), 3u);
  EXPECT_EQ(ratings.steps[0].kind, study::StepKind::Black);
  EXPECT_EQ(ratings.steps[0].seconds, 3);
  EXPECT_EQ(ratings.steps[2].asks, std::vector<std::string>{"satisfaction"});
  const auto& question = ratings.questions.at(0);
  EXPECT_EQ(question.scale_min, 1);
  EXPECT_EQ(question.scale_max, 7);
  EXPECT_EQ(question.language, "en");
  ASSERT_EQ(question.anchors.size(), 3u);
  EXPECT_EQ(question.anchors[1], (std::pair<int, std::string>(4, "neutral")));
}

TEST(Protocol, Task1IsThatOfThePaper) {
  const auto protocol = parsed("task1");
  EXPECT_EQ(protocol.participants, 26);
  EXPECT_EQ(protocol.design.cells.size(), 3u * 2 * 5);
  EXPECT_EQ(protocol.design.groups, 2);
  EXPECT_EQ(protocol.design.timing, study::TimingSource::Table2);
  EXPECT_EQ(protocol.design.assignment, study::Assignment::Balanced);
  EXPECT_TRUE(protocol.needs_gaze);
  for (const auto& cell : protocol.design.cells) EXPECT_EQ(cell.setting.duration_s, 30);
  const auto& ratings = block_of(protocol, study::BlockKind::Stimulus);
  EXPECT_EQ(ratings.between_groups_s, 120);
  ASSERT_EQ(ratings.questions.size(), 5u);
  EXPECT_EQ(ratings.questions[0].scale_max, 7);
  for (std::size_t i = 1; i < 5; ++i) {
    EXPECT_EQ(ratings.questions[i].scale_min, 0);
    EXPECT_EQ(ratings.questions[i].scale_max, 3);
  }
  EXPECT_EQ(ratings.steps.back().kind, study::StepKind::Rest);
  EXPECT_EQ(ratings.steps.back().seconds, 30);
}

TEST(Protocol, Task2IsThatOfThePaper) {
  const auto protocol = parsed("task2");
  EXPECT_EQ(protocol.participants, 26);
  EXPECT_TRUE(protocol.design.pairs);
  EXPECT_EQ(study::trials_of_group(protocol.design), 10);
  EXPECT_EQ(study::cell_groups(protocol.design).size(), 3u);
  std::vector<double> seconds;
  for (const auto& step : block_of(protocol, study::BlockKind::Stimulus).steps)
    seconds.push_back(step.seconds);
  EXPECT_EQ(seconds, (std::vector<double>{0, 5, 0, 5, 0, 60}));
  const auto& question = block_of(protocol, study::BlockKind::Stimulus).questions.at(0);
  EXPECT_EQ(question.kind, study::AnswerKind::Choice);
  EXPECT_EQ(question.anchors, (std::vector<std::pair<int, std::string>>{{1, "first"}, {2, "second"}}));
}

std::map<std::tuple<std::string, std::string, std::string>, std::pair<double, double>> moments_of(
    const study::Protocol& protocol) {
  std::map<std::tuple<std::string, std::string, std::string>, std::pair<double, double>> out;
  for (const auto& cell : protocol.design.cells)
    out[{cell.stimulus.scene, cell.stimulus.n_star, cell.stimulus.method}] = {cell.setting.mean,
                                                                              cell.setting.sd};
  return out;
}

// The paper's Table 2, milliseconds and standard deviation of the frame rate. The row of Faucet, 16k, LoRes
// cannot be read there.
constexpr const char* table2 = R"(
single_dam 16k LoRes 18.1 6.4
single_dam 16k FovFluid 30.6 11.2
single_dam 16k Ours 31.2 13.2
single_dam 16k Ours-TSp 30.9 11.0
single_dam 16k HiRes 36.6 7.2
single_dam 32k LoRes 19.8 7.9
single_dam 32k FovFluid 31.3 10.6
single_dam 32k Ours 39.7 14.1
single_dam 32k Ours-TSp 33.4 9.6
single_dam 32k HiRes 52.1 4.5
jet_impact 16k LoRes 18.2 7.6
jet_impact 16k FovFluid 25.8 9.6
jet_impact 16k Ours 32.4 8.8
jet_impact 16k Ours-TSp 31.2 8.6
jet_impact 16k HiRes 40.1 6.3
jet_impact 32k LoRes 19.7 8.6
jet_impact 32k FovFluid 33.6 9.1
jet_impact 32k Ours 48.6 7.3
jet_impact 32k Ours-TSp 44.7 6.8
jet_impact 32k HiRes 59.7 4.8
faucet 16k FovFluid 20.3 8.1
faucet 16k Ours 22.2 9.2
faucet 16k Ours-TSp 20.5 7.2
faucet 16k HiRes 31.3 10.4
faucet 32k LoRes 18.9 9.3
faucet 32k FovFluid 20.8 10.1
faucet 32k Ours 23.7 11.9
faucet 32k Ours-TSp 22.7 10.2
faucet 32k HiRes 48.8 5.8
)";

TEST(Protocol, TasksHaveTheMomentsOfThePapersTable2) {
  const auto task1 = moments_of(parsed("task1"));
  const auto task2 = moments_of(parsed("task2"));
  std::istringstream rows(table2);
  std::string scene, size, method;
  double ms = 0, sd = 0;
  int row_count = 0;
  while (rows >> scene >> size >> method >> ms >> sd) {
    const std::tuple key("data/scenes/" + scene + ".toml", size, method);
    EXPECT_NEAR(task1.at(key).first, 1000 / ms, 0.005) << scene << ' ' << size << ' ' << method;
    EXPECT_EQ(task1.at(key).second, sd);
    if (size == "32k") {
      EXPECT_EQ(task2.at(key), task1.at(key));
    }
    ++row_count;
  }
  EXPECT_EQ(row_count, 29);
}

/// Expects equal stimuli, rules, steps and questions of trials: a lab variant must not change them.
void expect_same_trials(const study::Protocol& one, const study::Protocol& other) {
  EXPECT_EQ(moments_of(one), moments_of(other));
  EXPECT_EQ(one.design.groups, other.design.groups);
  EXPECT_EQ(one.design.pairs, other.design.pairs);
  EXPECT_EQ(one.design.assignment, other.design.assignment);
  EXPECT_EQ(one.pacing.fps_min, other.pacing.fps_min);
  EXPECT_EQ(one.pacing.max_interval_ms, other.pacing.max_interval_ms);
  EXPECT_EQ(one.content.content_step_s, other.content.content_step_s);
  const auto& trials = block_of(one, study::BlockKind::Stimulus);
  const auto& others = block_of(other, study::BlockKind::Stimulus);
  EXPECT_EQ(trials.questions, others.questions);
  EXPECT_EQ(trials.between_groups_s, others.between_groups_s);
}

class LabVariant : public testing::TestWithParam<const char*> {};

TEST_P(LabVariant, AddsBlocksToThePapersProtocol) {
  const auto paper = parsed(GetParam());
  const auto lab = parsed(GetParam() + std::string("_lab"));
  expect_same_trials(paper, lab);
  EXPECT_NE(paper.name, lab.name);
  std::map<study::BlockKind, int> count;
  for (const auto& block : lab.blocks) ++count[block.kind];
  EXPECT_EQ(count[study::BlockKind::Ssq], 2);
  for (const auto kind :
       {study::BlockKind::Screening, study::BlockKind::Consent, study::BlockKind::Demographics,
        study::BlockKind::Practice, study::BlockKind::Stimulus, study::BlockKind::Repeat,
        study::BlockKind::Catch, study::BlockKind::Fms, study::BlockKind::Debrief})
    EXPECT_GE(count[kind], 1) << study::block_kind_name(kind);
  for (const auto& question : block_of(lab, study::BlockKind::Demographics).questions)
    EXPECT_TRUE(question.personal) << question.id;
  EXPECT_TRUE(block_of(lab, study::BlockKind::Fms).questions.at(0).stop_at);
  // FMS is asked between trials, where its stop rule applies.
  const auto& steps = block_of(lab, study::BlockKind::Stimulus).steps;
  EXPECT_TRUE(std::any_of(steps.begin(), steps.end(), [](const auto& step) {
    return std::find(step.asks.begin(), step.asks.end(), "fms") != step.asks.end();
  }));
}

INSTANTIATE_TEST_SUITE_P(Protocols, LabVariant, testing::Values("ptpe_pilot", "task1", "task2"));

TEST(Protocol, DemoHasEveryKindOfBlock) {
  std::set<study::BlockKind> kinds;
  for (const auto& block : parsed("demo").blocks) kinds.insert(block.kind);
  EXPECT_EQ(kinds.size(), 15u);
}

TEST(Protocol, EveryKindOfAnswerHasItsRow) {
  std::set<std::string> words;
  for (std::size_t i = 0; i < study::answer_kinds().size(); ++i) {
    EXPECT_EQ(static_cast<std::size_t>(study::answer_kinds()[i].kind), i);
    EXPECT_TRUE(words.insert(study::answer_kinds()[i].word).second);
    EXPECT_STRNE(study::answer_kinds()[i].meaning, "") << "the reference lacks it";
  }
  const auto scores = [](study::AnswerKind kind) {
    study::Question question;
    question.kind = kind;
    question.scale_min = 1;
    question.scale_max = 3;
    question.anchors = {{1, "no"}, {3, "yes"}};
    EXPECT_FALSE(study::can_be_given(question, 0));
    EXPECT_EQ(study::can_be_given(question, 2), kind == study::AnswerKind::Scale ||
                                                    kind == study::AnswerKind::Number ||
                                                    kind == study::AnswerKind::Vas);
    return study::scores_of(question);
  };
  EXPECT_EQ(scores(study::AnswerKind::Scale), (std::vector{1, 2, 3}));
  EXPECT_EQ(scores(study::AnswerKind::Choice), (std::vector{1, 3}));
  EXPECT_EQ(scores(study::AnswerKind::Number), (std::vector{1, 2, 3}));
  EXPECT_TRUE(scores(study::AnswerKind::Text).empty());
  EXPECT_EQ(scores(study::AnswerKind::Vas), (std::vector{1, 2, 3}));
  EXPECT_EQ(scores(study::AnswerKind::YesNo), (std::vector{1, 3}));
}

study::Question question_of(const std::string& protocol, const std::string& id) {
  const auto parsed = study::parse_protocol(protocol, "p.toml");
  for (const auto& [block, question] : study::all_questions(parsed))
    if (question->id == id) return *question;
  throw std::runtime_error("no question " + id);
}

TEST(Protocol, YesOrNoHasTheWordsOfItsLanguageAndTheirLetters) {
  const std::string text = test::answers_text();
  const auto english = question_of(text, "stalled"),
             german = question_of(test::replaced(text, "language = \"en\"", "language = \"de\""), "stalled");
  EXPECT_EQ(english.anchors, (std::vector<std::pair<int, std::string>>{{0, "no"}, {1, "yes"}}));
  EXPECT_EQ(german.anchors[1].second, "ja");
  EXPECT_EQ(study::letter_of(english, 1) + study::letter_of(english, 0), "yn");
  EXPECT_EQ(study::letter_of(german, 1) + study::letter_of(german, 0), "jn");
  auto alike = english;
  alike.anchors = {{0, "absent"}, {1, "a stall"}};
  EXPECT_EQ(study::letter_of(alike, 0), "");
}

TEST(Protocol, ALineGoesFrom0To100UnlessTheFileSaysOtherwise) {
  const auto line = question_of(test::answers_text(), "satisfaction");
  EXPECT_EQ(study::scores_of(line).size(), 101u);
  EXPECT_EQ(study::fitted_level(line), 60);
  EXPECT_EQ(question_of(test::answers_text(), "mood").scale_max, 1000);
  EXPECT_EQ(question_of(test::answers_text(), "fast").timeout_s, 2);
}

TEST(Protocol, SsqHasTheSixteenSymptoms) {
  const auto questions = study::ssq_questions("en");
  ASSERT_EQ(questions.size(), 16u);
  EXPECT_EQ(questions[7].id, "ssq_8");
  EXPECT_EQ(questions[7].text, "Nausea");
  for (const auto& question : questions) {
    EXPECT_EQ(question.scale_min, 0);
    EXPECT_EQ(question.scale_max, 3);
  }
}

TEST(Protocol, AHeadsetsRulesAreRead) {
  using study::Hold;
  const std::string pilot = shipped_text("ptpe_pilot");
  const auto with = [&](const std::string& keys) {
    return study::parse_protocol(pilot + "\n[headset]\n" + keys, "p.toml").headset;
  };
  EXPECT_EQ(study::parse_protocol(pilot, "p.toml").headset.hold, Hold::Image);
  const study::HeadsetRules rules = with("hold_margin_deg = 7.5\nworld_scale = 2\nrefresh_hz = 90\n");
  EXPECT_EQ(rules.hold_margin_deg, 7.5);
  EXPECT_EQ(rules.world_scale, 2);
  EXPECT_EQ(rules.refresh_hz, 90);
  EXPECT_EQ(with("hold = \"state\"").hold, Hold::State);
  EXPECT_EQ(with("hold = \"head_locked\"\nacknowledge = [\"head_locked\"]").hold, Hold::HeadLocked);
  EXPECT_THAT([&] { with("hold = \"head_locked\""); },
              testing::ThrowsMessage<base::Error>(HasSubstr("acknowledge")));
  EXPECT_THAT([&] { with("hold = \"state\"\nhold_margin_deg = 5"); },
              testing::ThrowsMessage<base::Error>(HasSubstr("hold_margin_deg")));
}

TEST(Protocol, OverrideMarksTestDataAndChangesTheHash) {
  auto protocol = parsed("ptpe_pilot");
  const std::string original = protocol.sha256;
  study::override_trial_seconds(protocol, 2);
  EXPECT_TRUE(protocol.test_data);
  EXPECT_NE(protocol.sha256, original);
  EXPECT_EQ(protocol.trial_seconds, 2);
  for (const auto& cell : protocol.design.cells) EXPECT_EQ(cell.setting.duration_s, 2);
  auto again = parsed("ptpe_pilot");
  study::override_trial_seconds(again, 2);
  EXPECT_EQ(again.sha256, protocol.sha256);
  study::override_trial_seconds(again, 1.5);
  EXPECT_NE(again.sha256, protocol.sha256);
  for (const double bad : {0.0, -1.0, 1e9, std::nan("")})
    EXPECT_THROW(study::override_trial_seconds(again, bad), base::Error);
}

TEST(Protocol, QuestionsComeWithTheirBlocksInOrder) {
  const auto protocol = parsed("task1");
  const auto questions = study::all_questions(protocol);
  ASSERT_EQ(questions.size(), 7u);
  EXPECT_EQ(questions[0].first, 1);
  EXPECT_EQ(questions[0].second->id, "take_part");
  EXPECT_EQ(questions[6].first, 2);
  EXPECT_EQ(questions[6].second->id, "confusion");
}

/// Task 1 with this number of scenes, at native frame rates.
std::string large_design(int scenes, int groups) {
  std::string text = shipped_text("task1");
  const auto put = [&](const std::string& from, const std::string& end, const std::string& to) {
    const auto at = text.find(from);
    text.replace(at, text.find(end, at) + end.size() - at, to);
  };
  std::string names;
  for (int i = 0; i < scenes; ++i) names += (i ? ", \"" : "\"") + std::to_string(i) + ".toml\"";
  put("scene = [", "\n", "scene = [" + names + "]\n");
  put("moments = [", "\n]\n", "");
  put("timing = ", "\"table2\"", "timing = \"native\"");
  put("groups = ", "2 ", "groups = " + std::to_string(groups) + " ");
  return text;
}

TEST(Protocol, AnAssignmentThatCannotBeListedIsRefused) {
  const auto parse = [](int scenes, int groups) {
    return [=] { study::parse_protocol(large_design(scenes, groups), "p.toml"); };
  };
  EXPECT_NO_THROW(parse(4, 4)());
  EXPECT_THAT(parse(20, 20), testing::ThrowsMessage<base::Error>(HasSubstr("sequences of scenes and n_*")));
  EXPECT_THAT(parse(101, 1), testing::ThrowsMessage<base::Error>(HasSubstr("more than 1000 cells")));
}

}  // namespace
