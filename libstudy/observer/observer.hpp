#pragma once
/// Base of all simulated observers: they read at once, wait on the clock and answer without delay.

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libstudy/observer/picture_features.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

/// Every answer is a pure function of the observer's parameters, the seed, the participant, the unit's
/// position, the question and what was shown. Questions that decide on participation (Question::accept) are
/// always answered so that the session goes on.
class Observer : public Participant {
 public:
  void read(const Block&, double, Clock&, const Check&) final {}
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) final;
  void pause(const Pause& pause, Clock& clock, const Check& check) final;

  /// Returns one of the question's scores. Called for no question of kind Text and none with `accept`.
  /// `judges`: this is the first question on the page that judges the stimulus.
  virtual int score(const Question& question, const Occasion& occasion, bool judges) const = 0;
  /// True if its symptom scores are modelled. Otherwise a score that would stop the session is lowered to
  /// stop_at - 1.
  virtual bool feels() const { return false; }
};

/// Uniform in (0, 1) and standard normal (Box and Muller 1958): draw `counter` of a key.
double uniform_of(std::uint64_t key, std::uint64_t counter);
double normal_of(std::uint64_t key, std::uint64_t counter);
/// Random keys of a person, and of one question asked of that person.
std::uint64_t person_key(const Occasion& occasion);
std::uint64_t question_key(const Occasion& occasion, const Question& question);

/// True for a rating from 0 on, such as those of the SSQ and the FMS.
bool asks_symptom(const Question& question);
/// The score nearest to x: thresholds lie halfway between neighbouring scores.
int nearest_score(const Question& question, double x);
/// Every score equally likely.
int random_score(const Question& question, const Occasion& occasion);
/// The answer of an attentive, healthy person to a question that the model does not cover: the expected
/// answer of a catch, a low score of symptoms (scales from 0), else a random score.
int bystander_score(const Question& question, const Occasion& occasion);

/// Makes an observer from "ptpe:a=31,b=0.035", "random", "constant:4", "dropout:0.2[,OBSERVER]" or
/// "frames[:key=number,...]". The frames observer reads `features`, which must outlive it. base::Error names
/// the character at which the text is wrong.
std::unique_ptr<Observer> make_observer(std::string_view specification, FeatureSource& features);

/// One sentence for each scale of the trials that lacks the score of a constant observer such as "constant:9"
/// (alone or after "dropout"), which then gives the nearest score. Empty for other kinds of observers.
/// base::Error if no question takes the score.
std::vector<std::string> scales_beyond(std::string_view specification, const Protocol& protocol);

}  // namespace study
