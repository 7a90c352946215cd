#pragma once
/// Makes a headset's first session, and new ones when the runtime loses it.

#include <memory>

#include "libstudy/headset/headset_session.hpp"

namespace study {

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
