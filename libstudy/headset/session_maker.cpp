#include "libstudy/headset/session_maker.hpp"

#include <fmt/format.h>

#include <chrono>
#include <thread>

#include "stats/base/error.hpp"

namespace study {

namespace {

constexpr std::chrono::milliseconds system_wait{200};
constexpr const char* mend = "see the log of the headset's software; vip-study resume continues a session";

std::string first_line(const std::string& text) { return text.substr(0, text.find('\n')); }

}  // namespace

std::unique_ptr<HeadsetSession> SessionMaker::make(std::int64_t earliest_ns) {
  choice_.earliest_ns = earliest_ns;
  if (made_ == most_sessions)
    throw DisplayGone(
        CutCause::SessionLost, "headset",
        "its software keeps losing the session: " + std::to_string(most_sessions) + " times so far", mend);
  return made_++ == 0 ? std::make_unique<HeadsetSession>(gl_, choice_) : make_anew();
}

std::unique_ptr<HeadsetSession> SessionMaker::make_anew() const {
  const auto deadline = std::chrono::steady_clock::now() + std::chrono::duration<double>(choice_.patience_s);
  for (;;) {
    try {
      return std::make_unique<HeadsetSession>(gl_, choice_);
    } catch (const base::Error& error) {
      if (std::chrono::steady_clock::now() < deadline) {
        std::this_thread::sleep_for(system_wait);
        continue;
      }
      throw DisplayGone(CutCause::SessionLost, "headset",
                        fmt::format("its session was lost, and within {:g} s none could be made anew ({})",
                                    choice_.patience_s, first_line(error.what())),
                        mend);
    }
  }
}

SessionFacts facts_of(const HeadsetSession& session) {
  return {session.description(), session.names(), session.times_convert(), session.has_eye_gaze(),
          session.picture_size()};
}

void require_alike(const SessionFacts& before, const SessionFacts& after) {
  const bool same_size =
      after.picture.width == before.picture.width && after.picture.height == before.picture.height;
  if (same_size && (after.eye_gaze || !before.eye_gaze)) return;
  throw DisplayGone(CutCause::SessionLost, "headset",
                    std::string("its session was lost, and the next one has ") +
                        (same_size ? "no eye tracker" : "pictures of another size"),
                    "check the headset's software, and continue with vip-study resume");
}

}  // namespace study
