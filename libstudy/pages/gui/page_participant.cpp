#include "libstudy/pages/gui/page_participant.hpp"

#include <cmath>

namespace study {

namespace {
// Longer than measuring the beat of a 50 Hz screen.
constexpr std::int64_t before_stimulus_ns = 250'000'000;
}  // namespace

PageText PageParticipant::page_of(const Block& block) {
  PageText page{block.title, block.text};
  if (!begun_) page.text += (page.text.empty() ? "" : "\n\n") + pages_->beginning();
  begun_ = true;
  if (block.id == last_block_) page.button = pages_->words().finish;
  return page;
}

void PageParticipant::read(const Block& block, double least_s, Clock&, const Check& check) {
  pages_->run_page(page_of(block), {}, least_s, check);
  if (block.id == last_block_) begun_ = false;
}

std::vector<TimedAnswer> PageParticipant::ask(const Block& block, std::span<const Question> questions,
                                              const Occasion&, Clock&, const Check& check) {
  auto answers = pages_->run_page(page_of(block), questions, 0, check);
  if (block.id == last_block_) begun_ = false;
  return answers;
}

void PageParticipant::pause(const Pause& pause, Clock&, const Check& check) {
  const DeskWords& words = pages_->words();
  const std::int64_t until_ns = pages_->now_ns() + std::llround(1e9 * pause.seconds);
  const auto said = [&pause](const std::string& usual) {
    return PauseWords{pause.title.empty() && pause.text.empty() ? usual : pause.title, pause.text};
  };
  switch (pause.kind) {
    case PauseKind::Black:
      pages_->wait({}, until_ns - before_stimulus_ns, check);
      before_stimulus_();
      return pages_->wait({}, until_ns, check);
    case PauseKind::Rest:
      return pages_->wait(said(words.rest), until_ns, check);
    case PauseKind::Break:
      pages_->wait(said(words.pause), until_ns, check);
      pages_->run_page({words.ready, ""}, {}, 0, check);
      return;
    case PauseKind::First:
    case PauseKind::Second: {
      const bool first = pause.kind == PauseKind::First;
      const auto over = [&] { return pages_->now_ns() >= until_ns; };
      return pages_->show_words({first ? words.first : words.second, ""}, over, check);
    }
    case PauseKind::Held:
      return pages_->show_words({words.held_title, words.held}, pause.over, check);
    case PauseKind::Trouble:
      if (pause.over) return pages_->show_words({words.trouble_title, words.trouble}, pause.over, check);
      pages_->run_page({words.trouble_title, words.trouble}, {}, 0, check);
      return;
  }
}

void PageParticipant::tell(Notice notice, double least_s, Clock&, const Check& check) {
  const DeskPage& page = pages_->words().page(notice);
  pages_->set_over(true);
  pages_->run_page({page.title, page.text, page.button}, {}, least_s, check);
  if (notice == Notice::Over) return;
  // A session of another person may follow.
  pages_->set_over(false);
  begun_ = false;
}

bool PageParticipant::offer(Offer offer, Clock&, const Check& check) {
  const bool first = pages_->choose_first(pages_->words().choice(offer), check);
  return offer == Offer::StayOut ? !first : first;
}

}  // namespace study
