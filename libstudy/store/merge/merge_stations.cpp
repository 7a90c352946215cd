/// Checks that the stations of a merge dealt disjoint shares of one assignment.
#include <algorithm>
#include <set>

#include "libstudy/store/merge/merge_parts.hpp"

namespace study::merging {

namespace {

/// Sessions that one source planned under one protocol and station number.
struct Dealt {
  std::size_t source = 0;
  std::optional<StationNumber> number;
  std::set<std::string> sessions;  ///< uids
};

std::vector<Dealt> dealt_by_sources(const Content& content, const std::string& protocol) {
  std::vector<Dealt> all;
  for (const SessionCopy& copy : content.copies) {
    if (!copy.counts || copy.protocol_sha256 != protocol || content.tombstones.contains(copy.person))
      continue;
    const auto same = [&](const Dealt& one) {
      return one.source == copy.source && one.number == copy.station_number;
    };
    auto found = std::find_if(all.begin(), all.end(), same);
    if (found == all.end()) found = all.insert(all.end(), Dealt{copy.source, copy.station_number, {}});
    found->sessions.insert(copy.uid);
  }
  return all;
}

/// True if each has a session that the other lacks, so that neither is an earlier copy of the other.
bool went_apart(const Dealt& a, const Dealt& b) {
  const auto holds = [](const Dealt& one, const Dealt& other) {
    return std::includes(one.sessions.begin(), one.sessions.end(), other.sessions.begin(),
                         other.sessions.end());
  };
  return !holds(a, b) && !holds(b, a);
}

std::string files_of(const Content& content, const Dealt& a, const Dealt& b) {
  const auto file = [&](const Dealt& one) { return content.sources[one.source]->path().string(); };
  return a.source == b.source ? file(a) : file(a) + " and " + file(b);
}

/// The problem of two shares; empty: none.
std::string trouble_of(const Content& content, const Dealt& a, const Dealt& b) {
  const std::string files = files_of(content, a, b);
  if (a.source != b.source && a.number == b.number && went_apart(a, b))
    return files +
           (a.number ? " were both recorded as station " + station_text(*a.number)
                     : " have sessions without a station number") +
           ": they used the same slots of the assignment";
  if (a.number && b.number && a.number->count != b.number->count)
    return files + ": sessions were recorded as stations " + station_text(*a.number) + " and " +
           station_text(*b.number) + ", whose shares overlap";
  if (a.number.has_value() != b.number.has_value())
    return files + ": some sessions were recorded as station " +
           station_text(a.number ? *a.number : *b.number) +
           ", others without a station number: their shares overlap";
  return {};
}

}  // namespace

std::vector<std::string> station_troubles(const Content& content) {
  std::set<std::string> protocols, troubles;
  for (const SessionCopy& copy : content.copies) protocols.insert(copy.protocol_sha256);
  for (const std::string& protocol : protocols) {
    const auto all = dealt_by_sources(content, protocol);
    for (std::size_t i = 0; i < all.size(); ++i) {
      for (std::size_t j = i + 1; j < all.size(); ++j) {
        if (const auto trouble = trouble_of(content, all[i], all[j]); !trouble.empty())
          troubles.insert(trouble);
      }
    }
  }
  return {troubles.begin(), troubles.end()};
}

}  // namespace study::merging
