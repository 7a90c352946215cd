#pragma once
/// Lists the stimuli of a protocol that can be baked, their file names, and why the others run live.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "libstudy/stimulus/bakes/bake_order.hpp"

namespace study {

/// One stimulus of a protocol. Cells that differ only in frame rate share it, unless tau depends on that
/// rate.
struct PlannedStimulus {
  StimulusSpec what;
  std::vector<int> cells;          ///< indices into Design::cells, ascending
  std::optional<FpsSetting> rate;  ///< for tau; none: a method without tau, or native
  bool adaptive = false;           ///< its levels follow the gaze
  std::int64_t frames = 0;         ///< content steps of its longest cell; 0 under native
  std::string file;                ///< name of its bake in a folder; empty: it runs live
  std::string live;                ///< why it runs live; empty: it can be baked
};

/// The stimuli in the order of the protocol's cells. A stimulus can be baked unless the protocol runs it as
/// fast as possible (native), or its levels follow a gaze that the protocol does not fix (gaze = "fixation").
/// base::Error: unknown method or n_*.
std::vector<PlannedStimulus> plan_bakes(const Protocol& protocol);

/// Settings of a session's stimuli and picture.
struct SessionLook {
  StimulusChoice common;   ///< back end, PTPE model and viewing
  base::PictureSize size;  ///< of the participant's picture
};

/// The order for a stimulus that can be baked, without pictures. base::Error: no such scene.
BakeOrder order_of(const Protocol& protocol, const PlannedStimulus& one, const SessionLook& look);

}  // namespace study
