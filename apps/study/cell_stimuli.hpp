#pragma once
/// The stimulus of each cell, as a session asks for it.

#include <memory>
#include <optional>

#include "apps/common/fluid_stimulus.hpp"
#include "apps/study/run_options.hpp"
#include "libstudy/session/session.hpp"

namespace apps {

/// Nothing (--display none without a bake), one bake for all cells, or live fluid made anew when a cell needs
/// another one than the last.
class CellStimuli final : public study::StimulusSource {
 public:
  CellStimuli(const RunOptions& options, const study::Protocol& protocol, const stats::PtpeModel& model,
              Viewing viewing);

  study::Stimulus& stimulus(const study::Cell& cell) override;
  /// Whether the cell is computed while it is shown.
  bool is_live(const study::Cell&) const { return live_; }
  /// Of all cells, for the record; does not depend on which of them were shown.
  std::string description() const { return description_; }
  /// In what the bake differs from what the protocol names, such as "n_* 2048 instead of 32768"; empty: in
  /// nothing. Such data are test data.
  std::string departure() const { return departure_; }
  /// What live fluid of a cell is made of.
  StimulusChoice choice_of(const study::Cell& cell) const;

 private:
  RunOptions options_;
  StimulusChoice choice_;
  bool live_ = false;
  std::string description_, departure_;
  /// What the present stimulus was made for; the frame rate counts for methods with temporal acceleration
  /// alone.
  struct Made {
    study::StimulusSpec what;
    std::optional<sim::FrameRate> rate;
    bool operator==(const Made&) const = default;
  };
  std::optional<Made> made_;
  std::unique_ptr<study::Stimulus> stimulus_;
};

}  // namespace apps
