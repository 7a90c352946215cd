#pragma once
/// The questions of a study, with their exact wording.

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace study {

/// How a question is answered. answer_kinds() says how answers of a kind are stored, asked and analysed.
enum class AnswerKind {
  Scale,    ///< a row of scores, some with words below them (Likert)
  Choice,   ///< one of a list; every score has words
  Number,   ///< a typed whole number, such as an age in years
  Text,     ///< typed text; exported only on request
  Vas,      ///< a point of a line with words at both ends (visual analogue scale)
  YesNo,    ///< a choice of 0 (no) and 1 (yes), which letter keys also select
  Reaction  ///< a press as soon as the page appears: 1, or 0 if none came within Question::timeout_s
};

struct Question {
  std::string id;  ///< unique in the protocol
  std::string text;
  std::string language;
  AnswerKind kind = AnswerKind::Scale;
  int scale_min = 1;  ///< lowest answer; not used by Text
  int scale_max = 7;
  /// (score, words) in ascending order of score.
  std::vector<std::pair<int, std::string>> anchors;
  /// Answers go to the personal file instead of the study's database (age, gender, ...).
  bool personal = false;
  /// False: the participant may leave the question unanswered.
  bool required = true;
  /// Lowest and highest accepted score. Any other answer ends the session before the first stimulus, as
  /// refused consent or exclusion.
  std::optional<std::pair<int, int>> accept;
  std::optional<int> stop_at;  ///< this score or more ends the session early: a rest, then the exit
  std::optional<int> expect;   ///< the answer of an attentive person (Catch)
  /// Scale, Vas: score at which a pilot's curve is fitted; none: the scale's midpoint.
  std::optional<double> level;
  double timeout_s = 5;  ///< Reaction: time until the page closes by itself, s

  bool operator==(const Question&) const = default;
};

/// Properties of a kind of answer. Code that reads, stores, exports or analyses answers looks up these
/// properties instead of comparing kinds. Only the code that draws questions (libstudy/pages/gui) has a
/// switch over all kinds.
struct AnswerKindTraits {
  AnswerKind kind{};
  const char* word = "";     ///< name of the kind in protocols
  const char* meaning = "";  ///< explanation of `word` in the reference of protocols
  bool scored = true;        ///< the answer is a whole number, stored as a score; otherwise words
  bool listed = false;       ///< the participant chooses one of scores_of()
  bool labelled = false;     ///< every score has words (Question::anchors); such scores have no mean
  bool line = false;         ///< listed; the participant marks a point of a line, without seeing scores
  bool yes_no = false;       ///< listed and labelled, with the scores 0 and 1; see letter_of()
  bool timed = false;    ///< scored, not listed; a press or a timeout ends the page, which asks nothing else
  bool required = true;  ///< default of Question::required
  double answering_s = 5;        ///< expected time for answering one question
  const char* stored = nullptr;  ///< name of the kind in databases and exports; null: `word`

  /// A rating: scores with equal distances, which have means.
  bool rated() const { return listed && !labelled; }
  /// A whole number that the participant types.
  bool typed() const { return scored && !listed && !timed; }
  const char* stored_word() const { return stored ? stored : word; }
};
/// One entry for each AnswerKind, in the order of the enum.
const std::array<AnswerKindTraits, 7>& answer_kinds();
const AnswerKindTraits& traits_of(AnswerKind kind);
/// "scale, choice or number": the words of the kinds for which `is` returns true; `last`, such as " or ",
/// precedes the last word.
std::string kind_words(bool (*is)(const AnswerKindTraits&), const char* last);

/// All possible scores in ascending order; none for free text.
std::vector<int> scores_of(const Question& question);
/// True if the score is a possible answer.
bool can_be_given(const Question& question, int score);

/// The key that chooses a score of a YesNo: the first letter of its words in lower case, a to z. Empty for
/// another letter, if the words of both scores begin with the same letter, and for other kinds.
std::string letter_of(const Question& question, int score);

/// Score of a scale at which a pilot's curve is fitted: Question::level, else the scale's midpoint.
double fitted_level(const Question& question);

/// The 16 symptoms of the Simulator Sickness Questionnaire, each 0 (none) to 3 (severe), in the order of
/// Kennedy, Lane, Berbaum and Lilienthal 1993; ids ssq_1 .. ssq_16.
std::vector<Question> ssq_questions(const std::string& language);
/// "fms": the Fast Motion Sickness scale, 0 (no sickness) to 20 (severe): Keshavarz and Hecht 2011.
Question fms_question(const std::string& language, std::optional<int> stop_at);

/// Ids of two questions in a consent block on whose answers (0 = no, 1 = yes) the program acts: whether gaze
/// and head movement may be recorded, and whether public exports may contain the data.
inline constexpr const char* gaze_question = "gaze_kept";
inline constexpr const char* sharing_question = "data_shared";

/// An answer: a score on the question's scale, words, or neither if it was left empty.
struct Answer {
  std::optional<int> score;
  std::string words;
};

/// Input device of an answer.
enum class AnswerInput {
  Keyboard,
  Mouse,
  Gamepad,
  Ray,      ///< a hand controller's ray and select
  Stick,    ///< the thumbstick of a hand controller
  Dwell,    ///< the participant looked at the answer until it was selected
  Observer  ///< a simulated participant
};

struct TimedAnswer {
  Answer answer;
  /// From the first display of the page to the last change of this answer, or for an empty answer to the
  /// confirmation of the page; without the time in a dialog above the page.
  double response_time_s = 0;
  /// Device that last changed this answer; for an empty answer, the device that confirmed the page; none: not
  /// known.
  std::optional<AnswerInput> input{};
};

}  // namespace study
