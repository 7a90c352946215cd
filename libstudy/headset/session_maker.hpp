#pragma once
/// Makes a headset's first session, and a new session when the runtime loses one. Some properties of the new
/// session must equal those of the lost one.

#include <memory>
#include <string>

#include "libstudy/headset/headset_session.hpp"

namespace study {

/// Properties of one session.
struct SessionFacts {
  std::string description;  ///< headset, picture size and pixel format
  HeadsetNames names;
  bool times_convert = false, eye_gaze = false;
  base::PictureSize picture;  ///< size of both eyes' pictures side by side
};

SessionFacts facts_of(const HeadsetSession& session);

/// Throws base::Error if the program cannot go on with the new session: its pictures have another size, or it
/// lacks the eye tracker that the lost session had.
void require_alike(const SessionFacts& before, const SessionFacts& after);

class SessionMaker {
 public:
  /// Largest number of sessions. A runtime that loses this many is likely to lose the next one as well.
  static constexpr int most_sessions = 3;

  /// gl: the context of all sessions; must be current on the thread that calls make() and outlive the
  /// sessions. The constructor makes no session.
  SessionMaker(const sim::GlContext& gl, const HeadsetChoice& choice) : gl_(gl), choice_(choice) {}

  /// The first call makes the first session, with one attempt. Later calls make a new session; destroy the
  /// lost one before. They retry for HeadsetChoice::patience_s, because the headset may be absent only for a
  /// moment. base::Error if no session can be made, or after most_sessions. earliest_ns: lower bound of the
  /// session's first time, if the runtime's times do not convert to the session's clock.
  std::unique_ptr<HeadsetSession> make(std::int64_t earliest_ns = 0);

 private:
  std::unique_ptr<HeadsetSession> make_anew() const;

  const sim::GlContext& gl_;
  HeadsetChoice choice_;
  int made_ = 0;
};

}  // namespace study
