#pragma once
/// Makes a headset's first session, and new ones when the runtime loses it. Some facts of a session must not
/// change then.

#include <memory>
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

class SessionMaker {
 public:
  /// In all. A runtime that loses this many would lose the next one, too.
  static constexpr int most_sessions = 3;

  /// gl: as in HeadsetSession. Makes no session yet.
  SessionMaker(const sim::GlContext& gl, const HeadsetChoice& choice) : gl_(gl), choice_(choice) {}

  /// Makes the first session, with one attempt. Later calls make a new session after the lost one was
  /// destroyed: they retry for the choice's patience, because the headset may be gone only for a moment.
  /// base::Error if none can be made, or too many were lost. earliest_ns: see HeadsetChoice.
  std::unique_ptr<HeadsetSession> make(std::int64_t earliest_ns = 0);

 private:
  std::unique_ptr<HeadsetSession> make_anew() const;

  const sim::GlContext& gl_;
  HeadsetChoice choice_;
  int made_ = 0;
};

}  // namespace study
