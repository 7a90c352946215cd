#include "libstudy/session/questioning.hpp"

#include <algorithm>
#include <string>

#include "stats/base/error.hpp"

namespace study {

namespace {

bool in_span(int score, const std::pair<int, int>& span) {
  return score >= span.first && score <= span.second;
}

void check_answers(std::span<const Question> questions, std::span<const TimedAnswer> answers) {
  if (answers.size() != questions.size()) {
    throw base::Error("a page of " + std::to_string(questions.size()) + " questions",
                      "returned " + std::to_string(answers.size()) + " answers",
                      "fix the code that asks the questions");
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (is_valid(questions[i], answers[i].answer)) continue;
    const auto& score = answers[i].answer.score;
    throw base::Error(
        "question '" + questions[i].id + "'",
        score ? "got score " + std::to_string(*score) + ", which it does not take" : "got no valid answer",
        "correct the observer model or the page that answered; the protocol has the question's scale");
  }
}

std::optional<Ending> ending(const Block& block, std::span<const Question> questions,
                             std::span<const TimedAnswer> answers) {
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto& accept = questions[i].accept;
    const auto score = answers[i].answer.score;
    if (accept && !(score && in_span(*score, *accept)))
      return Ending{block.kind == BlockKind::Consent ? EarlyEnd::Refused : EarlyEnd::NotEligible,
                    "block " + block.id};
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const auto score = answers[i].answer.score;
    if (questions[i].stop_at && score && *score >= *questions[i].stop_at)
      return Ending{EarlyEnd::Stopped, "stop rule of block " + block.id};
  }
  return {};
}

bool refused(const std::optional<Ending>& ends) { return ends && ends->how == EarlyEnd::Refused; }

/// The answer as text: a choice as its words, any other score as a number.
std::string in_words(const Question& question, const Answer& answer) {
  if (!answer.score) return answer.words;
  for (const auto& [score, words] : question.anchors) {
    if (traits_of(question.kind).labelled && score == *answer.score) return words;
  }
  return std::to_string(*answer.score);
}

}  // namespace

bool is_valid(const Question& question, const Answer& answer) {
  if (!traits_of(question.kind).scored) return !answer.score && (!question.required || !answer.words.empty());
  if (!answer.words.empty()) return false;
  if (!answer.score) return !question.required;
  return can_be_given(question, *answer.score);
}

std::vector<Question> Questioning::left(const OpenUnit& unit, const std::vector<Question>& questions) const {
  const bool any_personal =
      std::any_of(questions.begin(), questions.end(), [](const Question& q) { return q.personal; });
  std::vector<PersonalEntry> known;
  if (any_personal) known = run_.parts.personal->read(run_.session.plan.participant);
  std::vector<Question> out;
  for (const Question& question : questions) {
    const bool answered =
        std::find(unit.answered.begin(), unit.answered.end(), question.id) != unit.answered.end();
    const bool told = question.personal && std::any_of(known.begin(), known.end(), [&](const auto& entry) {
                        return entry.question == question.id && entry.wording == question.text;
                      });
    if (!answered && !told) out.push_back(question);
  }
  return out;
}

void Questioning::keep(const OpenUnit& unit, int attempt, std::span<const Question> questions,
                       std::span<const TimedAnswer> answers, bool last, const std::optional<Ending>& ending) {
  std::vector<KeptAnswer> kept;
  std::vector<PersonalEntry> personal;
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const Question& question = questions[i];
    if (question.personal) {
      personal.push_back(
          {run_.session.plan.participant, question.id, question.text, in_words(question, answers[i].answer)});
    } else {
      kept.push_back({question.id, answers[i]});
    }
  }
  if (!personal.empty()) {
    // Personal answers are committed to another file, and a stored personal answer is not asked again. So the
    // ending that the answers cause is committed first: a kill between the two commits then cannot lose it.
    if (ending) run_.parts.store.end_session(run_.session.id, *ending, run_.now_ns());
    run_.parts.personal->keep(personal);
  }
  const bool ends_here = ending && personal.empty();
  if (last || ends_here || !kept.empty()) {
    run_.parts.store.answer(run_.session.id, unit, attempt, kept, last, run_.now_ns(),
                            ends_here ? ending : std::nullopt);
  }
}

std::optional<Ending> Questioning::ask(const OpenUnit& unit, int attempt,
                                       const std::vector<Question>& questions, const Occasion& occasion,
                                       bool last, const Check& check) {
  const std::vector<Question> asked = left(unit, questions);
  const Block& block = run_.block(unit);
  std::vector<TimedAnswer> answers;
  std::optional<Ending> ends;
  for (bool meant = asked.empty(); !meant;) {
    answers = run_.parts.participant.ask(block, asked, occasion, run_.parts.clock, check);
    check_answers(asked, answers);
    ends = ending(block, asked, answers);
    // Asks to confirm a refusal, so that a mistaken key press does not end the session. Without confirmation
    // the page is asked again.
    meant = !refused(ends) || run_.parts.participant.offer(Offer::StayOut, run_.parts.clock, check);
  }
  if (refused(ends))
    run_.parts.store.end_session(run_.session.id, *ends, run_.now_ns());
  else
    keep(unit, attempt, asked, answers, last, ends);
  return ends;
}

}  // namespace study
