#include "libstudy/store/import/read_import.hpp"

#include <algorithm>
#include <map>
#include <set>
#include <utility>

#include "libstudy/store/import/table_reader.hpp"
#include "stats/base/error.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

/// True if `name` is `pattern`, in which each "*" stands for any characters.
bool is_named(std::string_view name, std::string_view pattern) {
  if (pattern.empty()) return name.empty();
  if (pattern.front() == '*')
    return is_named(name, pattern.substr(1)) || (!name.empty() && is_named(name.substr(1), pattern));
  return !name.empty() && name.front() == pattern.front() && is_named(name.substr(1), pattern.substr(1));
}

const Block& block_of(const Protocol& protocol) {
  const Block* found = nullptr;
  for (const Block& block : protocol.blocks) {
    if (block.kind != BlockKind::Stimulus) continue;
    if (found)
      throw base::Error("protocol " + protocol.name, "has several stimulus blocks, and import reads one",
                        "describe the study by a protocol with one block of kind stimulus");
    found = &block;
  }
  if (!found)
    throw base::Error("protocol " + protocol.name, "has no stimulus block",
                      "give a protocol that shows stimuli");
  return *found;
}

/// Refuses a mapping with another number of stimuli in a trial than the protocol.
void check_stimuli(const Protocol& protocol, const ImportMapping& mapping) {
  const bool pairs = protocol.design.pairs;
  if (pairs == mapping.pairs()) return;
  throw base::Error("protocol " + protocol.name,
                    pairs ? "shows pairs, and the mapping names the columns of one stimulus"
                          : "shows one stimulus in a trial, and the mapping names the columns of two",
                    pairs
                        ? "name the columns of both under [columns.first] and [columns.second] of the mapping"
                        : "name the columns under [columns] of the mapping, without [columns.first] and "
                          "[columns.second]");
}

/// The scored questions that the block's trials ask.
std::vector<const Question*> asked_in(const Protocol& protocol, const Block& block) {
  std::set<std::string> asked;
  for (const TrialStep& step : block.steps) asked.insert(step.asks.begin(), step.asks.end());
  std::vector<const Question*> out;
  for (const auto& [index, question] : all_questions(protocol))
    if (asked.erase(question->id) > 0 && traits_of(question->kind).scored && !question->personal)
      out.push_back(question);
  return out;
}

/// Refuses a mapping whose answers do not fit the questions of the protocol's trials.
void check_answers_of(const ImportMapping& mapping, const std::vector<const Question*>& asked) {
  std::vector<std::string> known;
  for (const Question* question : asked) known.push_back(question->id);
  const auto has = [](const std::vector<std::string>& list, const std::string& one) {
    return std::find(list.begin(), list.end(), one) != list.end();
  };
  std::vector<std::string> mapped = mapping.not_asked;
  for (const AnswerColumn& one : mapping.answers) mapped.push_back(one.question);
  for (const std::string& id : mapped)
    if (!has(known, id))
      throw base::Error("question '" + base::shortened(id) + "' of the mapping",
                        "is no question with scores of the protocol's trials", base::use_one_of(id, known));
  for (const std::string& id : known)
    if (!has(mapped, id))
      throw base::Error(
          "question '" + id + "' of the protocol", "has no [[answer]] in the mapping",
          "add [[answer]] with question = \"" + id + "\" and its column, or list it under not_asked");
}

/// Refuses a pair of cells that the protocol does not show together. `cells`: ascending.
void check_pair(const Design& design, const std::vector<std::vector<int>>& groups, const PlacedTrial& trial,
                const std::vector<int>& cells) {
  if (cells.size() < 2) return;
  for (const auto& group : groups)
    for (const auto& [one, other] : pairs_of_group(design, group))
      if (std::minmax(one, other) == std::pair<const int&, const int&>(cells[0], cells[1])) return;
  throw base::Error(trial.place,
                    "shows cells " + std::to_string(cells[0]) + " and " + std::to_string(cells[1]) +
                        " in one trial, which the protocol does not pair",
                    "correct the row, or give the protocol that the study followed; vip-study check lists "
                    "its settings");
}

