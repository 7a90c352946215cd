#include "libstudy/headset/session_facts.hpp"

#include "stats/base/error.hpp"

namespace study {

SessionFacts facts_of(const HeadsetSession& session) {
  return {session.description(), session.names(), session.times_convert(), session.has_eye_gaze(),
          session.picture_size()};
}

void require_alike(const SessionFacts& before, const SessionFacts& after) {
  const bool same_size =
      after.picture.width == before.picture.width && after.picture.height == before.picture.height;
  if (same_size && (after.eye_gaze || !before.eye_gaze)) return;
  throw base::Error("headset",
                    std::string("its session was lost, and the next one has ") +
                        (same_size ? "no eye tracker" : "pictures of another size"),
                    "check the headset's software, and continue with vip-study resume");
}

}  // namespace study
