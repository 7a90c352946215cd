#pragma once
/// What of a session must stay as it was when another one stands in for it.

#include <string>

#include "apps/common/headset/headset_session.hpp"

namespace apps {

/// What a session is; another one may stand in for one that is lost.
struct SessionFacts {
  std::string description;  ///< headset, picture and format
  HeadsetNames names;
  bool times_convert = false, eye_gaze = false;
  PictureSize picture;  ///< both eyes beside each other
};

SessionFacts facts_of(const HeadsetSession& session);

/// Throws base::Error where a loop and its program cannot go on with the one that stands in.
void require_alike(const SessionFacts& before, const SessionFacts& after);

}  // namespace apps
