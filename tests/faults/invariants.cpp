#include "tests/faults/invariants.hpp"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdlib>
#include <cstring>

#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/faults/child.hpp"

namespace faults {

namespace {

std::string bytes_of(const fs::path& path) { return base::read_file(path, 1u << 30); }

void empty_folder(const fs::path& folder) {
  fs::remove_all(folder);
  fs::create_directories(folder);
}

std::string shortest(double number) {
  std::array<char, 32> text{};
  return {text.data(), std::to_chars(text.data(), text.data() + text.size(), number).ptr};
}

/// The eight bytes, most significant first, as which SQLite stores the number.
std::string stored(double number) {
  std::uint64_t bits = 0;
  std::memcpy(&bits, &number, sizeof bits);
  std::string bytes;
  for (int shift = 56; shift >= 0; shift -= 8) bytes += static_cast<char>(bits >> shift & 0xff);
  return bytes;
}

constexpr int personal_page = 1;  // position of a session's page with the personal question (small_study.cpp)

std::string personal_answer(const std::string& key) {
  const std::size_t at = key.find('@');
  return "town " + Person{key.substr(0, at), key.substr(at + 1)}.mark();
}

bool holds(const std::string& bytes, const std::string& text) {
  return bytes.find(text) != std::string::npos;
}

std::string inflated(const fs::path& path) {
  std::string all, part(1 << 16, '\0');
  gzFile file = ::gzopen(path.c_str(), "rb");
  for (int n; (n = ::gzread(file, part.data(), static_cast<unsigned>(part.size()))) > 0;)
    all.append(part, 0, static_cast<std::size_t>(n));
  ::gzclose(file);
  return all;
}

/// True for "sub-P01" or "subject-P01", but not sub-P012.
bool names_subject(const std::string& text, const std::string& participant) {
  std::string label;
  std::copy_if(participant.begin(), participant.end(), std::back_inserter(label),
               [](unsigned char c) { return std::isalnum(c) != 0; });
  for (const std::string& start : {"sub-" + label, "subject-" + label}) {
    for (std::size_t at = text.find(start); at != std::string::npos; at = text.find(start, at + 1)) {
      const std::size_t end = at + start.size();
      if (end == text.size() || !std::isalnum(static_cast<unsigned char>(text[end]))) return true;
    }
  }
  return false;
}

/// The responses in a journal as "response_id score words". Of several lines about one response the last
/// counts.
std::set<std::string> journal_responses(const std::string& bytes) {
  std::map<std::int64_t, std::string> last;
  for (std::size_t at = 0, end; (end = bytes.find('\n', at)) != std::string::npos; at = end + 1) {
    const auto line = base::parse_json(bytes.substr(at, end - at));
    if (!line.is_object() || line.value("table", "") != "response") continue;
    const auto text = [&](const char* name) {
      const auto& value = line.at(name);
      return value.is_null() ? std::string() : value.is_string() ? value.get<std::string>() : value.dump();
    };
    last[line.at("response_id").get<std::int64_t>()] =
        text("response_id") + " " + text("score") + " " + text("words");
  }
  std::set<std::string> all;
  for (const auto& [id, row] : last) all.insert(row);
  return all;
}

}  // namespace

Problems check_refused(const DatabaseFacts& facts) {
  Problems problems;
  for (const auto& [key, one] : facts.sessions)
    if (one.gaze == false && one.gaze_rows > 0)
      problems.push_back("refused: " + key + " refused gaze, and " + std::to_string(one.gaze_rows) +
                         " rows of it are there");
  return problems;
}

Problems check_exports(const DatabaseFacts& facts, const fs::path& station, const fs::path& peek,
                       const std::vector<Person>& gone) {
  empty_folder(peek);
  const fs::path copy = peek / "station", database = copy / "s.db", out = peek / "out";
  fs::copy(station, copy, fs::copy_options::recursive);
  static CallLog log;
  CallPlan plan;
  plan.log = &log;
  const Ended ended = run_child(plan, [&] {
    ::setenv("VIP_STATE_DIR", (peek / "state").c_str(), 1);
    study::export_csv(database, out / "csv", {true, true});
    study::export_bids(database, out / "bids", true);
    study::export_psych_ds(database, out / "psych");
  });
  std::set<std::string> problems;
  if (ended.how == Ended::How::Broken) problems.insert("exports: " + ended.problem);
  if (!fs::exists(out)) return {problems.begin(), problems.end()};
  for (const auto& entry : fs::recursive_directory_iterator(out)) {
    const std::string name = entry.path().lexically_relative(out).string();
    const std::string place = "the export " + name.substr(0, name.find('/'));
    const bool is_file = entry.is_regular_file(), is_public = !name.starts_with("csv");
    const std::string text = name + "\n" +
                             (!is_file                ? ""
                              : name.ends_with(".gz") ? inflated(entry.path())
                                                      : bytes_of(entry.path()));
    for (const auto& [key, one] : facts.sessions) {
      const Person person{one.code, one.station};
      if (one.gaze == false && holds(text, shortest(person.place())))
        problems.insert("refused: gaze of " + key + " is in " + place);
      if (one.sharing == false && is_public && names_subject(text, one.participant))
        problems.insert("refused: " + key + " refused sharing and is in " + place);
    }
    for (const Person& person : gone)
      if (holds(text, person.mark()) || holds(text, shortest(person.place())))
        problems.insert("tombstone: " + person.key() + " withdrew and is in " + place);
  }
  return {problems.begin(), problems.end()};
}

Problems check_withdrawn(const fs::path& station, const std::vector<Person>& gone) {
  std::set<std::string> problems;
  for (const auto& [name, bytes] : bytes_of_folder(station)) {
    for (const Person& person : gone)
      for (const std::string& trace : {person.mark(), stored(person.place()), shortest(person.place())})
        if (holds(bytes, trace))
          problems.insert("tombstone: " + person.key() + " withdrew and is in " +
                          name.substr(0, name.find('/')));
  }
  return {problems.begin(), problems.end()};
}

Problems check_acknowledged(const DatabaseFacts& facts, const fs::path& database,
                            const std::set<std::pair<std::string, int>>& acknowledged, bool settled) {
  Problems problems;
  const fs::path journal = database.string() + ".answers.jsonl";
  const auto written = journal_responses(fs::exists(journal) ? bytes_of(journal) : "");
  for (const Response& response : facts.responses)
    if ((settled || acknowledged.contains({response.key, response.position})) &&
        !written.contains(response.row))
      problems.push_back("acknowledged: the journal lacks an answer of " + response.key + ": " +
                         response.row);
  for (const auto& [key, position] : acknowledged) {
    if (facts.withdrawn.contains(key)) continue;
    const auto found = facts.sessions.find(key);
    const std::string unit = key + " " + std::to_string(position);
    if (found == facts.sessions.end() || !found->second.done.contains(position))
      problems.push_back("acknowledged: the database lacks " + unit);
    if (position == personal_page && !facts.personal.contains(personal_answer(key)))
      problems.push_back("acknowledged: the personal data lack those of " + key);
  }
  return problems;
}

std::map<std::string, std::string> bytes_of_folder(const fs::path& folder) {
  std::map<std::string, std::string> all;
  if (!fs::exists(folder)) return all;
  for (const auto& entry : fs::recursive_directory_iterator(folder))
    if (entry.is_regular_file() && !entry.path().string().ends_with("-shm"))
      all[entry.path().lexically_relative(folder).string()] = bytes_of(entry.path());
  return all;
}

Problems check_unchanged(const std::map<std::string, std::string>& before, const fs::path& folder) {
  Problems problems;
  auto after = bytes_of_folder(folder);
  for (const auto& [name, bytes] : before) {
    const auto found = after.find(name);
    // A file that was empty, such as SQLite's log (-wal), may disappear.
    if (found == after.end() ? !bytes.empty() : found->second != bytes)
      problems.push_back("unchanged: " + name + " was changed by a command that was refused");
    if (found != after.end()) after.erase(found);
  }
  for (const auto& [name, bytes] : after)
    if (!bytes.empty()) problems.push_back("unchanged: " + name + " was made by a command that was refused");
  return problems;
}

}  // namespace faults
