#pragma once
/// Observers who tell nothing: a report should be able to say so.

#include <string>

#include "libstudy/observer/observer.hpp"

namespace study {

/// "random": every score equally likely, whatever was shown.
class RandomObserver final : public Observer {
 public:
  std::optional<std::string> simulated() const override { return "random"; }
  int score(const Question& question, const Occasion& occasion, bool) const override {
    return random_score(question, occasion);
  }
};

/// "constant:4": always the score nearest to it.
class ConstantObserver final : public Observer {
 public:
  explicit ConstantObserver(double score) : score_(score) {}
  std::optional<std::string> simulated() const override;
  int score(const Question& question, const Occasion&, bool) const override {
    return nearest_score(question, score_);
  }

 private:
  double score_;
};

/// "dropout:0.2,OBSERVER": answers as that observer (random, if none is named) and leaves for good with this
/// probability before each trial.
class DropoutObserver final : public Observer {
 public:
  DropoutObserver(double probability, std::unique_ptr<Observer> answers)
      : probability_(probability), answers_(std::move(answers)) {}
  std::optional<std::string> simulated() const override;
  void before_trial(const Occasion& occasion) override;
  int score(const Question& question, const Occasion& occasion, bool judges) const override {
    return answers_->score(question, occasion, judges);
  }

 private:
  double probability_;
  std::unique_ptr<Observer> answers_;
};

}  // namespace study
