#pragma once
/// A pilot answered by a simulated observer, in the form in which a database is read. Its realised timing
/// equals the nominal one.

#include <cstdint>
#include <string>

#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/store/read/task_answers.hpp"

namespace testing_pilot {

inline study::TaskShowing showing(double mu, double delta) {
  study::TaskShowing out;
  out.what = {"data/scenes/single_dam.toml", "HiRes", "32k"};
  out.nominal = {mu, delta, 10};
  out.played = true;
  out.verdict = study::Verdict::Pass;
  out.realised = {static_cast<std::size_t>(10 * mu), mu, mu, delta};
  return out;
}

/// The paper's 21 settings, rated once by each participant: sessions "p0", "p1" ... of one observer.
inline study::TaskProtocol simulated_pilot(const std::string& observer, int participants,
                                           std::uint64_t seed) {
  const study::PtpeObserver responder(study::parse_ptpe_observer(observer));
  study::Question question;
  question.id = "satisfaction";
  study::TaskProtocol out{
      "pilot",   "1.0",   std::string(64, '3'), false, participants, {"data/scenes/single_dam.toml"},
      {"HiRes"}, {"32k"}, {question},           {}};
  for (int p = 0; p < participants; ++p) {
    study::TaskSession session;
    session.participant = "p" + std::to_string(p);
    session.observer = observer;
    session.state = "done";
    session.gaze_source = "mouse";
    session.display = "window";
    for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0}) {
      for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0}) {
        if (delta >= mu) continue;
        study::TaskTrial trial;
        trial.position = static_cast<int>(session.trials.size());
        trial.kind = "stimulus";
        trial.first = showing(mu, delta);
        study::Occasion occasion{session.participant, seed, trial.position, study::BlockKind::Stimulus, {}};
        occasion.shown.push_back({0, {{}, trial.first.nominal}, trial.first.realised, 0, 0});
        trial.answers.push_back({question.id, responder.score(question, occasion, true)});
        session.trials.push_back(trial);
      }
    }
    out.sessions.push_back(session);
  }
  return out;
}

}  // namespace testing_pilot
