#pragma once
/// What people are asked, with the exact wording.

#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace study {

/// How a question is answered. Every kind but Text has whole numbers as answers.
enum class AnswerKind {
  Scale,   ///< a row of scores, some with words below them (Likert)
  Choice,  ///< one of a list; every score has words
  Number,  ///< typed, such as years of age
  Text     ///< free words; never exported with the answers unless marked as such
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
  /// Goes to the file of personal data instead of the study's database (age, gender, ...).
  bool personal = false;
  /// False: the participant may leave it empty.
  bool required = true;
  /// An answer outside [accept_min, accept_max] ends the session before anything is shown: no consent, or a
  /// screening question that rules the person out.
  std::optional<std::pair<int, int>> accept;
  std::optional<int> stop_at;   ///< this score or more offers a rest, then the exit (Fms)
  std::optional<int> expect;    ///< the answer that attention gives (Catch)
  std::optional<double> level;  ///< Scale: score at which a pilot's curve is fitted; none: the scale's middle

  bool operator==(const Question&) const = default;
};

/// Score of a scale at which a pilot's curve is fitted: its level, else its middle.
double fitted_level(const Question& question);

/// The 16 symptoms of the Simulator Sickness Questionnaire, each 0 (none) to 3 (severe), in the order of
/// Kennedy, Lane, Berbaum and Lilienthal 1993; ids ssq_1 .. ssq_16.
std::vector<Question> ssq_questions(const std::string& language);
/// "fms": the Fast Motion Sickness scale, 0 (no sickness) to 20 (severe): Keshavarz and Hecht 2011.
Question fms_question(const std::string& language, std::optional<int> stop_at);

/// Questions whose answers the program obeys. They stand in a block of kind consent with the answers 0 = no
/// and 1 = yes: may be recorded where one looks, may the data be part of public exports.
inline constexpr const char* gaze_question = "gaze_kept";
inline constexpr const char* sharing_question = "data_shared";

/// An answer: a score on the question's scale, words, or neither when it was left empty.
struct Answer {
  std::optional<int> score;
  std::string words;
};

/// What an answer was given with.
enum class AnswerInput {
  Keyboard,
  Mouse,
  Gamepad,
  Ray,      ///< a hand's ray and select
  Stick,    ///< a controller's thumbstick
  Dwell,    ///< by looking at it for a while
  Observer  ///< a simulated participant
};

struct TimedAnswer {
  Answer answer;
  double response_time_s = 0;  ///< from the page's showing to the last change of this answer
  /// What the last change of this answer came from, and of an answer that was left empty the confirmation;
  /// none: not known.
  std::optional<AnswerInput> input{};
};

}  // namespace study
