#pragma once
/// Base of all simulated observers. Reading a page and answering questions take no time of the clock; pauses
/// wait on it. The response time is 0, or of a Reaction made up: Observer::ask().

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "libstudy/observer/picture_features.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

/// Every answer is a pure function of the observer's parameters, the seed, the participant, the unit's
/// position, the question and the shown stimuli. A question that decides on participation gets an accepted
/// score (Question::accept), so that the session continues.
class Observer : public Participant {
 public:
  void read(const Block&, double, Clock&, const Check&) final {}
  /// A press to a Reaction comes after 0.2 s and an exponential time of mean 0.1 s.
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) final;
  void pause(const Pause& pause, Clock& clock, const Check& check) final;

  /// Returns one of the question's scores. Never called for a question of kind Text or with `accept`.
  /// `judges`: true for the first question of a listed kind after the stimulus of a trial.
  virtual int score(const Question& question, const Occasion& occasion, bool judges) const = 0;
  /// True if the observer models symptom scores. Otherwise a score that would stop the session is lowered to
  /// stop_at - 1.
  virtual bool feels() const { return false; }
};

/// Random number `counter` of the stream of `key`: uniform_of() is uniform in (0, 1), normal_of() standard
/// normal (Box and Muller 1958).
double uniform_of(std::uint64_t key, std::uint64_t counter);
double normal_of(std::uint64_t key, std::uint64_t counter);
/// Keys of random streams: one for the participant, one for this question to this participant.
std::uint64_t person_key(const Occasion& occasion);
std::uint64_t question_key(const Occasion& occasion, const Question& question);

/// True for a rating on a scale that starts at 0, as in the SSQ and the FMS, but not for a Vas. Observers
/// take such a rating for a symptom.
bool asks_symptom(const Question& question);
/// The question's score that is nearest to x. Thresholds lie halfway between neighbouring scores.
int nearest_score(const Question& question, double x);
/// The score of a rating by its latent value: points above the middle of the scale. A Vas has six points, as
/// the distance between the ends of the paper's scale of 1 to 7.
int rated_score(const Question& question, double latent);
/// Draws a score of the question; every score is equally likely.
int random_score(const Question& question, const Occasion& occasion);
/// The answer of an attentive, healthy person to a question that the model does not cover: the expected score
/// of a catch question, a press to a Reaction, a low score on a symptom scale, else a random score.
int bystander_score(const Question& question, const Occasion& occasion);

/// Makes an observer from "ptpe:a=31,b=0.035", "detect:hitch_ms,threshold=60", "random", "constant:4",
/// "dropout:0.2[,OBSERVER]" or "frames[:key=number,...]". The frames observer reads `features`, which must
/// outlive it. base::Error names the character at which the text is wrong.
std::unique_ptr<Observer> make_observer(std::string_view specification, FeatureSource& features);

/// For a constant observer such as "constant:9" (alone or after "dropout"): one sentence for each rating
/// scale of the trials that does not contain the observer's score. On such a scale the observer gives the
/// nearest score. Empty for other kinds of observers. base::Error if the score is outside the scale of every
/// question of the protocol.
std::vector<std::string> scales_beyond(std::string_view specification, const Protocol& protocol);

}  // namespace study
