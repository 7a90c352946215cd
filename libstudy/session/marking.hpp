#pragma once
/// Marks what happens in a session (libstudy/markers), where and when it happens.

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/base/clock.hpp"
#include "libstudy/display/stimulus.hpp"
#include "libstudy/markers/marker.hpp"
#include "libstudy/session/participant.hpp"

namespace study {

/// Adds time and place to each marker and passes it on.
class Marking {
 public:
  /// to: the receiver; may be empty. clock: of the markers. slot: Plan::slot of the session.
  Marking(const std::function<void(const Marker&)>& to, const Clock& clock, int slot)
      : to_(to), clock_(clock), slot_(slot) {}
  /// Later markers are those of this unit and this showing of its trial; 0: a page.
  void enter(int position, int attempt);
  /// Marks an event that happens now.
  void mark(MarkerKind kind) const;
  /// The next onset is that of the trial's first (1) or second (2) stimulus.
  void next_stimulus(int number) { stimulus_ = number; }
  /// Marks the first frame of the stimulus.
  void onset(const PresentTimes& times) const;

 private:
  Marker now(MarkerKind kind) const;

  const std::function<void(const Marker&)>& to_;
  const Clock& clock_;
  int slot_, position_ = -1, attempt_ = 0, stimulus_ = 1;
};

/// The begin of a session, and its end, however it ends.
class MarkedSession {
 public:
  explicit MarkedSession(Marking& marking) : marking_(marking) { marking_.mark(MarkerKind::SessionBegin); }
  ~MarkedSession() {
    marking_.enter(-1, 0);
    marking_.mark(MarkerKind::SessionEnd);
  }
  MarkedSession(const MarkedSession&) = delete;
  MarkedSession& operator=(const MarkedSession&) = delete;

 private:
  Marking& marking_;
};

/// A participant whose questions, answers and pauses are marked. Black screens and words before a stimulus
/// are no pauses.
class MarkedParticipant final : public Participant {
 public:
  MarkedParticipant(Participant& participant, Marking& marking);
  ~MarkedParticipant() override;
  MarkedParticipant(const MarkedParticipant&) = delete;
  MarkedParticipant& operator=(const MarkedParticipant&) = delete;

  std::optional<std::string> simulated() const override { return participant_.simulated(); }
  void read(const Block& block, double least_s, Clock& clock, const Check& check) override {
    participant_.read(block, least_s, clock, check);
  }
  std::vector<TimedAnswer> ask(const Block& block, std::span<const Question> questions,
                               const Occasion& occasion, Clock& clock, const Check& check) override;
  void before_trial(const Occasion& occasion) override { participant_.before_trial(occasion); }
  void pause(const Pause& pause, Clock& clock, const Check& check) override;
  void tell(Notice notice, double least_s, Clock& clock, const Check& check) override {
    participant_.tell(notice, least_s, clock, check);
  }
  bool offer(Offer offer, Clock& clock, const Check& check) override {
    return participant_.offer(offer, clock, check);
  }

 private:
  Participant& participant_;
  Marking& marking_;
  bool shown_ = false;  ///< true: the page of the current questions was marked
};

}  // namespace study
