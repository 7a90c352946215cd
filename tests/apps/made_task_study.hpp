#pragma once
/// Studies of Task 1 and Task 2, made in memory in the form in which they are read from a database.

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "libstudy/analysis/tasks/results.hpp"
#include "libstudy/analysis/tasks/sickness_json.hpp"
#include "libstudy/store/read/sickness.hpp"
#include "libstudy/store/read/task_answers.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace made_study {

inline const std::vector<std::string> methods{"LoRes", "FovFluid", "Ours", "Ours-TSp", "HiRes"};
inline const std::vector<std::string> scenes{"data/scenes/single_dam.toml", "data/scenes/jet_impact.toml",
                                             "data/scenes/faucet.toml"};
inline const std::vector<std::string> items{"disorientation", "unrealism", "dizziness", "confusion"};
/// Quality of each method, points.
inline const std::vector<double> quality{-1.5, -0.5, 0.5, 0.8, 0.4};

inline study::Question scale(const std::string& id, int min, int max) {
  study::Question question;
  question.id = id;
  question.scale_min = min;
  question.scale_max = max;
  return question;
}

inline study::TaskShowing showing(const std::string& scene, const std::string& method,
                                  const std::string& n_star) {
  study::TaskShowing out;
  out.what = {scene, method, n_star};
  out.nominal = {30, 9, 30};
  out.played = true;
  out.verdict = study::Verdict::Pass;
  out.realised = {900, 30.01, 33, 9.01};
  out.longest_ms = 180;
  return out;
}

inline study::TaskSession session(const std::string& participant, const std::string& gaze) {
  study::TaskSession out;
  out.participant = participant;
  out.state = "done";
  out.gaze_source = gaze;
  out.display = "window";
  out.angles = "camera 75 degrees, eye 27.4 degrees, ratio 0.37";
  return out;
}

inline std::string code(int person) { return (person < 9 ? "P0" : "P") + std::to_string(person + 1); }

inline int rounded(double value, int min, int max) {
  return std::clamp(static_cast<int>(std::lround(value)), min, max);
}

/// Questions on a page whose answers are personal data.
inline std::vector<study::Question> questions_about_people() {
  study::Question age = scale("age", 10, 110), gender;
  age.kind = study::AnswerKind::Number;
  age.text = "Your age in years";
  gender.id = "gender";
  gender.text = "Your gender";
  gender.kind = study::AnswerKind::Choice;
  gender.anchors = {{0, "female"}, {1, "male"}, {2, "another"}, {3, "I would rather not say"}};
  for (auto* question : {&age, &gender}) question->personal = true;
  return {age, gender};
}

/// Age and gender of all participants but the last, who gave no answers. Ages are 20 to 31 years. The first
/// participant answered "another". The second, fourth and so on are male, the others female.
inline std::vector<study::PersonalEntry> about_people(int participants) {
  std::vector<study::PersonalEntry> out;
  for (int person = 0; person + 1 < participants; ++person) {
    out.push_back({code(person), "age", "Your age in years", std::to_string(20 + person % 12)});
    out.push_back({code(person), "gender", "Your gender",
                   person == 0       ? "another"
                   : person % 2 == 0 ? "female"
                                     : "male"});
  }
  return out;
}

/// Task 1: each person sees one scene at each n_*, in five showings each. The experimenter was not blind to
/// the second person.
inline study::TaskProtocol task1(int participants, const std::string& gaze = "tracked", unsigned seed = 1) {
  study::TaskProtocol out{"task1", "1.0",   std::string(64, '1'), false, participants,
                          scenes,  methods, {"16k", "32k"},       {},    {}};
  out.questions.push_back(scale("realism", 1, 7));
  for (const auto& item : items) out.questions.push_back(scale(item, 0, 3));
  out.about_people = questions_about_people();
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  for (int person = 0; person < participants; ++person) {
    auto visit = session(code(person), gaze);
    const double level = 0.5 * normal(generator);
    for (int position = 0; position < 10; ++position) {
      const auto block = static_cast<std::size_t>(position / 5),
                 method = static_cast<std::size_t>(position % 5);
      study::TaskTrial trial;
      trial.position = position;
      trial.kind = "stimulus";
      trial.first = showing(scenes[(static_cast<std::size_t>(person) + block) % 3], methods[method],
                            block ? "32k" : "16k");
      trial.answers.push_back({"realism", rounded(4 + quality[method] + level + normal(generator), 1, 7)});
      for (const auto& item : items)
        trial.answers.push_back({item, rounded(0.8 - 0.5 * quality[method] + 0.7 * normal(generator), 0, 3)});
      for (auto& answer : trial.answers) answer.response_time_s = 1.5 + 0.25 * (person % 4) + 0.1 * position;
      visit.trials.push_back(trial);
    }
    if (person == 1) visit.unblinded = "mirror opened and setting revealed";
    out.sessions.push_back(visit);
  }
  return out;
}

