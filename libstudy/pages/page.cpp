#include "libstudy/pages/page.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "stats/base/text.hpp"

namespace study {

namespace {

/// Percent of the line of a Vas (visual analogue scale) by which a key moves the mark; 0 for other keys.
int percent_of(PageKey key) {
  switch (key) {
    case PageKey::Left:
      return -1;
    case PageKey::Right:
      return 1;
    case PageKey::Down:
    case PageKey::FarLeft:
      return -10;
    case PageKey::Up:
    case PageKey::FarRight:
      return 10;
    default:
      return 0;
  }
}

}  // namespace

bool one_digit_does(const Question& question) {
  const auto scores = scores_of(question);
  const AnswerKindTraits& traits = traits_of(question.kind);
  return traits.listed && !traits.line && scores.front() >= 0 && scores.back() <= 9;
}

PageState::PageState(std::span<const Question> questions, double least_s, std::int64_t shown_ns)
    : questions_(questions.begin(), questions.end()),
      items_(questions.size()),
      least_ns_(std::llround(1e9 * least_s)),
      shown_ns_(shown_ns),
      guarded_from_ns_(timed() ? shown_ns - guard_ns : shown_ns) {}

bool PageState::timed() const { return size() == 1 && traits_of(questions_[0].kind).timed; }

bool PageState::on_line() const { return focus_ < size() && traits_of(questions_[focus_].kind).line; }

void PageState::press(PageKey key, std::int64_t now_ns) {
  if (guarded(now_ns)) return;
  if (const int percent = percent_of(key); percent != 0 && on_line()) return move_mark(percent, now_ns);
  const bool list = focus_ < size() && traits_of(questions_[focus_].kind).labelled;
  switch (key) {
    case PageKey::Left:
      return move_cursor(-1);
    case PageKey::Right:
      return move_cursor(+1);
    case PageKey::Up:
      return list ? move_cursor(-1) : step_focus(-1);
    case PageKey::Down:
      return list ? move_cursor(+1) : step_focus(+1);
    case PageKey::FarLeft:
    case PageKey::FarRight:
      return;
    case PageKey::Next:
      return step_focus(+1);
    case PageKey::Previous:
      return step_focus(-1);
    case PageKey::Enter:
      return enter(now_ns);
    case PageKey::Erase:
      return erase(now_ns);
  }
}

void PageState::step_focus(int by) {
  if (by < 0 && focus_ > 0) --focus_;
  if (by > 0 && focus_ < size()) ++focus_;
}

void PageState::move_cursor(int by) {
  if (focus_ == size() || !traits_of(questions_[focus_].kind).listed) return;
  PageItem& item = items_[focus_];
  const auto scores = scores_of(questions_[focus_]);
  if (!item.cursor) item.cursor = item.chosen;
  if (!item.cursor) {  // begins at the lowest score with +1, at the highest with -1
    item.cursor = by > 0 ? scores.front() : scores.back();
    return;
  }
  const auto at = std::find(scores.begin(), scores.end(), *item.cursor);
  const auto next = (at - scores.begin()) + by;
  if (next >= 0 && next < static_cast<std::ptrdiff_t>(scores.size())) {
    item.cursor = scores[static_cast<std::size_t>(next)];
  }
}

void PageState::move_mark(int percent, std::int64_t now_ns) {
  const Question& line = questions_[focus_];
  const auto one_percent = static_cast<double>(line.scale_max - line.scale_min) / 100;
  const int step = std::max(1, static_cast<int>(std::lround(std::abs(percent) * one_percent)));
  const std::optional<int> at = items_[focus_].chosen;
  if (!at) return choose(focus_, percent > 0 ? line.scale_min : line.scale_max, now_ns);
  choose(focus_, std::clamp(*at + (percent > 0 ? step : -step), line.scale_min, line.scale_max), now_ns);
}

void PageState::letter(const std::string& letter, std::int64_t now_ns) {
  if (guarded(now_ns) || focus_ == size() || letter.empty()) return;
  for (const int score : scores_of(questions_[focus_]))
    if (letter_of(questions_[focus_], score) == letter) return choose(focus_, score, now_ns);
}

void PageState::react(std::int64_t now_ns) {
  if (!timed() || guarded(now_ns)) return;
  tick(now_ns);
  if (!confirmed()) end_reaction(1, now_ns);
}

void PageState::tick(std::int64_t now_ns) {
  if (!timed() || confirmed()) return;
  const std::int64_t end_ns = shown_ns_ + std::llround(1e9 * questions_[0].timeout_s);
  if (now_ns >= end_ns) end_reaction(0, end_ns);
}

void PageState::end_reaction(int score, std::int64_t at_ns) {
  items_[0].chosen = score;
  items_[0].changed_ns = at_ns;
  if (score == 1) items_[0].input = input_;
  confirmed_ns_ = at_ns;
}

void PageState::mark_changed(PageItem& item, std::int64_t now_ns) const {
  item.changed_ns = now_ns - left_out_ns_;
  item.input = input_;
}

void PageState::enter(std::int64_t now_ns) {
  if (focus_ == size()) return click_confirm(now_ns);
  const PageItem& item = items_[focus_];
  if (item.cursor && item.cursor != item.chosen) return choose(focus_, *item.cursor, now_ns);
  if (!answered(focus_) && (questions_[focus_].required || out_of_range(focus_))) return;
  step_focus(+1);
  if (size() == 1) click_confirm(now_ns);
}

void PageState::choose(std::size_t question, int score, std::int64_t now_ns) {
  PageItem& item = items_[question];
  item.cursor = score;
  if (item.chosen == score) return;
  item.chosen = score;
  mark_changed(item, now_ns);
}

void PageState::digit(int digit, std::int64_t now_ns) {
  if (guarded(now_ns) || focus_ == size() || digit < 0 || digit > 9) return;
  const Question& question = questions_[focus_];
  if (traits_of(question.kind).typed()) {
    PageItem& item = items_[focus_];
    if (item.typed.size() >= 9) return;
    item.typed += static_cast<char>('0' + digit);
    mark_changed(item, now_ns);
  } else if (one_digit_does(question)) {
    const auto scores = scores_of(question);
    if (std::find(scores.begin(), scores.end(), digit) != scores.end()) choose(focus_, digit, now_ns);
  }
}

void PageState::minus(std::int64_t now_ns) {
  if (guarded(now_ns) || focus_ == size() || !traits_of(questions_[focus_].kind).typed()) return;
  PageItem& item = items_[focus_];
  if (!item.typed.empty() || questions_[focus_].scale_min >= 0) return;
  item.typed = "-";
  mark_changed(item, now_ns);
}

void PageState::erase(std::int64_t now_ns) {
  if (focus_ == size()) return;
  PageItem& item = items_[focus_];
  if (item.typed.empty()) return;
  const auto follows = [](char byte) { return (static_cast<unsigned char>(byte) & 0xC0U) == 0x80U; };
  while (item.typed.size() > 1 && follows(item.typed.back()))
    item.typed.pop_back();  // continuation bytes of a UTF-8 character
  item.typed.pop_back();
  mark_changed(item, now_ns);
}

void PageState::click(std::size_t question, int score, std::int64_t now_ns) {
  if (guarded(now_ns) || question >= size() || !traits_of(questions_[question].kind).listed) return;
  const auto scores = scores_of(questions_[question]);
  if (std::find(scores.begin(), scores.end(), score) == scores.end()) return;
  focus_ = question;
  choose(question, score, now_ns);
}

void PageState::click_question(std::size_t question, std::int64_t now_ns) {
  if (!guarded(now_ns) && question < size()) focus_ = question;
}

void PageState::click_confirm(std::int64_t now_ns) {
  if (guarded(now_ns)) return;
  for (std::size_t i = 0; i < size(); ++i) {
    if (!is_missing(i)) continue;
    focus_ = i;
    return;
  }
  if (!can_confirm(now_ns)) return;
  confirmed_ns_ = now_ns - left_out_ns_;
  confirmed_by_ = input_;
}

void PageState::write(std::size_t question, const std::string& words, std::int64_t now_ns) {
  if (put(question, words, now_ns)) items_[question].input = AnswerInput::Keyboard;
}

bool PageState::put(std::size_t question, const std::string& words, std::int64_t now_ns) {
  if (guarded(now_ns) || question >= size() || words.size() > most_bytes) return false;
  if (traits_of(questions_[question].kind).scored || items_[question].typed == words) return false;
  items_[question].typed = words;
  mark_changed(items_[question], now_ns);
  return true;
}

void PageState::type(const std::string& letters, std::int64_t now_ns) {
  if (focus_ < size()) put(focus_, items_[focus_].typed + letters, now_ns);
}

void PageState::leave_out(std::int64_t from_ns, std::int64_t to_ns) {
  guarded_from_ns_ = to_ns;
  if (timed()) {
    shown_ns_ = to_ns;
    return;
  }
  left_out_ns_ += std::max<std::int64_t>(0, to_ns - std::max(from_ns, shown_ns_));
}

std::optional<int> PageState::number(std::size_t question) const {
  const auto value = base::parse_number<int>(items_[question].typed);
  const Question& asked = questions_[question];
  return value && *value >= asked.scale_min && *value <= asked.scale_max ? value : std::nullopt;
}

bool PageState::answered(std::size_t question) const {
  const AnswerKindTraits& traits = traits_of(questions_[question].kind);
  if (traits.listed || traits.timed) return items_[question].chosen.has_value();
  return traits.typed() ? number(question).has_value() : !base::is_blank(items_[question].typed);
}

bool PageState::out_of_range(std::size_t question) const {
  return traits_of(questions_[question].kind).typed() && !items_[question].typed.empty() && !number(question);
}

std::size_t PageState::missing() const {
  std::size_t count = 0;
  for (std::size_t i = 0; i < size(); ++i) count += is_missing(i) ? 1 : 0;
  return count;
}

bool PageState::is_missing(std::size_t question) const {
  return out_of_range(question) || (questions_[question].required && !answered(question));
}

double PageState::wait_s(std::int64_t now_ns) const {
  const std::int64_t left = least_ns_ - (now_ns - left_out_ns_ - shown_ns_);
  return left > 0 ? 1e-9 * static_cast<double>(left) : 0;
}

bool PageState::can_confirm(std::int64_t now_ns) const { return missing() == 0 && wait_s(now_ns) == 0; }

std::vector<TimedAnswer> PageState::answers() const {
  if (!confirmed())
    throw std::logic_error("PageState::answers(): the page is not confirmed; wait until confirmed() is true");
  std::vector<TimedAnswer> out;
  for (std::size_t i = 0; i < size(); ++i) {
    TimedAnswer timed;
    const bool given = answered(i);
    const AnswerKindTraits& traits = traits_of(questions_[i].kind);
    if (given && !traits.scored) timed.answer.words = items_[i].typed;
    if (given && (traits.listed || traits.timed)) timed.answer.score = items_[i].chosen;
    if (given && traits.typed()) timed.answer.score = number(i);
    const std::int64_t end_ns = given ? items_[i].changed_ns : *confirmed_ns_;
    timed.response_time_s = 1e-9 * static_cast<double>(end_ns - shown_ns_);
    timed.input = given ? items_[i].input : confirmed_by_;
    out.push_back(timed);
  }
  return out;
}

}  // namespace study
