#pragma once
/// libpq, opened when a program first connects to a central database. Linking it would load some thirty
/// further libraries at every start, which took half of a program's start-up time.

#include <libpq-fe.h>

namespace study::pg {

/// The functions of libpq that the wrappers call, named after them: status is PQstatus.
struct Libpq {
  decltype(&PQcancel) cancel;
  decltype(&PQclear) clear;
  decltype(&PQcmdTuples) cmd_tuples;
  decltype(&PQconnectPoll) connect_poll;
  decltype(&PQconnectStartParams) connect_start_params;
  decltype(&PQconninfo) conninfo;
  decltype(&PQconninfoFree) conninfo_free;
  decltype(&PQerrorMessage) error_message;
  decltype(&PQexec) exec;
  decltype(&PQexecParams) exec_params;
  decltype(&PQfinish) finish;
  decltype(&PQfreeCancel) free_cancel;
  decltype(&PQfreemem) freemem;
  decltype(&PQgetCancel) get_cancel;
  decltype(&PQgetCopyData) get_copy_data;
  decltype(&PQgetResult) get_result;
  decltype(&PQgetisnull) getisnull;
  decltype(&PQgetlength) getlength;
  decltype(&PQgetvalue) getvalue;
  decltype(&PQnfields) nfields;
  decltype(&PQntuples) ntuples;
  decltype(&PQresultErrorField) result_error_field;
  decltype(&PQresultErrorMessage) result_error_message;
  decltype(&PQresultStatus) result_status;
  decltype(&PQsetNoticeProcessor) set_notice_processor;
  decltype(&PQsocket) socket;
  decltype(&PQstatus) status;
};

/// Opens the library at the first call; it stays open. base::Error if it is missing or too old.
const Libpq& libpq();

}  // namespace study::pg
