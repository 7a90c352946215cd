/// Distinct codes for the people of several stations.
#include <algorithm>
#include <set>
#include <tuple>

#include "libstudy/store/merge/merge_parts.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace study::merging {

namespace {

constexpr std::size_t longest_code = 32;
constexpr std::size_t digits = 4;

struct Person {
  std::string uid, code, station;
};

/// All people including withdrawn ones, each with the station of the first session.
std::vector<Person> people_of(const Content& content) {
  std::map<std::string, Person> people;
  std::map<std::string, std::pair<std::string, std::string>> first;  // planned, session
  for (const SessionCopy& copy : content.copies) {
    const std::pair key{copy.planned_utc, copy.uid};
    const auto [known, fresh] = first.try_emplace(copy.person, key);
    if (!fresh && known->second <= key) continue;
    known->second = key;
    people[copy.person] = {copy.person, copy.code, copy.station};
  }
  for (const auto& [uid, stone] : content.tombstones) people[uid] = {uid, stone.code, stone.station};
  std::vector<Person> out;
  for (auto& [uid, person] : people) out.push_back(std::move(person));
  return out;
}

std::string as_code(std::string text) {
  for (char& c : text) {
    const bool allowed =
        (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
    if (!allowed) c = '-';
  }
  return text;
}

std::string with_digits(const Person& person) {
  return person.code.substr(0, longest_code - digits - 1) + '-' +
         base::sha256_hex(person.uid).substr(0, digits);
}

/// "<code>-<station>", or with digits if there is no station or no room.
std::string with_station(const Person& person) {
  const std::string name = person.code + '-' + as_code(person.station);
  return person.station.empty() || name.size() > longest_code ? with_digits(person) : name;
}

}  // namespace

std::map<std::string, std::string> name_people(const Content& content) {
  const auto people = people_of(content);
  std::map<std::string, int> given, taken;
  for (const Person& person : people) ++given[person.code];
  const auto wished = [&](const Person& person) {
    return given[person.code] == 1 ? person.code : with_station(person);
  };
  for (const Person& person : people) ++taken[wished(person)];
  std::map<std::string, std::string> names;
  std::set<std::string> distinct;
  for (const Person& person : people) {
    const bool alone = given[person.code] == 1 || taken[wished(person)] == 1;
    const std::string name = alone ? wished(person) : with_digits(person);
    if (!distinct.insert(name).second) {
      throw base::Error("participant code " + person.code, "cannot be made distinct from another",
                        "merge fewer databases at a time");
    }
    names[person.uid] = name;
  }
  return names;
}

}  // namespace study::merging
