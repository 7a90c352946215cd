#include "libstudy/store/central/postgres.hpp"

#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "libstudy/store/central/libpq.hpp"
#include "stats/base/text.hpp"

namespace study::pg {

namespace {

using std::chrono::steady_clock;

constexpr int usual_connect_timeout_s = 10;
// A cut network is noticed after about this long, both while waiting for an answer and while sending.
constexpr unsigned usual_silence_ms = 30000;
constexpr std::size_t longest_message = 400;

/// A message of libpq as one line.
std::string one_line(const std::string& message) {
  std::string out;
  for (const char c : message) {
    if (c != '\n' && c != '\t')
      out += c;
    else if (!out.ends_with("; "))
      out += "; ";
  }
  while (out.ends_with("; ")) out.resize(out.size() - 2);
  return base::shortened(out, longest_message);
}

/// The option of an open connection, from service file or environment; empty: not set.
std::string option_of(PGconn* handle, const char* keyword) {
  const std::unique_ptr<PQconninfoOption, void (*)(PQconninfoOption*)> options(libpq().conninfo(handle),
                                                                               libpq().conninfo_free);
  for (const PQconninfoOption* one = options.get(); one && one->keyword; ++one) {
    if (std::string(one->keyword) == keyword) return one->val ? one->val : "";
  }
  return {};
}

int connect_timeout_of(PGconn* handle) {
  const int seconds = std::atoi(option_of(handle, "connect_timeout").c_str());
  return seconds > 0 ? seconds : usual_connect_timeout_s;
}

/// Waits for the connection's socket. False once the deadline has passed.
bool wait_for_socket(PGconn* handle, short events, steady_clock::time_point deadline) {
  const auto left = std::chrono::ceil<std::chrono::milliseconds>(deadline - steady_clock::now()).count();
  if (left <= 0) return false;
  pollfd socket{libpq().socket(handle), events, 0};
  ::poll(&socket, 1, static_cast<int>(left));
  return true;
}

/// Completes a connection that was begun. False if the time is up.
bool complete_connection(PGconn* handle) {
  const auto deadline = steady_clock::now() + std::chrono::seconds(connect_timeout_of(handle));
  auto step = PGRES_POLLING_WRITING;
  while (step != PGRES_POLLING_OK && step != PGRES_POLLING_FAILED) {
    if (!wait_for_socket(handle, step == PGRES_POLLING_READING ? POLLIN : POLLOUT, deadline)) return false;
    step = libpq().connect_poll(handle);
  }
  return true;
}

/// Lets a cut network end a wait, unless service or environment set their own times.
void notice_cut_networks(PGconn* handle) {
  sockaddr_storage address{};
  socklen_t length = sizeof address;
  const int socket = libpq().socket(handle);
  if (::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length) != 0) return;
  if (address.ss_family != AF_INET && address.ss_family != AF_INET6) return;
  const auto set = [&](int option, unsigned value) {
    ::setsockopt(socket, IPPROTO_TCP, option, &value, sizeof value);
  };
  if (option_of(handle, "tcp_user_timeout").empty()) set(TCP_USER_TIMEOUT, usual_silence_ms);
  if (option_of(handle, "keepalives_idle").empty()) {
    set(TCP_KEEPIDLE, 15);
    set(TCP_KEEPINTVL, 5);
    set(TCP_KEEPCNT, 3);
  }
}

std::string field(const PGresult* result, int code) {
  const char* text = libpq().result_error_field(result, code);
  return text ? text : "";
}

/// What the user can do about a failure, by the first two characters of its sqlstate.
std::string mend_of(const std::string& sqlstate, bool lost) {
  const std::string kind = sqlstate.substr(0, 2);
  if (sqlstate == "42501") return "connect as a role with that right: docs/central.md lists the roles";
  if (kind == "28") return "check user and password file of the service";
  if (sqlstate == "42P01" || sqlstate == "3F000")
    return "make the central database once, as its owner: vip-study central init --service NAME";
  if (kind == "22" || kind == "23") return "nothing of it was stored; find the row in the database";
  if (kind == "53") return "free disk or memory at the server, then give the command again";
  if (lost || kind == "08" || kind == "57" || kind == "40") return "give the command again";
  return "see the log of the server";
}

char unescaped(char c) {
  switch (c) {
    case 'b':
      return '\b';
    case 'f':
      return '\f';
    case 'n':
      return '\n';
    case 'r':
      return '\r';
    case 't':
      return '\t';
    case 'v':
      return '\v';
    default:
      return c;
  }
}

/// Splits a line of COPY's text format, with its end of line.
void split_line(std::string_view line, Row& row) {
  row.clear();
  if (!line.empty() && line.back() == '\n') line.remove_suffix(1);
  std::string value;
  bool null = false;
  for (std::size_t i = 0; i <= line.size(); ++i) {
    if (i == line.size() || line[i] == '\t') {
      row.push_back(null ? Field() : Field(std::move(value)));
      value.clear();
      null = false;
    } else if (line[i] == '\\' && i + 1 < line.size()) {
      null = line[++i] == 'N' && value.empty();
      if (!null) value += unescaped(line[i]);
    } else {
      value += line[i];
    }
  }
}

}  // namespace