/// Refuses more trials of a cell or a pair than a session of the protocol shows, and more groups of cells.
void check_trials(const Protocol& protocol, const ImportMapping& mapping, Visit& visit) {
  const Design& design = protocol.design;
  const auto groups = cell_groups(design);
  std::map<std::vector<int>, int> shown;  // number of trials of a cell, or of a pair in either order
  std::set<int> cells;
  for (const auto& [order, trial] : visit.trials) {
    auto what = trial.trial.cells();
    std::sort(what.begin(), what.end());
    cells.insert(what.begin(), what.end());
    check_pair(design, groups, trial, what);
    const int times = ++shown[what];
    if (!design.procedure && times > design.repetitions)
      throw base::Error(
          trial.place,
          "shows cell" +
              (what.size() > 1 ? "s " + std::to_string(what[0]) + " and " + std::to_string(what[1])
                               : " " + std::to_string(what[0])) +
              " to " + visit.session.participant + " more often than protocol " + protocol.name + " (" +
              std::to_string(design.repetitions) + "), in visit " + std::to_string(visit.session.visit),
          "leave practice and repeated trials out by a [[row]], name the column of the visit, or "
          "give a protocol of format 3 with more repetitions");
  }
  int met = 0;
  for (const auto& group : groups)
    met += std::any_of(group.begin(), group.end(), [&](int cell) { return cells.contains(cell); });
  const auto wanted = static_cast<std::size_t>(trials_of_group(design) * design.groups);
  if (met > design.groups)
    throw base::Error(visit.file.string(),
                      "shows " + visit.session.participant + " cells of " + std::to_string(met) +
                          " groups, and protocol " + protocol.name + " shows a person " +
                          std::to_string(design.groups),
                      "give the protocol that the study followed");
  visit.session.complete = visit.trials.size() == wanted;
  if (visit.trials.size() > wanted)
    throw base::Error(visit.file.string(),
                      "has " + std::to_string(visit.trials.size()) + " trials of " +
                          visit.session.participant + ", and protocol " + protocol.name + " has " +
                          std::to_string(wanted),
                      "give the protocol that the study followed");
  if (!visit.session.complete && mapping.incomplete.empty())
    throw base::Error(visit.file.string(),
                      "has " + std::to_string(visit.trials.size()) + " of the " + std::to_string(wanted) +
                          " trials of " + visit.session.participant + ", visit " +
                          std::to_string(visit.session.visit),
                      "write incomplete = \"stopped\" or \"dropped out\" in the mapping, which says how such "
                      "sessions ended, or leave the person's rows out");
}

}  // namespace

std::vector<fs::path> find_sources(const std::vector<fs::path>& named, const ImportMapping& mapping) {
  std::vector<fs::path> out;
  for (const fs::path& one : named) {
    if (!fs::is_directory(one)) {
      if (!fs::exists(one)) throw base::Error(one.string(), "does not exist", "give the path of a table");
      out.push_back(one);
      continue;
    }
    if (mapping.files.empty())
      throw base::Error(one.string(), "is a folder, and the mapping does not name the tables in it",
                        "write files = \"NAME.csv\" in the mapping, or name the tables themselves");
    const auto wanted = [&](const std::string& name) {
      return std::any_of(mapping.files.begin(), mapping.files.end(),
                         [&](const std::string& pattern) { return is_named(name, pattern); });
    };
    std::vector<fs::path> found;
    for (const auto& entry : fs::recursive_directory_iterator(one))
      if (entry.is_regular_file() && wanted(entry.path().filename().string())) found.push_back(entry.path());
    if (found.empty())
      throw base::Error(one.string(), "holds no file " + base::shortened(base::joined(mapping.files)),
                        "correct `files` in the mapping, or name the tables themselves");
    std::sort(found.begin(), found.end());
    out.insert(out.end(), found.begin(), found.end());
  }
  return out;
}

ReadImport read_import(const Protocol& protocol, const ImportMapping& mapping,
                       const std::vector<fs::path>& files) {
  const auto asked = asked_in(protocol, block_of(protocol));
  check_stimuli(protocol, mapping);
  check_answers_of(mapping, asked);
  ReadImport out;
  Visits visits;
  std::map<std::string, fs::path> known;
  for (const fs::path& file : files) {
    const SourceTable table(file);
    const auto [same, fresh] = known.try_emplace(table.sha256(), file);
    if (!fresh)
      throw base::Error(file.string(), "holds the same bytes as " + same->second.string(),
                        "give each table once");
    out.sources.push_back(TableReader(protocol, mapping, asked, table, visits).read());
  }
  std::string person, first;
  std::map<std::string, std::string> logs;  // places of the trials, by the hash of their frame log
  for (auto& [key, visit] : visits) {
    for (const auto& [order, trial] : visit.trials) {
      for (const ImportedShowing& showing : trial.trial.showings) {
        if (!showing.frames) continue;
        const auto [same, fresh] = logs.try_emplace(showing.frames_sha256, trial.place);
        if (!fresh)
          throw base::Error(trial.place, "has the same frame log as " + same->second,
                            "name the log of each stimulus: write {COLUMN} in [frames] for what differs");
      }
    }
    check_trials(protocol, mapping, visit);
    if (key.first != person) first = visit.session.source_sha256;
    person = key.first;
    visit.session.first_source_sha256 = first;
    for (auto& [order, trial] : visit.trials) visit.session.trials.push_back(std::move(trial.trial));
    out.sessions.push_back(std::move(visit.session));
  }
  return out;
}

}  // namespace study
