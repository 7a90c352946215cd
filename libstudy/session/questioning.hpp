#pragma once
/// Asks the questions of a page or of a trial's step, checks the answers and stores them.

#include <optional>
#include <span>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// True if the score is on the question's scale or one of its choices, or if an optional question has no
/// score. A question of kind Text takes words instead of a score; only an optional one may stay empty.
bool is_valid(const Question& question, const Answer& answer);

class Questioning {
 public:
  explicit Questioning(const Running& run) : run_(run) {}

  /// Asks those of `questions` that have no answer in `unit` yet, on one page, and commits the answers
  /// together. Personal answers go to the personal file; a personal question with an answer in the file is
  /// not asked again if its wording is unchanged. If `last` is true, also marks the unit as done. attempt:
  /// number of the trial's showing that the questions are about, from 1; 0 for a page. Returns the ending if
  /// an answer ends the session. The ending is committed together with the answers, but before personal
  /// answers: if the program is killed in between, an excluded person is still excluded. Refused consent
  /// stores no answers. base::Error for an invalid answer; then no answer of the page is stored.
  std::optional<Ending> ask(const OpenUnit& unit, int attempt, const std::vector<Question>& questions,
                            const Occasion& occasion, bool last, const Check& check);

 private:
  std::vector<Question> left(const OpenUnit& unit, const std::vector<Question>& questions) const;
  void keep(const OpenUnit& unit, int attempt, std::span<const Question> questions,
            std::span<const TimedAnswer> answers, bool last, const std::optional<Ending>& ending);

  const Running& run_;
};

}  // namespace study
