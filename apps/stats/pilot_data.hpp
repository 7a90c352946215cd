#pragma once
/// From the rows of a database to the ratings that are analysed, with a count of all that is left out.

#include <map>
#include <string>
#include <vector>

#include "libstudy/store/ratings.hpp"
#include "stats/ptpe/pilot.hpp"
#include "stats/result.hpp"

namespace apps {

/// Which trials the timing verdict excludes. Degraded ones stay by default: the realised mu and delta are the
/// predictors.
enum class ExcludedVerdicts { None, Fail, Degraded };

struct PilotSelection {
  std::string protocol;  ///< leading digits of the SHA-256; empty when the database holds one protocol
  std::string question;  ///< id; empty when the protocol asks one question on a scale
  ExcludedVerdicts exclude = ExcludedVerdicts::Fail;
};

/// What is analysed and what is not. Counts are trials.
struct PilotData {
  std::string protocol_name, protocol_sha256;
  double scale_min = 1, scale_max = 7;
  bool test_data = false;          ///< there are no real data: test data are analysed
  int simulated_participants = 0;  ///< answered by an observer model
  int practice = 0;
  int repeat = 0;    ///< shown again for test-retest
  int excluded = 0;  ///< by the experimenter
  int unanswered = 0;
  int test_left_out = 0;       ///< test data beside real ones
  int simulated_left_out = 0;  ///< answered by an observer model beside those of people
  int without_timing = 0;
  std::map<std::string, int> excluded_by_verdict;  ///< "degraded", "fail"
  std::map<std::string, int> used_by_verdict;      ///< "pass", "degraded", "fail"
  std::map<std::string, int> used_by_grade;        ///< "A" to "D"
  std::vector<stats::PilotRating> ratings;
};

/// Refused with the reason: nothing stored, no such protocol or question, several of them and none chosen.
stats::Result<PilotData> select_pilot(const std::vector<study::RatingRow>& rows,
                                      const PilotSelection& selection);

}  // namespace apps
