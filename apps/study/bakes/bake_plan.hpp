#pragma once
/// Which stimuli of a protocol can be baked, under which names, and why the others run live.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "apps/study/bakes/bake_order.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// One stimulus of a protocol. Cells that differ in their frame rate alone share it, unless tau follows from
/// that rate.
struct PlannedStimulus {
  study::StimulusSpec what;
  std::vector<int> cells;                 ///< indices into Design::cells, ascending
  std::optional<study::FpsSetting> rate;  ///< that tau follows from; none: a method without tau, or native
  bool adaptive = false;                  ///< its levels follow the gaze
  std::int64_t frames = 0;                ///< content steps that its longest cell shows; 0 under native
  std::string file;                       ///< name of its bake in a folder; empty: it runs live
  std::string live;                       ///< why it runs live; empty: it can be baked
};

/// In the order of the protocol's cells. A stimulus can be baked unless the protocol runs it as fast as it
/// goes (native), or its levels follow a gaze that the protocol does not prescribe (gaze = "fixation").
/// base::Error: a method or n_* that is not known.
std::vector<PlannedStimulus> plan_bakes(const study::Protocol& protocol);

/// How a session shows what it shows.
struct SessionLook {
  StimulusChoice common;  ///< back end, PTPE model and viewing
  PictureSize size;       ///< of the participant's picture
};

/// The bake of a stimulus that can be baked, without pictures. base::Error: no such scene.
BakeOrder order_of(const study::Protocol& protocol, const PlannedStimulus& one, const SessionLook& look);

}  // namespace apps
