#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/base/random.hpp"
#include "libstudy/observer/detection_observer.hpp"
#include "libstudy/observer/frames_observer.hpp"
#include "libstudy/observer/observer.hpp"
#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/observer/specification.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"

namespace study {

namespace {

// The answers of RandomObserver and ConstantObserver carry no information about the stimulus. A report should
// be able to detect these observers.

/// "random": every score of a question is equally likely for every stimulus.
class RandomObserver final : public Observer {
 public:
  std::optional<std::string> simulated() const override { return "random"; }
  int score(const Question& question, const Occasion& occasion, bool) const override {
    return random_score(question, occasion);
  }
};

/// "constant:4": answers with the question's score that is nearest to 4, whatever the stimulus.
class ConstantObserver final : public Observer {
 public:
  explicit ConstantObserver(double score) : score_(score) {}
  std::optional<std::string> simulated() const override { return "constant:" + shortest_number(score_); }
  int score(const Question& question, const Occasion&, bool) const override {
    return nearest_score(question, score_);
  }

 private:
  double score_;
};

/// "dropout:0.2,OBSERVER": answers as OBSERVER does (default: random). Before each trial the observer leaves
/// the study with this probability.
class DropoutObserver final : public Observer {
 public:
  DropoutObserver(double probability, std::unique_ptr<Observer> answers)
      : probability_(probability), answers_(std::move(answers)) {}
  std::optional<std::string> simulated() const override {
    return "dropout:" + shortest_number(probability_) + "," + answers_->simulated().value();
  }
  void before_trial(const Occasion& occasion) override {
    const std::uint64_t key =
        random_key("leaves\n" + std::to_string(occasion.seed) + '\n' + occasion.participant);
    if (uniform_of(key, static_cast<std::uint64_t>(occasion.position)) < probability_) throw Left();
  }
  int score(const Question& question, const Occasion& occasion, bool judges) const override {
    return answers_->score(question, occasion, judges);
  }

 private:
  double probability_;
  std::unique_ptr<Observer> answers_;
};

constexpr std::string_view constant = "constant:", dropout = "dropout:";
const std::string kinds =
    "write ptpe:a=31,b=0.035, detect:hitch_ms,threshold=60, frames, random, constant:4 or dropout:0.2";

std::unique_ptr<Observer> make_dropout(std::string_view specification, FeatureSource& features) {
  const std::size_t end = std::min(specification.find(','), specification.size());
  const double probability = read_observer_number(specification, dropout.size(),
                                                  specification.substr(dropout.size(), end - dropout.size()),
                                                  0, 1, "write dropout:0.2, a probability from 0 to 1");
  const std::string_view rest = specification.substr(std::min(end + 1, specification.size()));
  if (rest.starts_with(dropout))
    fail_observer(specification, end + 1, "names dropout twice",
                  "name dropout once, then the observer that answers, as in dropout:0.2,constant:4");
  return std::make_unique<DropoutObserver>(probability,
                                           make_observer(rest.empty() ? "random" : rest, features));
}

/// The score of a constant observer, such as 4 for "constant:4" and "dropout:0.2,constant:4"; none for other
/// observers.
std::optional<double> constant_of(std::string_view specification) {
  std::size_t at = 0;
  if (specification.starts_with(dropout))
    at = std::min(specification.find(','), specification.size() - 1) + 1;
  if (!specification.substr(at).starts_with(constant)) return {};
  return read_observer_number(specification, at + constant.size(), specification.substr(at + constant.size()),
                              -1e4, 1e4, "write constant:4");
}

bool takes(const Question& question, double score) {
  const auto scores = scores_of(question);
  return score >= scores.front() && score <= scores.back();
}

std::string scale_of(const Question& question) {
  const auto scores = scores_of(question);
  return "question '" + question.id + "' goes from " + std::to_string(scores.front()) + " to " +
         std::to_string(scores.back());
}

}  // namespace

std::vector<std::string> scales_beyond(std::string_view specification, const Protocol& protocol) {
  const auto score = constant_of(specification);
  if (!score) return {};
  std::vector<std::string> beyond;
  bool taken = false;
  int lowest = 0;
  for (const auto& [block, question] : all_questions(protocol)) {
    if (!traits_of(question->kind).listed || question->accept) continue;
    const bool fits = takes(*question, *score);
    taken = taken || fits;
    const bool of_trials = protocol.blocks.at(static_cast<std::size_t>(block)).kind == BlockKind::Stimulus;
    if (fits || !of_trials || !traits_of(question->kind).rated()) continue;
    if (beyond.empty()) lowest = question->scale_min;
    beyond.push_back(scale_of(*question));
  }
  if (!taken && !beyond.empty())
    throw base::Error("--observer " + std::string(specification),
                      "gives " + shortest_number(*score) + ", which no question of protocol '" +
                          protocol.name + "' takes: " + beyond.front(),
                      "write a score of that scale, such as constant:" + std::to_string(lowest));
  return beyond;
}

std::unique_ptr<Observer> make_observer(std::string_view specification, FeatureSource& features) {
  if (specification == "random") return std::make_unique<RandomObserver>();
  if (specification.starts_with(constant)) {
    return std::make_unique<ConstantObserver>(read_observer_number(specification, constant.size(),
                                                                   specification.substr(constant.size()),
                                                                   -1e4, 1e4, "write constant:4"));
  }
  if (specification.starts_with(dropout)) return make_dropout(specification, features);
  if (specification.starts_with("frames"))
    return std::make_unique<FramesObserver>(parse_frames_observer(specification), features);
  if (specification.starts_with("detect:"))
    return std::make_unique<DetectionObserver>(parse_detection_observer(specification));
  if (specification.starts_with("ptpe:"))
    return std::make_unique<PtpeObserver>(parse_ptpe_observer(specification));
  fail_observer(specification, 0, "is not a kind of observer", kinds);
}

}  // namespace study
