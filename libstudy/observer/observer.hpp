#pragma once
/// Base of all simulated observers. Reading a page and answering questions take no time of the clock; pauses
/// wait on the clock. The response time of an answer is 0, except for a question of kind Reaction: see
/// Observer::ask().

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
  /// The response time of a press to a Reaction is 0.2 s plus an exponential time of mean 0.1 s, at most the
  /// question's timeout.
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) final;
  void pause(const Pause& pause, Clock& clock, const Check& check) final;
  /// Sets the question whose answers steer the protocol's procedure. On a page with this question, the
  /// observer's model answers it, and not the page's first question (`judges` below).
  void set_steering_question(std::string id) { steering_question_ = std::move(id); }

  /// Returns one of the question's scores. Never called for a question that is not scored (Text) or that has
  /// `accept`. `judges`: true for the steering question on a page that follows a stimulus; on a page
  /// without it, for the first question with listed answers (AnswerKindTraits::listed).
  virtual int score(const Question& question, const Occasion& occasion, bool judges) const = 0;
  /// True if the observer models symptom scores. Otherwise a score that would stop the session is lowered to
  /// stop_at - 1.
  virtual bool feels() const { return false; }

 private:
  std::string steering_question_;
};

/// Random number `counter` of the stream of `key`: uniform_of() is uniform in (0, 1), normal_of() standard
/// normal (Box and Muller 1958).
double uniform_of(std::uint64_t key, std::uint64_t counter);
double normal_of(std::uint64_t key, std::uint64_t counter);
/// Keys of random streams, computed from the session's seed. person_key() differs between participants,
/// question_key() between participants and between questions.
std::uint64_t person_key(const Occasion& occasion);
std::uint64_t question_key(const Occasion& occasion, const Question& question);

/// True for a rating on a scale that starts at 0, as in the SSQ and the FMS, but not for a Vas. Observers
/// treat such a rating as a symptom score.
bool asks_symptom(const Question& question);
/// The question's score that is nearest to x. Thresholds lie halfway between neighbouring scores.
int nearest_score(const Question& question, double x);
/// The score of a rating whose latent value lies `latent` points above the middle of the scale. A point is
/// one score; on a Vas it is a sixth of the line, because the paper's scale of 1 to 7 has six steps.
int rated_score(const Question& question, double latent);
/// Draws a score of the question; every score is equally likely.
int random_score(const Question& question, const Occasion& occasion);
/// The answer to a question that the observer's model does not cover, as of an attentive, healthy person: the
/// expected score of a catch question, a press to a Reaction, a low score on a symptom scale, else a random
/// score.
int bystander_score(const Question& question, const Occasion& occasion);

/// Makes an observer from "ptpe:a=31,b=0.035", "detect:hitch_ms,threshold=60", "random", "constant:4",
/// "dropout:0.2[,OBSERVER]" or "frames[:key=number,...]". The frames observer reads `features`, which must
/// outlive it. base::Error names the character at which the text is wrong.
std::unique_ptr<Observer> make_observer(std::string_view specification, FeatureSource& features);

/// For a constant observer such as "constant:9" (alone or after "dropout"): one sentence for each rating
/// scale of the trials that does not contain the observer's score. On such a scale the observer gives the
/// nearest score. Empty for other kinds of observers. base::Error if there is such a scale and no question
/// with listed answers in the whole protocol has the score; questions that decide on participation do not
/// count.
std::vector<std::string> scales_beyond(std::string_view specification, const Protocol& protocol);

}  // namespace study
