#include "libstudy/observer/observer.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "libstudy/base/random.hpp"

namespace study {

namespace {

constexpr std::int64_t look_ns = 50'000'000;

Answer answer_of(const Observer& observer, const Question& question, const Occasion& occasion, bool judges) {
  if (!traits_of(question.kind).scored) return {{}, question.required ? "simulated" : ""};
  if (question.accept) return {question.accept->first, ""};
  const int score = observer.score(question, occasion, judges);
  const bool feigned = question.stop_at && score >= *question.stop_at && !observer.feels();
  return {feigned ? *question.stop_at - 1 : score, ""};
}

/// Response time, s: 0 unless the question is timed (kind Reaction).
double answering_s(const Question& question, const Answer& answer, const Occasion& occasion) {
  if (!traits_of(question.kind).timed) return 0;
  const double u =
      uniform_of(question_key(occasion, question), static_cast<std::uint64_t>(occasion.position));
  return answer.score == 1 ? std::min(0.2 - 0.1 * std::log(u), question.timeout_s) : question.timeout_s;
}

}  // namespace

std::vector<TimedAnswer> Observer::ask(const Block&, std::span<const Question> questions,
                                       const Occasion& occasion, Clock&, const Check& check) {
  if (check) check();
  std::vector<TimedAnswer> out;
  bool judged = occasion.shown.empty();
  const bool steered = std::ranges::find(questions, steering_question_, &Question::id) != questions.end();
  for (const Question& question : questions) {
    const bool judges =
        !judged && (steered ? question.id == steering_question_ : traits_of(question.kind).listed);
    judged = judged || judges;
    const Answer answer = answer_of(*this, question, occasion, judges);
    out.push_back({answer, answering_s(question, answer, occasion), AnswerInput::Observer});
  }
  return out;
}

void Observer::pause(const Pause& pause, Clock& clock, const Check& check) {
  const std::int64_t until = clock.now_ns() + std::llround(pause.seconds * 1e9);
  for (;;) {
    if (check) check();
    if (pause.over ? pause.over() : clock.now_ns() >= until) return;
    clock.wait_until(pause.over ? clock.now_ns() + look_ns : std::min(until, clock.now_ns() + look_ns));
  }
}

double uniform_of(std::uint64_t key, std::uint64_t counter) {
  return (static_cast<double>(counter_random(key, counter) >> 11) + 0.5) * 0x1p-53;
}

double normal_of(std::uint64_t key, std::uint64_t counter) {
  const double radius = std::sqrt(-2 * std::log(uniform_of(key, 2 * counter)));
  return radius * std::cos(2 * std::numbers::pi * uniform_of(key, 2 * counter + 1));
}

std::uint64_t person_key(const Occasion& occasion) {
  return random_key("observer\n" + std::to_string(occasion.seed) + '\n' + occasion.participant);
}

std::uint64_t question_key(const Occasion& occasion, const Question& question) {
  return random_key("observer\n" + std::to_string(occasion.seed) + '\n' + occasion.participant + '\n' +
                    question.id);
}

bool asks_symptom(const Question& question) {
  const AnswerKindTraits& traits = traits_of(question.kind);
  return traits.rated() && !traits.line && question.scale_min == 0;
}

int nearest_score(const Question& question, double x) {
  const auto scores = scores_of(question);
  // Counts the thresholds below x; values of x beyond the ends of the scale need no clamping.
  std::size_t i = 0;
  while (i + 1 < scores.size() && x > 0.5 * (scores[i] + scores[i + 1])) ++i;
  return scores[i];
}

int rated_score(const Question& question, double latent) {
  const double range = question.scale_max - question.scale_min;
  const double point = traits_of(question.kind).line ? range / 6 : 1;
  return nearest_score(question, 0.5 * (question.scale_min + question.scale_max) + latent * point);
}

int random_score(const Question& question, const Occasion& occasion) {
  const auto scores = scores_of(question);
  RandomStream random(question_key(occasion, question), static_cast<std::uint64_t>(occasion.position) << 8);
  return scores[random.below(scores.size())];
}

int bystander_score(const Question& question, const Occasion& occasion) {
  if (question.expect) return *question.expect;
  if (traits_of(question.kind).timed) return question.scale_max;
  if (!asks_symptom(question)) return random_score(question, occasion);
  const double u =
      uniform_of(question_key(occasion, question), static_cast<std::uint64_t>(occasion.position));
  return nearest_score(question, -0.08 * (question.scale_max - question.scale_min) * std::log(u));
}

}  // namespace study
