/// Function of Store that writes what a light sensor saw.

#include "libstudy/store/light_evidence.hpp"
#include "libstudy/store/names.hpp"
#include "libstudy/store/store.hpp"
#include "stats/base/file.hpp"

namespace study {

using sqlite::Statement;
using sqlite::Transaction;

void Store::add_light(std::int64_t session, std::span<const LightEvidence> evidence) {
  if (evidence.empty()) return;
  Transaction transaction(*database_);
  Statement insert(*database_, "INSERT OR REPLACE INTO light VALUES (?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?,?)");
  const std::string now = base::utc_now();
  for (const LightEvidence& one : evidence) {
    const ShowingLight& light = one.light;
    std::string missed;
    for (const std::int64_t frame : light.missed)
      missed += (missed.empty() ? "" : " ") + std::to_string(frame);
    const auto measured = [&](double value) {
      return light.matched > 0 ? std::optional(value) : std::nullopt;
    };
    insert
        .bind_all(light.presentation, one.log_sha256, now, one.interval_ms,
                  one.grade ? std::optional(grade_name(*one.grade)) : std::nullopt,
                  one.why_not.empty() ? std::nullopt : std::optional(one.why_not), light.frames,
                  light.matched, static_cast<std::int64_t>(light.missed.size()), missed, light.hidden,
                  light.extra, measured(light.lag_ms), one.absolute ? 1 : 0, measured(light.jitter_ms),
                  measured(light.worst_ms), one.drift_ppm)
        .run();
  }
  insert_event(session, {}, "light read",
               std::to_string(evidence.size()) + " showings, log " + evidence.front().log_sha256, {});
  commit(transaction);
}

}  // namespace study
