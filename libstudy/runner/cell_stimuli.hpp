#pragma once
/// Provides the stimulus of each cell to a session.

#include <memory>
#include <optional>

#include "libstudy/runner/run_options.hpp"
#include "libstudy/runner/session_settings.hpp"
#include "libstudy/session/session.hpp"
#include "libstudy/stimulus/bakes/session_bakes.hpp"
#include "libstudy/stimulus/fluid_stimulus.hpp"

namespace study {

/// A bake if there is one for the cell, else live fluid, or nothing with --display none. Makes a new stimulus
/// only if a cell needs another one than the last cell.
class CellStimuli final : public StimulusSource {
 public:
  /// base::Error if a setting is for a cell that is not computed live.
  CellStimuli(const RunOptions& options, const Protocol& protocol, const stats::PtpeModel& model,
              Viewing viewing, SessionBakes bakes = {}, SessionSettings settings = {});

  Stimulus& stimulus(const Cell& cell) override;
  /// True if the cell is computed while it is shown.
  bool is_live(const Cell& cell) const { return shown_ && !bakes_.of(cell); }
  /// Description of all cells, for the record; independent of which were shown.
  std::string description() const { return description_; }
  /// Of all live fluid that was computed.
  sim::GuardCounts guards() const;
  const SessionBakes& bakes() const { return bakes_; }
  const SessionSettings& settings() const { return settings_; }
  /// The choice from which the live fluid of a cell is made.
  StimulusChoice choice_of(const Cell& cell) const;

 private:
  /// Key of the current stimulus. The frame rate is set only for methods with temporal acceleration; for a
  /// bake only its path counts.
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
  sim::GuardCounts former_guards_;  ///< of the stimuli before
};

}  // namespace study
