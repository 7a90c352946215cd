#pragma once
/// Reads a study from a central database (PostgreSQL): the rows that the role of the service may read, of all
/// stations, joined as vip-study merge joins the stations' files.

#include <functional>
#include <memory>
#include <string>

#include "libstudy/store/file/sqlite.hpp"

namespace study {

/// The study of the central database of `service`, a section of libpq's service file, in a temporary database
/// whose errors name "service:<service>". Reads one state of the central database, through the views of the
/// schema `lab`, or those of `shared` if the role may not read `lab`. Makes a temporary database for each
/// station, then chooses sessions and codes as merge() does: the result does not depend on the order in which
/// stations pushed. Gives labels for exports.
///
/// base::Error if the central database cannot be reached, if its schema is another, if the role may read
/// neither schema, or as merge().
std::unique_ptr<sqlite::Connection> read_central_study(const std::string& service);

/// Lets open_study() read central databases (read_central_with()). After each reading deletes the exports of
/// people who withdrew (delete_exports_of_service()). tell: gets a line for each export that was deleted or
/// has to be.
void read_central_studies(std::function<void(const std::string& line)> tell);

}  // namespace study
