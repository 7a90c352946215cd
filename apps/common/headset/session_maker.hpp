#pragma once
/// Sessions in a headset, one after the other: another one where the runtime lost the last.

#include <memory>

#include "apps/common/headset/headset_session.hpp"

namespace apps {

class SessionMaker {
 public:
  /// In all. A runtime that loses this many would lose the next one, too.
  static constexpr int most_sessions = 3;

  /// gl: as HeadsetSession takes it. Makes none yet.
  SessionMaker(const sim::GlContext& gl, const HeadsetChoice& choice) : gl_(gl), choice_(choice) {}

  /// The first session, at once or not at all. Later another one, for one that was lost and is destroyed:
  /// that is tried again and again for as long as the choice's patience, for the headset may be gone for a
  /// moment. base::Error when none comes, or too many were lost. earliest_ns: see HeadsetChoice.
  std::unique_ptr<HeadsetSession> make(std::int64_t earliest_ns = 0);

 private:
  std::unique_ptr<HeadsetSession> make_anew() const;

  const sim::GlContext& gl_;
  HeadsetChoice choice_;
  int made_ = 0;
};

}  // namespace apps
