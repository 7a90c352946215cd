#pragma once
/// A page in front of a participant: what is chosen, what keys and clicks do, and when one may go on. No
/// window and no clock: instants are given, in ns on the session's clock.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/protocol/question.hpp"

namespace apps {

enum class PageKey { Left, Right, Up, Down, Next, Previous, Enter, Erase };

/// How far one question is.
struct PageItem {
  std::optional<int> chosen;                  ///< Scale, Choice: nothing to begin with
  std::optional<int> cursor;                  ///< where the arrows are; chooses nothing
  std::string typed;                          ///< Number, Text
  std::int64_t changed_ns = 0;                ///< last change of the answer
  std::optional<study::AnswerInput> input{};  ///< what that change came from
};

/// Nothing is chosen beforehand, every answer can be changed until the page is confirmed, and that takes an
/// answer to each required question. Whatever comes in the first 300 ms counts for nothing.
class PageState {
 public:
  static constexpr std::int64_t guard_ns = 300'000'000;
  static constexpr std::size_t most_bytes = 2000;  ///< of a Text

  /// Without questions it is a text to be read. One can go on `least_s` after shown_ns at the earliest.
  PageState(std::span<const study::Question> questions, double least_s, std::int64_t shown_ns);

  /// What follows comes from this; the keyboard until it is said.
  void use(study::AnswerInput input) { input_ = input; }
  /// Enter chooses what the arrows point at, then goes to the next question and at last confirms.
  void press(PageKey key, std::int64_t now_ns);
  /// 0 to 9: the score on a scale where each is one digit, a digit of a Number.
  void digit(int digit, std::int64_t now_ns);
  void minus(std::int64_t now_ns);
  void click(std::size_t question, int score, std::int64_t now_ns);
  /// Puts the focus on a question without an answer to it.
  void click_question(std::size_t question, std::int64_t now_ns);
  /// Goes to the first question that keeps the page open, if there is one.
  void click_confirm(std::int64_t now_ns);
  /// More letters for a Text that has the focus; Erase takes the last one.
  void type(const std::string& letters, std::int64_t now_ns);
  /// What stands in the field of a Text; it was typed at the keyboard.
  void write(std::size_t question, const std::string& words, std::int64_t now_ns);
  /// Time that did not pass on the page, such as in a dialog above it, as far as the page was there; whatever
  /// follows is guarded anew.
  void leave_out(std::int64_t from_ns, std::int64_t to_ns);

  std::size_t size() const { return questions_.size(); }
  const study::Question& question(std::size_t i) const { return questions_[i]; }
  const PageItem& item(std::size_t i) const { return items_[i]; }
  /// The question that keys speak to; size(): the button to go on.
  std::size_t focus() const { return focus_; }
  /// Whether input counts for nothing: at the beginning and once it is confirmed.
  bool guarded(std::int64_t now_ns) const { return confirmed() || now_ns - guarded_from_ns_ < guard_ns; }
  /// Has a valid answer.
  bool answered(std::size_t question) const;
  /// Holds something that is no answer, such as an age of 900.
  bool out_of_range(std::size_t question) const;
  /// Required questions without an answer, and fields whose content is none.
  std::size_t missing() const;
  /// Until one may go on, s; 0 when that is over.
  double wait_s(std::int64_t now_ns) const;
  bool can_confirm(std::int64_t now_ns) const;
  bool confirmed() const { return confirmed_ns_.has_value(); }

  /// Once confirmed. Response times run from the showing of the page to the last change of each answer, and
  /// to the confirmation where it was left empty. Their input likewise.
  std::vector<study::TimedAnswer> answers() const;

 private:
  void move_cursor(int by);
  void enter(std::int64_t now_ns);
  void choose(std::size_t question, int score, std::int64_t now_ns);
  void erase(std::int64_t now_ns);
  bool put(std::size_t question, const std::string& words, std::int64_t now_ns);
  void mark_changed(PageItem& item, std::int64_t now_ns) const;
  void step_focus(int by);
  bool is_missing(std::size_t question) const;
  std::optional<int> number(std::size_t question) const;

  std::vector<study::Question> questions_;
  std::vector<PageItem> items_;
  std::int64_t least_ns_, shown_ns_, guarded_from_ns_;
  std::int64_t left_out_ns_ = 0;
  std::size_t focus_ = 0;
  study::AnswerInput input_ = study::AnswerInput::Keyboard;
  std::optional<std::int64_t> confirmed_ns_;
  std::optional<study::AnswerInput> confirmed_by_;
};

/// Every score that can be chosen, ascending: all of a Scale, those with words of a Choice.
std::vector<int> scores_of(const study::Question& question);
/// Whether one digit is enough for each of them.
bool one_digit_does(const study::Question& question);

}  // namespace apps
