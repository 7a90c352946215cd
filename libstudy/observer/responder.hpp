#pragma once
/// Who answers the question after a trial: a person in front of the display, or a simulated observer.

#include <cstdint>
#include <optional>
#include <string>

#include "libstudy/pacing/clock.hpp"
#include "libstudy/protocol/protocol.hpp"
#include "stats/fps_window.hpp"

namespace study {

/// What a responder has seen.
struct ShownTrial {
  std::string participant;
  std::uint64_t seed = 0;
  int position = 0;  ///< 0-based order of presentation
  FpsSetting nominal;
  stats::FpsMoments realised;  ///< of the frames as they were shown
};

struct Answer {
  int score = 0;  ///< within the question's scale
};

class Responder {
 public:
  virtual ~Responder() = default;
  /// The specification of a simulated observer, complete with its defaults; none for a person.
  virtual std::optional<std::string> simulated() const = 0;
  /// Asks and returns when the answer is given; the time it takes passes on `clock`.
  virtual Answer answer(const Question& question, const ShownTrial& trial, Clock& clock) = 0;
};

}  // namespace study
