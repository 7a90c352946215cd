#pragma once
/// Plays one trial: its steps in order, and all steps again after each cut (repeats.hpp).

#include <array>
#include <vector>

#include "libstudy/session/questioning.hpp"
#include "libstudy/session/repeats.hpp"

namespace study {

class TrialPlayer {
 public:
  TrialPlayer(const Running& run, Questioning& questioning)
      : run_(run), questioning_(questioning), repeats_(run), first_hz_(run.parts.display.refresh_hz()) {}

  /// Plays all steps. After a cut (exception TrialAgain, caught here) plays all steps again as a new attempt,
  /// which asks all questions again. Returns the ending if an answer ends the session.
  std::optional<Ending> play(OpenUnit unit);

 private:
  /// State of one showing of a trial.
  struct Showing {
    OpenUnit& unit;
    int attempt = 1;
    Occasion occasion;
    /// Frame intervals of the first and the second stimulus, ns; empty if there is no schedule or no second
    /// stimulus.
    std::array<std::vector<std::int64_t>, 2> intervals;
    std::vector<TimingVerdict> verdicts;
    Stimulus* ready = nullptr;  ///< the started stimulus of the next stimulus step; null: not started
    int next_interval = 0;
  };

  /// play_steps() with markers for begin and end, or cut.
  std::optional<Ending> play_marked(Showing& showing);
  std::optional<Ending> play_steps(Showing& showing);
  void choose(OpenUnit& unit);
  void again(Showing& showing, const std::string& reason);
  void note_end(const OpenUnit& unit, CutCause cause) const;
  void compute_intervals(Showing& showing);
  std::array<std::vector<std::int64_t>, 2> intervals_of(const PlannedTrial& trial) const;
  const Cell& cell(const OpenUnit& unit, int interval) const;
  void black(Showing& showing, double seconds, bool stimulus_follows);
  void announce(int interval);
  void make_ready(Showing& showing);
  void show(Showing& showing, int interval);
  TimingVerdict present(std::int64_t presentation, std::int64_t start_ns, const Cell& cell,
                        const std::vector<std::int64_t>& intervals, Stimulus& stimulus,
                        ShownStimulus& shown) const;
  TimingVerdict judge(const Cell& cell, const std::vector<std::int64_t>& intervals,
                      const PlayedTrial& played) const;
  std::optional<Ending> ask(Showing& showing, std::size_t step);

  const Running& run_;
  Questioning& questioning_;
  Repeats repeats_;
  double first_hz_;  ///< the display's refresh rate when the session began
};

}  // namespace study
