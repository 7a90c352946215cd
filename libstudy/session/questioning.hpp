#pragma once
/// Questions of a page or of a trial's step: asked, checked against their rules, kept.

#include <optional>
#include <span>
#include <vector>

#include "libstudy/session/running.hpp"

namespace study {

/// The score is on the scale, one of the choices, or left out where that is allowed; words stand alone.
bool is_valid(const Question& question, const Answer& answer);

class Questioning {
 public:
  explicit Questioning(const Running& run) : run_(run) {}

  /// Asks those of `questions` that have no answer in `unit` yet, on one page, and commits the answers
  /// together; personal ones go to the personal file and are not asked of a person it knows. With `last` the
  /// unit is then done. attempt: showing of the trial that is judged, 0: a page. Returns how the answers end
  /// the session, if they do; that is then committed with the answers, and before personal ones, so that
  /// whoever shall not go on is not shown more if the program ends in between. Refused consent keeps no
  /// answers. base::Error for an answer that breaks its question's rules: nothing is kept of that page.
  std::optional<Ending> ask(const OpenUnit& unit, int attempt, const std::vector<Question>& questions,
                            const Occasion& occasion, bool last, const Check& check);

 private:
  std::vector<Question> left(const OpenUnit& unit, const std::vector<Question>& questions) const;
  void keep(const OpenUnit& unit, int attempt, std::span<const Question> questions,
            std::span<const TimedAnswer> answers, bool last, const std::optional<Ending>& ending);

  const Running& run_;
};

}  // namespace study
