#pragma once
/// Lists the stimuli of a protocol: which can be baked (precomputed), into which file, and why any other must
/// run live.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/stimulus/bakes/bake_order.hpp"

namespace study {

/// One stimulus of a protocol. Cells that differ only in frame rate share one stimulus, unless its method has
/// temporal acceleration, whose tolerance tau depends on the frame rate.
struct PlannedStimulus {
  StimulusSpec what;
  std::vector<int> cells;  ///< indices into Design::cells, ascending
  /// Frame rate from which the tolerance tau of temporal acceleration follows; none: a method without it, or
  /// TimingSource::Native.
  std::optional<FpsSetting> rate;
  bool adaptive = false;    ///< true: the method chooses levels by the gaze
  std::int64_t frames = 0;  ///< content steps of its longest cell, from step 0; 0 under TimingSource::Native
  std::string file;         ///< file name of its bake; empty: the stimulus runs live
  std::string live;         ///< reason why the stimulus runs live; empty: it can be baked
};

/// The stimuli in the order of the protocol's cells. A stimulus cannot be baked if its timing is native, if
/// its levels follow the gaze and the protocol lacks gaze = "fixation", or if it has more frames than a bake
/// can store. All other stimuli can be baked. base::Error: unknown method or n_*.
std::vector<PlannedStimulus> plan_bakes(const Protocol& protocol);

/// Settings of a session's stimuli and picture.
struct SessionLook {
  StimulusChoice common;   ///< back end, PTPE model and viewing
  base::PictureSize size;  ///< size of the participant's picture
};

/// The content of the bake of a stimulus that can be baked, without pictures. base::Error if its scene cannot
/// be read.
BakeOrder order_of(const Protocol& protocol, const PlannedStimulus& one, const SessionLook& look);

}  // namespace study
