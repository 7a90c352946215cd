#pragma once
/// Asks the questions of a page or of a trial's step, checks the answers and stores them.

#include <optional>
#include <span>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// True if the score is on the scale, one of the choices, or left out where allowed. Only Text has words.
bool is_valid(const Question& question, const Answer& answer);

class Questioning {
 public:
  explicit Questioning(const Running& run) : run_(run) {}

  /// Asks the `questions` without an answer in `unit` yet, on one page, and commits the answers together.
  /// Personal answers go to the personal file; questions that it already answers are skipped. With `last` the
  /// unit is then done. attempt: showing of the trial that is judged, 0: a page. Returns how the answers end
  /// the session, if they do. The ending is committed with the answers, but before personal ones, so that an
  /// excluded person sees no more if the program ends in between. Refused consent stores no answers.
  /// base::Error for an invalid answer: nothing of that page is stored.
  std::optional<Ending> ask(const OpenUnit& unit, int attempt, const std::vector<Question>& questions,
                            const Occasion& occasion, bool last, const Check& check);

 private:
  std::vector<Question> left(const OpenUnit& unit, const std::vector<Question>& questions) const;
  void keep(const OpenUnit& unit, int attempt, std::span<const Question> questions,
            std::span<const TimedAnswer> answers, bool last, const std::optional<Ending>& ending);

  const Running& run_;
};

}  // namespace study
