#pragma once
/// A pilot answered by the simulated observer, as the rows that a database would give: realised = nominal
/// timing.

#include <cstdint>
#include <string>
#include <vector>

#include "libstudy/observer/ptpe_observer.hpp"
#include "libstudy/store/ratings.hpp"

namespace testing_pilot {

/// The paper's 21 settings rated once by each participant.
inline std::vector<study::RatingRow> simulated_pilot(const std::string& observer, int participants,
                                                     std::uint64_t seed) {
  const study::PtpeObserver responder(study::parse_ptpe_observer(observer));
  const study::Question question;
  std::vector<study::RatingRow> rows;
  for (int p = 0; p < participants; ++p) {
    int position = 0;
    for (const double mu : {10.0, 20.0, 30.0, 40.0, 50.0}) {
      for (const double delta : {0.0, 5.0, 10.0, 15.0, 20.0}) {
        if (delta >= mu) continue;
        study::RatingRow row;
        row.participant = "p" + std::to_string(p);
        row.observer = observer;
        row.protocol_name = "pilot";
        row.protocol_sha256 = std::string(64, '1');
        row.position = position++;
        row.nominal = {mu, delta, 10};
        row.timing.emplace();
        row.timing->verdict = study::Verdict::Pass;
        row.timing->nominal = row.nominal;
        row.timing->realised = {static_cast<std::size_t>(10 * mu), mu, mu, delta};
        study::Occasion occasion{row.participant, seed, row.position, study::BlockKind::Stimulus, {}};
        occasion.shown.push_back({0, {{}, row.nominal}, row.timing->realised, 0, 0});
        row.rating = responder.score(question, occasion, true);
        rows.push_back(row);
      }
    }
  }
  return rows;
}

}  // namespace testing_pilot
