#pragma once
/// Parts of merge(): what stands in the sources, who is who, and how rows move.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/design/station.hpp"
#include "libstudy/store/sqlite.hpp"

namespace study::merging {

/// One session as it stands in one source.
struct SessionCopy {
  std::size_t source = 0;
  std::int64_t id = 0;  ///< row there
  std::string uid, person, code, station, run_uid, planned_utc, protocol_sha256;
  int visit = 1;
  bool test_data = false;
  std::int64_t events = 0, frames = 0, played = 0;  ///< how far it went
  std::int64_t gaze = 0;                            ///< samples, poses of the head and validations
  std::optional<StationNumber> station_number;
  bool counts = false;  ///< for the balance: Store::taken_slots()
};

struct Tombstone {
  std::string person, code, station, withdrawn_utc;
};

/// Everything that is joined, read from all sources.
struct Content {
  std::vector<std::unique_ptr<sqlite::Connection>> sources;
  std::vector<SessionCopy> copies;
  std::map<std::string, Tombstone> tombstones;  ///< by person; the earliest of each
};

/// Reads sessions and tombstones of a source and adds them. base::Error when one of its rows belongs to none.
void add_source(Content& content, std::unique_ptr<sqlite::Connection> source);

/// The furthest copy of each session that nobody withdrew from, in the order of planning. base::Error when
/// two copies of a session went on differently.
std::vector<SessionCopy> choose_sessions(Content& content);

/// Code by person, distinct for all people of `content`: a function of them alone.
std::map<std::string, std::string> name_people(const Content& content);

/// Why the stations did not share the assignment: two sources dealt under one number or without any, or were
/// told another number of stations. A sentence each, without a full stop.
std::vector<std::string> station_troubles(const Content& content);

/// Writes the union into an empty database of the newest schema.
void write_union(Content& content, const std::vector<SessionCopy>& chosen,
                 const std::map<std::string, std::string>& names, sqlite::Connection& target);

/// Adds the changes of permissions of a session in whatever copy, each once, to row `session` of the target.
/// What was known to be superseded in one copy is so in all; no clock decides.
void add_permissions(Content& content, const std::string& uid, sqlite::Connection& target,
                     std::int64_t session);

/// Gives the union its labels (export_labels.hpp): those of the source that stands at the target's path stay,
/// then those of the others by when somebody was first planned.
void add_labels(const Content& content, sqlite::Connection& target);

/// Adds the registered exports of a source and whom they hold; of one path, what was written last counts.
void add_exports(sqlite::Connection& source, sqlite::Connection& target);

}  // namespace study::merging
