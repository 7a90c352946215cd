#pragma once
/// What all simulated observers share: they read at once, wait as the clock says and answer without delay.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libstudy/observer/picture_features.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

/// Every answer is a pure function of the observer's parameters, the seed, the participant, the unit's
/// position, the question and what was shown. What decides on taking part (Question::accept) is always
/// answered so that the session goes on.
class Observer : public Participant {
 public:
  void read(const Block&, double, Clock&, const Check&) final {}
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) final;
  void pause(const Pause& pause, Clock& clock, const Check& check) final;

  /// Answers a question that leaves a choice: never of kind Text, never one with `accept`. `judges`: it is
  /// the first question on this page about what was shown. A score of the question's.
  virtual int score(const Question& question, const Occasion& occasion, bool judges) const = 0;
  /// Whether its symptoms mean something: otherwise a score at which a session stops is lowered to the one
  /// below.
  virtual bool feels() const { return false; }
};

/// Uniform in (0, 1) and standard normal (Box and Muller 1958): number `counter` of a key.
double uniform_of(std::uint64_t key, std::uint64_t counter);
double normal_of(std::uint64_t key, std::uint64_t counter);
/// Of a person, and of one question put to that person.
std::uint64_t person_key(const Occasion& occasion);
std::uint64_t question_key(const Occasion& occasion, const Question& question);

/// The scores that may be given, ascending: every one of the scale, or those that have words (Choice).
std::vector<int> scores_of(const Question& question);
/// The score whose thresholds, halfway to its neighbours, hold x.
int nearest_score(const Question& question, double x);
/// Every score equally likely.
int random_score(const Question& question, const Occasion& occasion);
/// What an attentive, healthy person says where nothing was judged: the expected answer of a catch, a low
/// score of symptoms (scales from 0), else any.
int bystander_score(const Question& question, const Occasion& occasion);

/// Words of a kind's line: "ptpe:a=31,b=0.035", "random", "constant:4", "dropout:0.2[,OBSERVER]",
/// "frames[:key=number,...]". `features` is asked by frames; it must outlive the observer. base::Error that
/// names the place.
std::unique_ptr<Observer> make_observer(std::string_view specification, FeatureSource& features);

/// The scales of the trials that do not hold the score of an observer such as "constant:9" (alone or behind
/// "dropout"), a sentence each: there it gives the nearest score. Empty for observers of other kinds.
/// base::Error where no question takes the score.
std::vector<std::string> scales_beyond(std::string_view specification, const Protocol& protocol);

}  // namespace study
