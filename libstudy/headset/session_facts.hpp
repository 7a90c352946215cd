#pragma once
/// Facts of a session, some of which must not change when a new session replaces a lost one.

#include <string>

#include "libstudy/headset/headset_session.hpp"

namespace study {

/// Facts of one session.
struct SessionFacts {
  std::string description;  ///< headset, picture and format
  HeadsetNames names;
  bool times_convert = false, eye_gaze = false;
  base::PictureSize picture;  ///< size of both eyes' pictures side by side
};

SessionFacts facts_of(const HeadsetSession& session);

/// Throws base::Error if a loop and its program cannot go on with the new session.
void require_alike(const SessionFacts& before, const SessionFacts& after);

}  // namespace study
