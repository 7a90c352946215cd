#pragma once
/// State of a participant's page: answers, effect of keys and clicks, and when the page can be confirmed. The
/// state has no window and no clock: callers pass times, ns on the session's clock.

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "libstudy/protocol/question.hpp"

namespace study {

enum class PageKey { Left, Right, Up, Down, FarLeft, FarRight, Next, Previous, Enter, Erase };

/// State of the answer to one question.
struct PageItem {
  std::optional<int> chosen;           ///< score chosen from a list, or of a Reaction; none at first
  std::optional<int> cursor;           ///< score marked by the arrow keys, or else chosen last
  std::string typed;                   ///< typed content of a Number or Text
  std::int64_t changed_ns = 0;         ///< time of the last change, without the periods of leave_out()
  std::optional<AnswerInput> input{};  ///< input device of the last change
};

/// State of one page. No answer is preselected. Answers can be changed until the page is confirmed.
/// Confirming needs an answer to each required question, and no invalid answer. Input in the first 300 ms is
/// ignored, except on a page with a Reaction, which react() or tick() confirms.
class PageState {
 public:
  static constexpr std::int64_t guard_ns = 300'000'000;
  static constexpr std::size_t most_bytes = 2000;  ///< longest content of a Text, bytes

  /// Without questions, the page is a text to read. The page can be confirmed least_s seconds after shown_ns
  /// at the earliest.
  PageState(std::span<const Question> questions, double least_s, std::int64_t shown_ns);

  /// Sets the input device of the following calls; default: keyboard.
  void use(AnswerInput input) { input_ = input; }
  /// Handles a key. Enter chooses the score that the arrow keys mark. If this score is chosen already, Enter
  /// goes to the next question, or confirms a page with a single question; at the button to go on, Enter
  /// confirms the page. Enter does nothing at a required question without a valid answer and at an invalid
  /// number. On a Vas (visual analogue scale), the arrow keys set the mark: Left and Right move it by 1 % of
  /// the line, Up, Down, FarLeft and FarRight by 10 %, but at least by one score. The first of these keys
  /// sets the mark at an end of the line.
  void press(PageKey key, std::int64_t now_ns);
  /// Handles a typed digit, 0 to 9: chooses this score if all scores have one digit; appends it to a Number.
  void digit(int digit, std::int64_t now_ns);
  void minus(std::int64_t now_ns);
  /// Handles a typed letter: chooses the answer of a YesNo that has this letter as its key (letter_of()).
  void letter(const std::string& letter, std::int64_t now_ns);
  /// Handles a press of any key, button or trigger: answers a Reaction and confirms its page.
  void react(std::int64_t now_ns);
  /// Confirms the page of a Reaction without a press once its time is over.
  void tick(std::int64_t now_ns);
  void click(std::size_t question, int score, std::int64_t now_ns);
  /// Focuses a question without answering it.
  void click_question(std::size_t question, std::int64_t now_ns);
  /// Confirms the page, or focuses the first question that prevents the confirmation.
  void click_confirm(std::int64_t now_ns);
  /// Appends letters to the focused Text. PageKey::Erase removes the last letter.
  void type(const std::string& letters, std::int64_t now_ns);
  /// Replaces the whole content of a Text by words typed at the keyboard.
  void write(std::size_t question, const std::string& words, std::int64_t now_ns);
  /// Excludes a period from response times, such as the time in a dialog above the page. Then ignores input
  /// for 300 ms. The time of a Reaction begins anew.
  void leave_out(std::int64_t from_ns, std::int64_t to_ns);

  std::size_t size() const { return questions_.size(); }
  const Question& question(std::size_t i) const { return questions_[i]; }
  const PageItem& item(std::size_t i) const { return items_[i]; }
  /// Index of the question that keys act on; size(): the button to go on.
  std::size_t focus() const { return focus_; }
  /// True if the page has a Reaction.
  bool timed() const;
  /// True if keys act on a Vas (visual analogue scale).
  bool on_line() const;
  /// True if input is ignored: in the first 300 ms (not on a page with a Reaction), in the 300 ms after
  /// leave_out(), and after the confirmation.
  bool guarded(std::int64_t now_ns) const { return confirmed() || now_ns - guarded_from_ns_ < guard_ns; }
  /// True if the question has a valid answer.
  bool answered(std::size_t question) const;
  /// True if a Number has an invalid answer, such as an age of 900.
  bool out_of_range(std::size_t question) const;
  /// Number of questions that prevent confirming: required without an answer, or with an invalid answer.
  std::size_t missing() const;
  /// Remaining part of the shortest reading time, s; the page cannot be confirmed before this is 0.
  double wait_s(std::int64_t now_ns) const;
  bool can_confirm(std::int64_t now_ns) const;
  bool confirmed() const { return confirmed_ns_.has_value(); }

  /// The answers of a confirmed page. A response time runs from the page's appearance to the last change of
  /// the answer (for an empty answer, to the confirmation), without the periods of leave_out(). `input` is
  /// the device of this change or confirmation.
  std::vector<TimedAnswer> answers() const;

 private:
  void move_cursor(int by);
  void move_mark(int percent, std::int64_t now_ns);
  void end_reaction(int score, std::int64_t at_ns);
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

/// True if typing one digit can choose each score: the answer is chosen from a list of scores, not on a line,
/// and the scores are 0 to 9.
bool one_digit_does(const Question& question);

}  // namespace study