/// Task 2: each person sees all ten pairs in one scene.
inline study::TaskProtocol task2(int participants, const std::string& gaze = "tracked", unsigned seed = 2) {
  study::TaskProtocol out{"task2", "1.0", std::string(64, '2'), true, participants, scenes, methods, {"32k"},
                          {},      {}};
  study::Question preference;
  preference.id = "preference";
  preference.kind = study::AnswerKind::Choice;
  preference.anchors = {{1, "first"}, {2, "second"}};
  out.questions = {preference};
  std::mt19937_64 generator(seed);
  std::normal_distribution<double> normal;
  for (int person = 0; person < participants; ++person) {
    auto visit = session(code(person), gaze);
    for (std::size_t a = 0; a < 5; ++a) {
      for (std::size_t b = a + 1; b < 5; ++b) {
        study::TaskTrial trial;
        trial.position = static_cast<int>(visit.trials.size());
        trial.kind = "stimulus";
        const bool swapped = (person + trial.position) % 2 != 0;
        const std::size_t first = swapped ? b : a, second = swapped ? a : b;
        const auto& scene = scenes[static_cast<std::size_t>(person) % 3];
        trial.first = showing(scene, methods[first], "32k");
        trial.second = showing(scene, methods[second], "32k");
        const bool chosen = quality[first] - quality[second] + normal(generator) > 0;
        trial.answers.push_back({"preference", chosen ? 1 : 2});
        visit.trials.push_back(trial);
      }
    }
    out.sessions.push_back(visit);
  }
  return out;
}

/// SSQ pages before and after, and eleven rising answers on the FMS.
inline std::vector<study::SicknessSession> sickness(int participants, unsigned seed = 3) {
  std::mt19937_64 generator(seed);
  std::exponential_distribution<double> skewed(1.5);
  std::vector<study::SicknessSession> out;
  for (int person = 0; person < participants; ++person) {
    study::SicknessSession one;
    one.protocol_name = "task1_lab";
    one.protocol_sha256 = std::string(64, '1');
    one.participant = code(person);
    for (const bool before : {true, false}) {
      study::SsqPage& page = one.ssq.emplace_back();
      page.before = before;
      page.block = before ? "ssq_before" : "ssq_after";
      for (auto& answer : page.answers) answer = rounded((before ? 0.5 : 1) * skewed(generator), 0, 3);
    }
    for (int asked = 0; asked <= 10; ++asked)
      one.fms.push_back({asked,
                         asked == 0 ? "sickness" : "ratings",
                         {},
                         "",
                         1.5 * asked,
                         rounded(0.6 * asked * skewed(generator), 0, 20)});
    out.push_back(one);
  }
  return out;
}

inline study::PlanInForce quick_plan() {
  study::PlanInForce plan;
  plan.plan.resamples = 200;
  return plan;
}

/// The results of the pilot, both tasks and own designs. `question`: id of the pilot's question to analyse;
/// empty: all its questions.
inline study::Json results_of(const study::TaskStudy& study, const study::PlanInForce& plan = quick_plan(),
                              const std::string& question = "") {
  study::ResultsRequest request{
      "folder/study.db",
      {study::TaskKind::Pilot, study::TaskKind::Task1, study::TaskKind::Task2, study::TaskKind::Own},
      "",
      plan};
  request.question = question;
  return study::make_results(study, request).json;
}

/// The results of a study with a simulated pilot and both tasks.
inline study::Json whole_study(int people, const study::TaskProtocol& first) {
  auto out = results_of(
      {.protocols = {testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 16, 7), first, task2(people)},
       .withdrawn = 1,
       .about_people = about_people(people)});
  out["sickness"] = study::sickness_json(sickness(people), quick_plan().plan);
  return out;
}

}  // namespace made_study
