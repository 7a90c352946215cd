#include "apps/study/window/window_participant.hpp"

#include <cmath>

namespace apps {

namespace {
// Longer than it takes to find the beat of a screen of 50 Hz.
constexpr std::int64_t before_stimulus_ns = 250'000'000;
}  // namespace

void WindowParticipant::read(const study::Block& block, double least_s, study::Clock& clock,
                             const study::Check& check) {
  window_->run_page(block.title, block.text, {}, least_s, clock, check);
}

std::vector<study::TimedAnswer> WindowParticipant::ask(const study::Block& block,
                                                       std::span<const study::Question> questions,
                                                       const study::Occasion&, study::Clock& clock,
                                                       const study::Check& check) {
  return window_->run_page(block.title, block.text, questions, 0, clock, check);
}

void WindowParticipant::pause(const study::Pause& pause, study::Clock& clock, const study::Check& check) {
  const DeskWords& words = window_->words();
  const std::int64_t until_ns = clock.now_ns() + std::llround(1e9 * pause.seconds);
  const auto said = [&pause](const std::string& usual) {
    return PauseWords{pause.title.empty() && pause.text.empty() ? usual : pause.title, pause.text};
  };
  switch (pause.kind) {
    case study::PauseKind::Black:
      window_->wait({}, until_ns - before_stimulus_ns, clock, check);
      before_stimulus_();
      return window_->wait({}, until_ns, clock, check);
    case study::PauseKind::Rest:
      return window_->wait(said(words.rest), until_ns, clock, check);
    case study::PauseKind::Break:
      window_->wait(said(words.pause), until_ns, clock, check);
      window_->run_page(words.ready, "", {}, 0, clock, check);
      return;
  }
}

}  // namespace apps
