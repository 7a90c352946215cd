#pragma once
/// Parts of merge(): reads the sources, matches people and copies rows.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/design/station.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study::merging {

/// One session in one source.
struct SessionCopy {
  std::size_t source = 0;
  std::int64_t id = 0;  ///< row number in the source
  std::string uid, person, code, station, run_uid, planned_utc, protocol_sha256;
  int visit = 1;
  bool test_data = false;
  std::int64_t events = 0, frames = 0, played = 0;  ///< measures of how far it went
  std::int64_t gaze = 0;                            ///< samples, poses of the head and validations
  std::optional<StationNumber> station_number;
  bool counts = false;  ///< counts for the balance: Store::taken_slots()
};

struct Tombstone {
  std::string person, code, station, withdrawn_utc;
};

/// Sessions and tombstones of all sources.
struct Content {
  std::vector<std::unique_ptr<sqlite::Connection>> sources;
  std::vector<SessionCopy> copies;
  std::map<std::string, Tombstone> tombstones;  ///< by person; the earliest one of each person
};

/// Reads sessions and tombstones of a source and adds them. base::Error if one of its rows has no parent.
void add_source(Content& content, std::unique_ptr<sqlite::Connection> source);

/// The furthest copy of each session whose person did not withdraw, in the order of planning. base::Error if
/// two copies of a session diverged.
std::vector<SessionCopy> choose_sessions(Content& content);

/// Code by person, distinct for all people of `content`. It depends only on them.
std::map<std::string, std::string> name_people(const Content& content);

/// Reasons why the stations did not share the assignment: two sources used one station number or none, or
/// were told different numbers of stations. One sentence each, without a full stop.
std::vector<std::string> station_troubles(const Content& content);

/// Writes the union into an empty database of the newest schema.
void write_union(Content& content, const std::vector<SessionCopy>& chosen,
                 const std::map<std::string, std::string>& names, sqlite::Connection& target);

/// Adds the registered exports of a source and their people; for equal paths, the latest one counts.
void add_exports(sqlite::Connection& source, sqlite::Connection& target);

}  // namespace study::merging
