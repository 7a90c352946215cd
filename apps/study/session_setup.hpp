#pragma once
/// Turns options into the parts of a session: clock, display, stimulus, responder.

#include <memory>

#include "apps/study/run_options.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/observer/responder.hpp"
#include "libstudy/pacing/clock.hpp"
#include "libstudy/protocol/protocol.hpp"

namespace apps {

/// Owns the parts. The stimulus is destroyed before the display whose GL context it draws in.
struct SessionSetup {
  bool virtual_clock = false;
  /// In what the bake differs from the protocol's stimulus, such as "n_* 2048 instead of 32768"; empty: in
  /// nothing. Such data are test data.
  std::string departure;
  std::unique_ptr<study::Clock> clock;
  std::unique_ptr<study::Display> display;
  std::unique_ptr<study::Stimulus> stimulus;
  std::unique_ptr<study::Responder> responder;
};

/// The stimulus is the bake when one is named, else live fluid as the protocol says on a headless display,
/// else nothing. base::Error naming what is missing or wrong.
SessionSetup make_session_setup(const RunOptions& options, const study::Protocol& protocol);

}  // namespace apps
