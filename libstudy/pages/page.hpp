#pragma once
/// State of a participant's page: choices, the effect of keys and clicks, and when it can be confirmed.
/// Without window and clock: times are passed in, in ns on the session's clock.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/protocol/question.hpp"

namespace study {

enum class PageKey { Left, Right, Up, Down, Next, Previous, Enter, Erase };

/// State of one question.
struct PageItem {
  std::optional<int> chosen;           ///< Scale, Choice: none at first
  std::optional<int> cursor;           ///< position of the arrow keys; not a choice
  std::string typed;                   ///< Number, Text
  std::int64_t changed_ns = 0;         ///< last change of the answer
  std::optional<AnswerInput> input{};  ///< input of that change
};

/// Nothing is preselected. Every answer can be changed until the page is confirmed, which requires an answer
/// to each required question. Ignores input in the first 300 ms.
class PageState {
 public:
  static constexpr std::int64_t guard_ns = 300'000'000;
  static constexpr std::size_t most_bytes = 2000;  ///< of a Text

  /// Without questions the page is a text to read. It can be confirmed `least_s` after shown_ns at the
  /// earliest.
  PageState(std::span<const Question> questions, double least_s, std::int64_t shown_ns);

  /// Sets the input device of the following calls; default: keyboard.
  void use(AnswerInput input) { input_ = input; }
  /// Enter chooses the score at the arrows' position, then goes to the next question and finally confirms.
  void press(PageKey key, std::int64_t now_ns);
  /// 0 to 9: a score if all scores have one digit, or a digit of a Number.
  void digit(int digit, std::int64_t now_ns);
  void minus(std::int64_t now_ns);
  void click(std::size_t question, int score, std::int64_t now_ns);
  /// Focuses a question without answering it.
  void click_question(std::size_t question, std::int64_t now_ns);
  /// Confirms the page, or focuses the first question that prevents it.
  void click_confirm(std::int64_t now_ns);
  /// Appends letters to the focused Text; Erase removes the last one.
  void type(const std::string& letters, std::int64_t now_ns);
  /// Sets the content of a Text, typed at the keyboard.
  void write(std::size_t question, const std::string& words, std::int64_t now_ns);
  /// Excludes time not spent on the page, such as in a dialog above it, from response times; then ignores
  /// input for 300 ms again.
  void leave_out(std::int64_t from_ns, std::int64_t to_ns);

  std::size_t size() const { return questions_.size(); }
  const Question& question(std::size_t i) const { return questions_[i]; }
  const PageItem& item(std::size_t i) const { return items_[i]; }
  /// The question that keys act on; size(): the button to go on.
  std::size_t focus() const { return focus_; }
  /// True if input is ignored: at the beginning and after the confirmation.
  bool guarded(std::int64_t now_ns) const { return confirmed() || now_ns - guarded_from_ns_ < guard_ns; }
  /// True if the question has a valid answer.
  bool answered(std::size_t question) const;
  /// True if the field has an invalid answer, such as an age of 900.
  bool out_of_range(std::size_t question) const;
  /// Number of required questions without an answer and of fields with an invalid one.
  std::size_t missing() const;
  /// Time until the page can be confirmed, s; 0 if that is over.
  double wait_s(std::int64_t now_ns) const;
  bool can_confirm(std::int64_t now_ns) const;
  bool confirmed() const { return confirmed_ns_.has_value(); }

  /// The answers; call once confirmed. Response times run from the page's appearance to the last change of
  /// each answer, or to the confirmation if it was left empty; the same holds for their input.
  std::vector<TimedAnswer> answers() const;

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

  std::vector<Question> questions_;
  std::vector<PageItem> items_;
  std::int64_t least_ns_, shown_ns_, guarded_from_ns_;
  std::int64_t left_out_ns_ = 0;
  std::size_t focus_ = 0;
  AnswerInput input_ = AnswerInput::Keyboard;
  std::optional<std::int64_t> confirmed_ns_;
  std::optional<AnswerInput> confirmed_by_;
};

/// True if the question lists scores and each is a single digit.
bool one_digit_does(const Question& question);

}  // namespace study
