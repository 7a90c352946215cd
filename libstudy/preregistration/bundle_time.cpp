/// Decides if a bundle is older than the answers, allowing for wrong clocks.
#include "libstudy/preregistration/bundle_parts.hpp"

namespace study::report {

namespace {

using Json = base::Json;

/// The result for sessions whose clock contradicts the order of the rows.
struct ByOrder {
  bool known = true;  ///< for each of them the bundle is known to be older
  std::string text;
};

/// An impossible time shows that this session's clock was wrong, so the times of the rows before it count.
/// For other contradictions it is unknown which time is wrong.
ByOrder judge_by_order(const std::string& frozen, const Json& used) {
  ByOrder out;
  for (const Json& one : used.value("doubtful_times", Json::array())) {
    const std::string shown = one.at("told_utc"), least = one.at("not_before_utc"),
                      station = one.at("station");
    const bool by_clock = frozen < shown, by_order = one.at("impossible") == true && frozen < least;
    out.known = out.known && (by_clock || by_order);
    out.text += " The clock of " + (station.empty() ? "the station" : "station " + station) + " showed " +
                shown + " at the first answer of " + one.at("participant").text() +
                ", after rows of the database of " + least + ": ";
    out.text += by_clock   ? "the bundle is older than both."
                : by_order ? "that time is not possible, and by the order of the rows the bundle is older."
                           : "the two disagree, and whether the bundle is older cannot be told.";
  }
  return out;
}

}  // namespace

Json time_json(const std::string& frozen, const Json& used) {
  const std::string title = used.at("title");
  const ByOrder order = judge_by_order(frozen, used);
  Json json{{"task", used.at("task")}};
  if (!used.at("first_answer_utc").is_string()) {
    json["frozen_before"] = order.text.empty() || !order.known ? Json() : Json(true);
    json["clocks_disagree"] = !order.text.empty();
    json["text"] =
        order.text.empty() ? "No time of an answer of " + title + " is recorded." : title + ":" + order.text;
    return json;
  }
  const std::string first = used.at("first_answer_utc");
  const bool simulated = used.value("simulated", 0) > 0, rehearsal = used.value("test_data", false);
  const bool before = frozen < first;
  json["first_answer_utc"] = first;
  json["frozen_before"] = before && !order.known ? Json() : Json(before);
  json["clocks_disagree"] = !order.text.empty();
  json["text"] = "The bundle was " + std::string(before ? "" : "not ") +
                 "frozen before the first answer of " + title + ", given " + first +
                 (simulated   ? " by an observer model."
                  : rehearsal ? " as test data."
                              : ".") +
                 order.text;
  return json;
}

}  // namespace study::report
