#include "libstudy/session/marking.hpp"

namespace study {

namespace {

/// The end of a pause, however it ends.
class MarkedPause {
 public:
  explicit MarkedPause(const Marking& marking) : marking_(marking) { marking_.mark(MarkerKind::PauseBegin); }
  ~MarkedPause() { marking_.mark(MarkerKind::PauseEnd); }
  MarkedPause(const MarkedPause&) = delete;
  MarkedPause& operator=(const MarkedPause&) = delete;

 private:
  const Marking& marking_;
};

bool is_pause(PauseKind kind) {
  switch (kind) {
    case PauseKind::Rest:
    case PauseKind::Break:
    case PauseKind::Held:
    case PauseKind::Trouble:
      return true;
    case PauseKind::Black:
    case PauseKind::First:
    case PauseKind::Second:
      break;
  }
  return false;
}

}  // namespace

void Marking::enter(int position, int attempt) {
  position_ = position;
  attempt_ = attempt;
}

Marker Marking::now(MarkerKind kind) const {
  Marker marker;
  marker.kind = kind;
  marker.slot = slot_;
  marker.position = position_;
  marker.attempt = attempt_;
  marker.clock_ns = clock_.now_ns();
  return marker;
}

void Marking::mark(MarkerKind kind) const {
  if (to_) to_(now(kind));
}

void Marking::onset(const PresentTimes& times) const {
  if (!to_) return;
  Marker marker = now(MarkerKind::StimulusOnset);
  marker.stimulus = stimulus_;
  if (times.submitted_ns >= 0) marker.clock_ns = times.submitted_ns;
  marker.display_ns = times.predicted_display_ns;
  to_(marker);
}

MarkedParticipant::MarkedParticipant(Participant& participant, Marking& marking)
    : participant_(participant), marking_(marking) {
  participant_.when_shown([this] {
    shown_ = true;
    marking_.mark(MarkerKind::QuestionShown);
  });
}

MarkedParticipant::~MarkedParticipant() { participant_.when_shown({}); }

std::vector<TimedAnswer> MarkedParticipant::ask(const Block& block, std::span<const Question> questions,
                                                const Occasion& occasion, Clock& clock, const Check& check) {
  shown_ = false;
  auto answers = participant_.ask(block, questions, occasion, clock, check);
  if (!shown_) marking_.mark(MarkerKind::QuestionShown);
  marking_.mark(MarkerKind::AnswerGiven);
  return answers;
}

void MarkedParticipant::pause(const Pause& pause, Clock& clock, const Check& check) {
  if (!is_pause(pause.kind)) return participant_.pause(pause, clock, check);
  const MarkedPause marked(marking_);
  participant_.pause(pause, clock, check);
}

}  // namespace study
