#include "libstudy/analysis/tasks/study_tables.hpp"

#include <algorithm>
#include <cmath>
#include <set>

#include "stats/inference/binomial.hpp"
#include "stats/inference/describe.hpp"
#include "stats/mean_interval.hpp"

namespace study {

namespace {

constexpr int curve_points = 61;
/// For a question with more possible scores than this, only the scores that were given are listed.
constexpr std::size_t most_counted_scores = 21;

/// n, mean, SD and interval of values of participants. The interval is Student's t. An interval of shares is
/// cut off at 0 and 1; it is by Clopper and Pearson if all participants have the share 0, or all have 1.
Json over_people(const std::vector<double>& values, double confidence, bool shares = false) {
  Json json{{"n", values.size()}, {"mean", Json()}, {"sd", Json()}, {"ci", Json()}};
  if (values.empty()) return json;
  auto interval = stats::mean_interval(values, confidence);
  if (shares) {
    interval.low = std::max(interval.low, 0.0);
    interval.high = std::min(interval.high, 1.0);
    if (interval.mean == 0 || interval.mean == 1) {
      const auto n = static_cast<int>(values.size());
      const auto exact =
          stats::binomial_test(interval.mean == 1 ? n : 0, n, 0.5, stats::Alternative::TwoSided, confidence);
      if (exact) {
        interval.low = exact->clopper_pearson[0];
        interval.high = exact->clopper_pearson[1];
      }
    }
  }
  json["mean"] = json_number(interval.mean);
  const auto described = stats::describe(values);
  if (described) json["sd"] = json_number(described->sd);
  if (values.size() > 1) json["ci"] = json_interval(std::array{interval.low, interval.high});
  return json;
}

struct CellKey {
  int cell = 0, other = -1;
  auto operator<=>(const CellKey&) const = default;  // NOLINT(modernize-use-nullptr): false positive
};

std::string score_words(const Question& question, int score) {
  for (const auto& [value, words] : question.anchors)
    if (value == score) return words;
  return "";
}

Json score_counts(const Question& question, const std::vector<CellAnswer>& answers) {
  std::map<int, int> counts;
  const auto scores = scores_of(question);
  if (scores.size() <= most_counted_scores)
    for (const int score : scores) counts[score] = 0;
  for (const CellAnswer& one : answers) ++counts[one.score];
  Json list = Json::array();
  for (const auto& [score, n] : counts)
    list.push_back({{"score", score}, {"words", score_words(question, score)}, {"n", n}});
  return list;
}

Json levels_json(const Design& design, const Cell& cell) {
  Json json = Json::object();
  for (std::size_t f = 0; f < design.factors.size(); ++f)
    json[design.factors[f].name] = level_name(design, cell, f);
  return json;
}

Json cell_entry(const Design& design, const Question& question, const CellKey& key,
                const std::vector<CellAnswer>& answers, double confidence) {
  const Cell& cell = design.cells.at(static_cast<std::size_t>(key.cell));
  Json json{{"cell", cell_name(design, cell)}};
  if (key.other >= 0) json["other"] = cell_name(design, design.cells.at(static_cast<std::size_t>(key.other)));
  json["levels"] = levels_json(design, cell);
  std::map<int, std::pair<double, int>> people;
  for (const CellAnswer& one : answers) {
    people[one.participant].first += one.value;
    ++people[one.participant].second;
  }
  std::vector<double> means;
  for (const auto& [person, sum] : people)
    if (!std::isnan(sum.first)) means.push_back(sum.first / sum.second);
  json["trials"] = answers.size();
  json["participants"] = people.size();
  const Json over = over_people(means, confidence, value_of(design, question) != OutcomeValue::Mean);
  for (const char* name : {"mean", "sd", "ci"}) json[name] = over.at(name);
  json["counts"] = score_counts(question, answers);
  return json;
}

/// Describes in words, for display, the value of one participant in a cell, over which a cell's mean is
/// taken.
std::string value_words(const Design& design, const Question& question) {
  if (!traits_of(question.kind).labelled) return "mean score";
  if (design.pairs && question.anchors.size() == 2)
    return design.standard ? "share of trials that chose the comparison"
                           : "share of trials that chose the first named cell";
  const auto score = positive_score(question, {});
  return score ? "share of \"" + score_words(question, *score) + "\"" : "counts of choices";
}

/// The level of the factor that sets the surface, such as "surface spheres"; empty if all cells with this
/// surface do not share the level of a factor that other cells lack.
std::string level_of_surface(const Design& design, const std::string& surface) {
  for (std::size_t f = 0; f < design.factors.size(); ++f) {
    std::set<int> with, without;
    for (const Cell& cell : design.cells)
      (cell.stimulus.surface == surface ? with : without).insert(cell.levels[f]);
    if (with.size() == 1 && !without.contains(*with.begin()))
      return design.factors[f].name + " " +
             design.factors[f].levels.at(static_cast<std::size_t>(*with.begin()));
  }
  return "";
}

/// The surfaces that the protocol names, each with the level of the factor that sets it. Empty if the
/// protocol names no surface.
Json surfaces_json(const Design& design) {
  std::set<std::string> surfaces;
  for (const Cell& cell : design.cells)
    if (!cell.stimulus.surface.empty()) surfaces.insert(cell.stimulus.surface);
  Json out = Json::object();
  for (const std::string& one : surfaces)
    out[one] = surfaces.size() > 1 ? level_of_surface(design, one) : "every stimulus";
  return out;
}

}  // namespace

Json design_json(const Design& design) {
  Json factors = Json::array();
  for (const DesignFactor& factor : design.factors)
    factors.push_back(
        {{"name", factor.name}, {"vary", factor.between ? "between" : "within"}, {"levels", factor.levels}});
  Json json{{"factors", factors}, {"cells", design.cells.size()}, {"pairs", design.pairs}};
  if (design.standard) {
    Json standard = Json::object();
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      if (const auto level = (*design.standard)[f])
        standard[design.factors[f].name] = design.factors[f].levels.at(static_cast<std::size_t>(*level));
    json["standard"] = standard;
  }
  if (Json surfaces = surfaces_json(design); !surfaces.empty()) json["surfaces"] = std::move(surfaces);
  if (design.procedure)
    json["procedure"] = {{"kind", procedure_word(design.procedure->kind)},
                         {"factor", design.factors[design.procedure->factor].name},
                         {"axis", design.procedure->axis},
                         {"question", design.procedure->question},
                         {"trials", design.procedure->trials}};
  return json;
}

Json groups_json(const TaskData& data) {
  const Design& design = data.protocol.whole->design;
  const auto groups = cell_groups(design);
  const auto of_people = groups_of_people(data);
  Json list = Json::array();
  if (std::ranges::none_of(design.factors, &DesignFactor::between)) return list;
  for (std::size_t g = 0; g < groups.size(); ++g) {
    const Cell& cell = design.cells.at(static_cast<std::size_t>(groups[g].front()));
    std::string name;
    for (std::size_t f = 0; f < design.factors.size(); ++f)
      if (design.factors[f].between)
        name += (name.empty() ? "" : ", ") + design.factors[f].name + " " + level_name(design, cell, f);
    list.push_back({{"group", name},
                    {"participants", std::count(of_people.begin(), of_people.end(), static_cast<int>(g))}});
  }
  return list;
}

Json answers_by_cell_json(const TaskData& data, double confidence, const std::vector<std::string>& declared) {
  const Design& design = data.protocol.whole->design;
  Json list = Json::array();
  for (const Question& question : data.protocol.questions) {
    std::map<CellKey, std::vector<CellAnswer>> cells;
    for (const CellAnswer& one : cell_answers(data, question, {}))
      cells[{one.cell, one.other.value_or(-1)}].push_back(one);
    Json entries = Json::array();
    for (const auto& [key, answers] : cells)
      entries.push_back(cell_entry(design, question, key, answers, confidence));
    const bool is_declared = std::count(declared.begin(), declared.end(), question.id) > 0;
    list.push_back({{"question", question.id},
                    {"text", question.text},
                    {"kind", traits_of(question.kind).word},
                    {"value", outcome_word(value_of(design, question))},
                    {"value_text", value_words(design, question)},
                    {"exploratory", !is_declared},
                    {"cells", entries}});
  }
  return list;
}

namespace {

stats::PsychometricCurve curve_of(const Procedure& procedure, const TrackEstimate& estimate) {
  const auto& lapses = procedure.lapses;
  double lapse = 0;
  for (const double one : lapses) lapse += one / static_cast<double>(lapses.size());
  return {procedure.form, estimate.threshold.mean, estimate.shape.mean, procedure.guess, lapse};
}

Json track_entry(const TaskData& data, const DesignTrack& track,
                 const std::vector<const PersonTrack*>& people, double confidence) {
  const Procedure& procedure = *data.protocol.whole->design.procedure;
  std::vector<double> thresholds;
  Json points = Json::array(), curve = Json::array();
  for (const PersonTrack* one : people) thresholds.push_back(one->estimate.threshold.mean);
  const auto& values = people.front()->estimate.values;
  for (std::size_t i = 0; i < values.size(); ++i) {
    int trials = 0, positive = 0;
    for (const PersonTrack* one : people) {
      trials += one->estimate.trials_at[i];
      positive += one->estimate.positive_at[i];
    }
    points.push_back({{"value", values[i]},
                      {"trials", trials},
                      {"positive", positive},
                      {"share", trials > 0 ? Json(static_cast<double>(positive) / trials) : Json()}});
  }
  for (int i = 0; i < curve_points; ++i) {
    const double x = std::lerp(values.front(), values.back(), i / (curve_points - 1.0));
    double sum = 0;
    for (const PersonTrack* one : people) sum += curve_of(procedure, one->estimate)(x);
    curve.push_back({{"value", x}, {"share", sum / static_cast<double>(people.size())}});
  }
  Json json{{"track", track.name}};
  json.update(over_people(thresholds, confidence));
  json["points"] = points;
  json["curve"] = curve;
  return json;
}

}  // namespace

Json thresholds_json(const TaskData& data, std::span<const PersonTrack> tracks, double confidence,
                     bool declared) {
  if (tracks.empty()) return {};
  const Procedure& procedure = *data.protocol.whole->design.procedure;
  const auto all = tracks_of(data.protocol.whole->design);
  Json people = Json::array(), means = Json::array();
  for (const PersonTrack& one : tracks)
    people.push_back(
        {{"participant", data.participants.at(static_cast<std::size_t>(one.participant))},
         {"track", all.at(one.track).name},
         {"trials", one.estimate.trials},
         {"threshold", one.estimate.threshold.mean},
         {"threshold_ci", json_interval(std::array{one.estimate.threshold.low, one.estimate.threshold.high})},
         {"shape", one.estimate.shape.mean},
         {"shape_ci", json_interval(std::array{one.estimate.shape.low, one.estimate.shape.high})}});
  for (std::size_t t = 0; t < all.size(); ++t) {
    std::vector<const PersonTrack*> of_track;
    for (const PersonTrack& one : tracks)
      if (one.track == t) of_track.push_back(&one);
    if (!of_track.empty()) means.push_back(track_entry(data, all[t], of_track, confidence));
  }
  return {{"question", procedure.question},
          {"axis", procedure.axis},
          {"form", stats::psychometric_word(procedure.form)},
          {"guess", procedure.guess},
          {"credibility", 0.95},
          {"exploratory", !declared},
          {"participants", people},
          {"tracks", means}};
}

Json participants_json(const TaskData& data, const std::set<std::string>* earlier) {
  std::map<std::string, std::vector<const TaskSession*>> people;
  for (const TaskSession& session : data.protocol.sessions) people[session.participant].push_back(&session);
  Json list = Json::array();
  for (const auto& [code, visits] : people) {
    Json sessions = Json::array();
    bool simulated = false, known = false;
    for (const TaskSession* one : visits) {
      simulated = simulated || !one->observer.empty();
      known = known || (earlier != nullptr && earlier->contains(one->uid));
      sessions.push_back({{"uid", one->uid}, {"visit", one->visit}, {"state", one->state}});
    }
    Json person{{"participant", code},
                {"analysed", std::count(data.participants.begin(), data.participants.end(), code) > 0},
                {"simulated", simulated},
                {"sessions", sessions}};
    if (earlier != nullptr) person["new"] = !known;
    list.push_back(std::move(person));
  }
  return list;
}

}  // namespace study
