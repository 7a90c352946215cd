#include "libstudy/store/central/libpq.hpp"

#include <dlfcn.h>

#include <string>
#include <type_traits>

#include "stats/base/error.hpp"

namespace study::pg {

namespace {

constexpr const char* file_of_libpq = "libpq.so.5";

Libpq load_libpq() {
  void* const library = ::dlopen(file_of_libpq, RTLD_NOW | RTLD_LOCAL);
  if (!library) {
    throw base::Error(
        "central database",
        std::string("there is no ") + file_of_libpq + " on this machine, or it cannot be loaded",
        "install libpq5");
  }
  Libpq all;
  const auto find = [&](const char* name, auto& function) {
    function = reinterpret_cast<std::remove_reference_t<decltype(function)>>(::dlsym(library, name));
    if (!function) {
      throw base::Error("central database", std::string(file_of_libpq) + " has no " + name,
                        "install libpq5 of PostgreSQL 9.3 or newer");
    }
  };
  find("PQcancel", all.cancel);
  find("PQclear", all.clear);
  find("PQcmdTuples", all.cmd_tuples);
  find("PQconnectPoll", all.connect_poll);
  find("PQconnectStartParams", all.connect_start_params);
  find("PQconninfo", all.conninfo);
  find("PQconninfoFree", all.conninfo_free);
  find("PQerrorMessage", all.error_message);
  find("PQexec", all.exec);
  find("PQexecParams", all.exec_params);
  find("PQfinish", all.finish);
  find("PQfreeCancel", all.free_cancel);
  find("PQfreemem", all.freemem);
  find("PQgetCancel", all.get_cancel);
  find("PQgetCopyData", all.get_copy_data);
  find("PQgetResult", all.get_result);
  find("PQgetisnull", all.getisnull);
  find("PQgetlength", all.getlength);
  find("PQgetvalue", all.getvalue);
  find("PQnfields", all.nfields);
  find("PQntuples", all.ntuples);
  find("PQresultErrorField", all.result_error_field);
  find("PQresultErrorMessage", all.result_error_message);
  find("PQresultStatus", all.result_status);
  find("PQsetNoticeProcessor", all.set_notice_processor);
  find("PQsocket", all.socket);
  find("PQstatus", all.status);
  return all;
}

}  // namespace

const Libpq& libpq() {
  static const Libpq library = load_libpq();
  return library;
}

}  // namespace study::pg
