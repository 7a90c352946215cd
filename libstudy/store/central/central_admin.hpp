#pragma once
/// Makes and upgrades the central database, and lets roles in. For its owner.

#include <cstdint>
#include <string>
#include <vector>

namespace study::central {

/// Makes the schemas vip, lab and shared in the empty database of a service, and the three group roles of the
/// database. base::Error, with nothing changed, if the role does not own the database, the schemas are there,
/// or the role may not create roles; the error then has the statements for the administrator.
void init(const std::string& service);

/// The change of an upgrade.
struct Upgrade {
  std::int64_t before = 0, now = 0;  ///< schema numbers
  std::vector<std::string> added;    ///< tables and columns
};
/// Upgrades the central database to this program's schema: adds tables and columns, and makes everything else
/// again. base::Error, with nothing changed, if the database is newer than the program, or if a step did what
/// this cannot express: a column that was removed, has another type or may not be empty, or another key.
Upgrade upgrade(const std::string& service);

/// What a role may do.
enum class Admission {
  Station,      ///< push its own rows
  LabReader,    ///< read everything except people who withdrew and gaze that is refused
  SharedReader  ///< of that, what people agree to share
};
/// Admits an existing login role. base::Error if the role is missing, could go round the rules (a superuser,
/// the owner, one that may create roles), or already is admitted otherwise.
void admit(const std::string& service, const std::string& role, Admission admission);

}  // namespace study::central
