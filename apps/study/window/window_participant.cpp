#include "apps/study/window/window_participant.hpp"

#include <cmath>

namespace apps {

namespace {
// Longer than it takes to find the beat of a screen of 50 Hz.
constexpr std::int64_t before_stimulus_ns = 250'000'000;
}  // namespace

PageText WindowParticipant::page_of(const study::Block& block) {
  PageText page{block.title, block.text};
  if (!begun_) page.text += (page.text.empty() ? "" : "\n\n") + window_->words().begin;
  begun_ = true;
  if (block.id == last_block_) page.button = window_->words().finish;
  return page;
}

void WindowParticipant::read(const study::Block& block, double least_s, study::Clock& clock,
                             const study::Check& check) {
  window_->run_page(page_of(block), {}, least_s, clock, check);
  if (block.id == last_block_) begun_ = false;
}

std::vector<study::TimedAnswer> WindowParticipant::ask(const study::Block& block,
                                                       std::span<const study::Question> questions,
                                                       const study::Occasion&, study::Clock& clock,
                                                       const study::Check& check) {
  auto answers = window_->run_page(page_of(block), questions, 0, clock, check);
  if (block.id == last_block_) begun_ = false;
  return answers;
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
      window_->run_page({words.ready, ""}, {}, 0, clock, check);
      return;
    case study::PauseKind::First:
    case study::PauseKind::Second: {
      const bool first = pause.kind == study::PauseKind::First;
      const auto over = [&] { return clock.now_ns() >= until_ns; };
      return window_->show_words({first ? words.first : words.second, ""}, over, clock, check);
    }
    case study::PauseKind::Held:
      return window_->show_words({words.held_title, words.held}, pause.over, clock, check);
  }
}

void WindowParticipant::tell(study::Notice notice, double least_s, study::Clock& clock,
                             const study::Check& check) {
  const DeskPage& page = window_->words().page(notice);
  window_->set_over(true);
  window_->run_page({page.title, page.text, page.button}, {}, least_s, clock, check);
  if (notice == study::Notice::Over) return;
  // Another person's session may follow.
  window_->set_over(false);
  begun_ = false;
}

bool WindowParticipant::offer(study::Offer offer, study::Clock& clock, const study::Check& check) {
  const bool first = window_->choose_first(window_->words().choice(offer), clock, check);
  return offer == study::Offer::StayOut ? !first : first;
}

}  // namespace apps