struct Connection::Link {
  PGconn* handle = nullptr;
  ~Link() {
    if (handle) libpq().finish(handle);
  }
};

struct Connection::Answer {
  std::unique_ptr<PGresult, void (*)(PGresult*)> result;
  explicit Answer(PGresult* given) : result(given, libpq().clear) {}
};

Connection::Connection(const std::string& service) : service_(service), link_(std::make_unique<Link>()) {
  check_service_name(service);
  const char* keywords[] = {"service", "fallback_application_name", "client_encoding", nullptr};
  const char* values[] = {service.c_str(), "vip-lab", "UTF8", nullptr};
  link_->handle = libpq().connect_start_params(keywords, values, 0);
  if (!link_->handle) throw std::bad_alloc();
  libpq().set_notice_processor(
      link_->handle, [](void*, const char*) {}, nullptr);
  const bool in_time = libpq().status(link_->handle) == CONNECTION_BAD || complete_connection(link_->handle);
  if (!in_time) {
    throw Failure(service, "no answer within " + std::to_string(connect_timeout_of(link_->handle)) + " s",
                  "check network, host and port of the service; connect_timeout sets another time", "", true);
  }
  if (libpq().status(link_->handle) != CONNECTION_OK) {
    const std::string message = one_line(libpq().error_message(link_->handle));
    const bool unknown = message.find("definition of service") != std::string::npos;
    throw Failure(service, message,
                  unknown ? "add the section [" + service +
                                "] to ~/.pg_service.conf or to the file that PGSERVICEFILE names"
                          : "check the section [" + service +
                                "] of libpq's service file, the password file and whether the server runs",
                  "", !unknown);
  }
  notice_cut_networks(link_->handle);
  // Messages about rows must not depend on settings of the role. A search path without the role's own schemas
  // lets no other role's table or function stand in for a table of the program.
  script(
      "SET search_path = pg_catalog; SET standard_conforming_strings = on; SET extra_float_digits = 1; "
      "SET DateStyle = ISO; SET client_min_messages = warning; SET jit = off");
}

Connection::~Connection() = default;

void Connection::fail() const {
  throw Failure(service_, one_line(libpq().error_message(link_->handle)), mend_of("", true), "", true);
}

Connection::Answer Connection::check(Answer answer) const {
  const PGresult* result = answer.result.get();
  if (!result) fail();
  const auto status = libpq().result_status(result);
  if (status != PGRES_FATAL_ERROR && status != PGRES_BAD_RESPONSE) return answer;
  const std::string state = field(result, PG_DIAG_SQLSTATE);
  // The status of the connection can still be good: libpq sees the end at its next statement. Then no state
  // came from the server, or 57P0x, with which it ends a session.
  const bool lost =
      libpq().status(link_->handle) == CONNECTION_BAD || state.empty() || state.starts_with("57P0");
  std::string problem = field(result, PG_DIAG_MESSAGE_PRIMARY);
  if (problem.empty()) problem = one_line(libpq().result_error_message(result));
  throw Failure(service_, one_line(problem), mend_of(state, lost), state, lost);
}

