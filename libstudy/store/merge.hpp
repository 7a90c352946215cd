#pragma once
/// Joins the databases of several stations into one.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "libstudy/store/balance.hpp"
#include "libstudy/store/withdraw.hpp"

namespace study {

/// What a merge came to.
struct Merge {
  std::int64_t sessions = 0;       ///< that the result holds
  std::int64_t recognised = 0;     ///< copies of a session that stands there already, not counted twice
  std::int64_t test_sessions = 0;  ///< among `sessions`: marked as test data, and kept so
  /// Codes that stood for several people: "P07 of station north is P07-north".
  std::vector<std::string> renamed;
  /// Codes of all who withdrew; no data of theirs were taken over.
  std::vector<std::string> withdrawn;
  /// What the tombstones deleted from `into` itself, by code.
  std::vector<std::pair<std::string, Stock>> buried;
  CleanUp beside;  ///< backups, personal data and exports of `into`
  /// Datasets that go by one name and version with different texts; they stay apart.
  std::vector<std::string> namesakes;
  std::vector<Balance> balance;               ///< of the result, by protocol
  std::vector<std::string> station_troubles;  ///< why it may be off: sentences without a full stop
};

/// Joins `sources` and what `into` holds already, in `into`.
///
/// Equal protocol hash = one dataset. A session that stands in several of them counts once, as its furthest
/// copy; base::Error when two copies went on differently. A code given to several people becomes
/// "<code>-<station>" for each of them, or "<code>-<four hexadecimal digits>" where that is not distinct. Who
/// withdrew in one of them is deleted from all, also from backups and personal data beside `into` and from
/// every registered export. The result depends on what is joined, not on the order; merged again, nothing
/// changes. Sources stay as they are, `into` changes in one transaction or not at all; what is to follow
/// beside it is written down in that transaction (chores.hpp), so that a kill leaves nothing forgotten.
/// Personal data stay at their stations. base::Error, with nothing changed: a source with rows that belong to
/// nothing, or with rows of one session that point into another; one that lacks what its journal holds,
/// unless `incomplete`.
Merge merge(const std::vector<std::filesystem::path>& sources, const std::filesystem::path& into,
            bool incomplete = false);

}  // namespace study
