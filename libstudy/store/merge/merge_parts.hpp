#pragma once
/// The steps of merge(): reads the sources, chooses sessions, gives people codes, and copies rows.

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "libstudy/design/station.hpp"
#include "libstudy/store/file/sqlite.hpp"

namespace study::merging {

/// The copy of a session in one source.
struct SessionCopy {
  std::size_t source = 0;
  std::int64_t id = 0;  ///< row number in the source
  std::string uid, person, code, station, run_uid, planned_utc, protocol_sha256;
  int visit = 1;
  bool test_data = false;
  std::int64_t events = 0, frames = 0, played = 0;  ///< row counts: its progress; played: presentations
  std::int64_t gaze = 0;                            ///< number of gaze samples, head poses and validations
  std::optional<StationNumber> station_number;
  bool counts = false;    ///< true: the session counts as a use of its slot (Store::taken_slots())
  bool reserved = false;  ///< true: a central database dealt its slot (ReservedSlot)
};

struct Tombstone {
  std::string person, code, station, withdrawn_utc;
};

/// Sessions and tombstones of all sources.
struct Content {
  std::vector<std::unique_ptr<sqlite::Connection>> sources;
  std::vector<SessionCopy> copies;
  std::map<std::string, Tombstone> tombstones;  ///< the earliest tombstone of each person, by person
};

/// Adds the sessions and tombstones of a source to `content`. base::Error if the source has a row whose
/// parent row is missing.
void add_source(Content& content, std::unique_ptr<sqlite::Connection> source);

/// The copy with the most progress of each session whose person did not withdraw, in the order of planning.
/// base::Error if two copies of a session diverged (apart from permission changes, neither log of events
/// begins with the other), or if a person has two sessions with the same protocol and visit number.
std::vector<SessionCopy> choose_sessions(Content& content);

/// The code of each person after the merge, by person; all codes are distinct. The codes do not depend on the
/// order of the sources. base::Error if a code cannot be made distinct.
std::map<std::string, std::string> name_people(const Content& content);

/// Reasons why stations may have assigned the same slots (positions in the counterbalancing, of which each
/// station must use its own share): two sources with the same station number (or both without one) each have
/// a session that the other lacks; sessions were recorded with different numbers of stations; or only some
/// sessions have a station number. Leaves out sessions whose slot a central database dealt. Each reason is a
/// sentence without a full stop.
std::vector<std::string> station_troubles(const Content& content);

/// Writes the chosen sessions, with the people's new codes `names`, into `target`, an empty database of the
/// newest schema.
void write_union(Content& content, const std::vector<SessionCopy>& chosen,
                 const std::map<std::string, std::string>& names, sqlite::Connection& target);

/// Adds the registered exports of a source, with their people, to `target`. If both list an export with the
/// same computer and path, the later entry is used, with the people of both entries.
void add_exports(sqlite::Connection& source, sqlite::Connection& target);

}  // namespace study::merging