Rows Connection::run(const std::string& sql, const std::vector<Field>& values) {
  std::vector<const char*> texts;
  for (const Field& value : values) {
    if (value && value->find('\0') != std::string::npos) {
      throw Failure(service_, "a text contains a NUL byte, which PostgreSQL cannot store",
                    mend_of("22021", false), "22021", false);
    }
    texts.push_back(value ? value->c_str() : nullptr);
    if (value) bytes_sent_ += static_cast<std::int64_t>(value->size());
  }
  const Answer answer =
      check(Answer(libpq().exec_params(link_->handle, sql.c_str(), static_cast<int>(texts.size()), nullptr,
                                       texts.data(), nullptr, nullptr, 0)));
  const PGresult* result = answer.result.get();
  Rows rows;
  rows.changed_ = std::atoll(libpq().cmd_tuples(const_cast<PGresult*>(result)));
  for (int i = 0; i < libpq().ntuples(result); ++i) {
    Row& row = rows.rows_.emplace_back();
    for (int j = 0; j < libpq().nfields(result); ++j) {
      const auto length = static_cast<std::size_t>(libpq().getlength(result, i, j));
      row.push_back(libpq().getisnull(result, i, j)
                        ? Field()
                        : Field(std::string(libpq().getvalue(result, i, j), length)));
    }
  }
  return rows;
}

void Connection::script(const std::string& sql) { check(Answer(libpq().exec(link_->handle, sql.c_str()))); }

std::int64_t Connection::insert(const std::string& table, const std::vector<ColumnType>& columns,
                                const std::vector<Row>& rows, const std::string& tail) {
  if (rows.empty()) return 0;
  std::string names, arrays;
  std::vector<Field> values;
  for (std::size_t i = 0; i < columns.size(); ++i) {
    names += (i ? ", " : "") + quoted_name(columns[i].name);
    arrays += (i ? ", $" : "$") + std::to_string(i + 1) + "::" + columns[i].type + "[]";
    values.emplace_back(array_of(rows, i));
  }
  return run("INSERT INTO " + table + " (" + names + ") SELECT * FROM unnest(" + arrays + ") " + tail, values)
      .changed();
}

void Connection::copy_out(const std::string& sql, const std::function<void(const Row&)>& take) {
  check(Answer(libpq().exec(link_->handle, sql.c_str())));
  Row row;
  char* line = nullptr;
  int length = 0;
  while ((length = libpq().get_copy_data(link_->handle, &line, 0)) > 0) {
    const std::unique_ptr<char, void (*)(void*)> kept(line, libpq().freemem);
    split_line({line, static_cast<std::size_t>(length)}, row);
    try {
      take(row);
    } catch (...) {
      // The rest of the rows is not read, so that the connection is of no more use.
      libpq().finish(std::exchange(link_->handle, nullptr));
      throw;
    }
  }
  if (length == -2) fail();
  Answer answer(libpq().get_result(link_->handle));
  while (PGresult* rest = libpq().get_result(link_->handle)) libpq().clear(rest);
  check(std::move(answer));
}

void Connection::cancel() const {
  const std::unique_ptr<PGcancel, void (*)(PGcancel*)> request(libpq().get_cancel(link_->handle),
                                                               libpq().free_cancel);
  char problem[256] = "";
  if (request) libpq().cancel(request.get(), problem, sizeof problem);
}

Transaction::Transaction(Connection& connection, const std::string& begin) : connection_(&connection) {
  connection.script(begin);
}

Transaction::~Transaction() {
  if (!open_) return;
  try {
    connection_->script("ROLLBACK");
  } catch (const std::exception&) {
    // The connection is lost: the server rolls back by itself.
  }
}

void Transaction::commit() {
  open_ = false;
  connection_->script("COMMIT");
}

const Field& Rows::at(int row, int column) const {
  return rows_.at(static_cast<std::size_t>(row)).at(static_cast<std::size_t>(column));
}

const std::string& Rows::text(int row, int column) const {
  const Field& value = at(row, column);
  if (!value) throw std::logic_error("a column of PostgreSQL's answer is NULL");
  return *value;
}

std::int64_t Rows::integer(int row, int column) const { return std::stoll(text(row, column)); }

}  // namespace study::pg
