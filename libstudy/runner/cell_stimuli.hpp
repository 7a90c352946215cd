#pragma once
/// Provides the stimulus of each cell to a session.

#include <memory>
#include <optional>

#include "libstudy/runner/run_options.hpp"
#include "libstudy/runner/session_settings.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/stimulus/bakes/session_bakes.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"
#include "libstudy/stimulus/light_patch.hpp"

namespace study {

/// Shows a cell from its bake if it has one. A cell without a bake is live fluid, or with --display none an
/// empty stimulus. RunOptions::light_patch: draws the patch for a light sensor over each; a call of
/// stimulus() then begins a showing. Uses the stimulus of the last cell again if the next cell needs the same
/// stimulus.
class CellStimuli final : public StimulusSource {
 public:
  /// base::Error if a solver setting is for a cell that is not computed live. If stimuli are shown (not
  /// --display none), also base::Error if a cell names an unknown method, n_* or effect, if a scene cannot be
  /// read, or if an obstacle of a live cell leaves the water too little space (sim::check_ways()).
  CellStimuli(const RunOptions& options, const Protocol& protocol, const stats::PtpeModel& model,
              Viewing viewing, SessionBakes bakes = {}, SessionSettings settings = {});

  Stimulus& stimulus(const Cell& cell) override;
  /// True if the cell is computed while it is shown.
  bool is_live(const Cell& cell) const { return shown_ && !bakes_.of(cell); }
  /// Description of the stimuli of all cells for the session's record, including cells that are not shown.
  std::string description() const { return description_; }
  /// Numbers of interventions of the solver's guards (sim::GuardCounts), summed over all live fluid computed
  /// so far.
  sim::GuardCounts guards() const;
  const SessionBakes& bakes() const { return bakes_; }
  const SessionSettings& settings() const { return settings_; }
  /// The parameters of the live fluid of a cell.
  StimulusChoice choice_of(const Cell& cell) const;

 private:
  /// Identifies the current stimulus. For a bake only `bake` and the surface are set; for the empty
  /// stimulus nothing is set.
  /// `rate`, the cell's frame rate, is set only for methods whose fluid depends on it (temporal
  /// acceleration).
  struct Made {
    StimulusSpec what;
    std::optional<sim::FrameRate> rate;
    std::filesystem::path bake;
    bool operator==(const Made&) const = default;
  };
  Made wanted_for(const Cell& cell) const;
  std::unique_ptr<Stimulus> make(const Cell& cell, const Made& wanted) const;
  void check_settings_live(const Protocol& protocol) const;
  std::string describe(const Protocol& protocol);

  Protocol protocol_;
  StimulusChoice choice_;
  SessionBakes bakes_;
  SessionSettings settings_;
  bool shown_ = false;  ///< true: cells without a bake run live; false: they show nothing
  std::string description_;
  std::optional<Made> made_;
  std::unique_ptr<Stimulus> stimulus_;
  bool with_patch_ = false;
  std::unique_ptr<LightPatch> patch_;  ///< over stimulus_; null: no patch, or no stimulus yet
  sim::GuardCounts former_guards_;     ///< guards() of all stimuli before the current stimulus, summed
};

}  // namespace study
