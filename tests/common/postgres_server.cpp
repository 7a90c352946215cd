#include "tests/common/postgres_server.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <grp.h>
#include <netinet/in.h>
#include <pwd.h>
#include <sys/prctl.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <memory>
#include <set>
#include <stdexcept>
#include <thread>
#include <vector>

namespace test {

namespace fs = std::filesystem;

namespace {

constexpr auto patience = std::chrono::seconds(60);

/// Folder of the newest installed server.
fs::path programs_folder() {
  std::set<std::pair<int, fs::path>> found;
  std::error_code missing;
  for (const auto& version : fs::directory_iterator("/usr/lib/postgresql", missing)) {
    if (fs::exists(version.path() / "bin/initdb"))
      found.emplace(std::atoi(version.path().filename().c_str()), version.path() / "bin");
  }
  if (found.empty()) throw std::runtime_error("PostgreSQL is missing; mend: scripts/setup.sh tools");
  return found.rbegin()->second;
}

/// A port of 127.0.0.1 that nobody uses now.
int free_port() {
  const int socket = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  const bool bound = ::bind(socket, reinterpret_cast<sockaddr*>(&address), length) == 0 &&
                     ::getsockname(socket, reinterpret_cast<sockaddr*>(&address), &length) == 0;
  ::close(socket);
  if (!bound) throw std::runtime_error("no free port on 127.0.0.1");
  return ntohs(address.sin_port);
}

/// Starts a program, as the user postgres if this one is root: the server refuses root. Its output goes to
/// `log`. It gets SIGQUIT when this process ends.
pid_t start_program(const std::vector<std::string>& words, const fs::path& log) {
  const passwd* user = ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr;
  const uid_t uid = user ? user->pw_uid : 0;
  const gid_t gid = user ? user->pw_gid : 0;
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child != 0) return child;
  const int out = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
  ::dup2(out, 1);
  ::dup2(out, 2);
  ::close(0);
  if (user && (::setgroups(0, nullptr) != 0 || ::setgid(gid) != 0 || ::setuid(uid) != 0)) ::_exit(126);
  ::prctl(PR_SET_PDEATHSIG, SIGQUIT);  // after setuid(), which clears it
  if (::getppid() != parent || ::chdir("/") != 0) ::_exit(125);
  ::unsetenv("PGSERVICE");
  ::execv(arguments.front(), arguments.data());
  ::_exit(127);
}

std::string content_of(const fs::path& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), {}};
}

void expect_success(pid_t child, const std::string& what, const fs::path& log) {
  int status = 0;
  ::waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw std::runtime_error(what + " failed: " + content_of(log));
}

}  // namespace

PostgresServer::PostgresServer() : programs_(programs_folder()), port_(free_port()), maker_(::getpid()) {
  fs::permissions(folder_.path(), fs::perms(0755));  // for the user postgres
  const fs::path data = folder_ / "data", log = folder_ / "log", sockets = folder_ / "s";
  for (const fs::path& path : {data, sockets}) fs::create_directory(path);
  std::ofstream(log).close();
  if (const passwd* user = ::geteuid() == 0 ? ::getpwnam("postgres") : nullptr) {
    for (const fs::path& path : {data, sockets, log})
      if (::chown(path.c_str(), user->pw_uid, user->pw_gid) != 0)
        throw std::runtime_error("cannot give " + path.string() + " to the user postgres");
  }
  expect_success(start_program({programs_ / "initdb", "-D", data, "-U", "postgres", "-A", "trust", "-E",
                                "UTF8", "--locale=C", "--no-sync", "--no-instructions"},
                               log),
                 "initdb", log);
  std::ofstream(data / "pg_hba.conf") << "local all all trust\nhost all all 127.0.0.1/32 scram-sha-256\n";
  std::ofstream(data / "postgresql.conf", std::ios::app)
      << "listen_addresses = '127.0.0.1'\nport = " << port_ << "\nunix_socket_directories = '"
      << sockets.string() << "'\nfsync = off\nautovacuum = off\nshared_buffers = 16MB\nmax_connections = 60\n"
      << "max_wal_size = 256MB\nlog_min_messages = warning\n";
  std::ofstream(folder_ / "services").close();
  ::setenv("PGSERVICEFILE", (folder_ / "services").c_str(), 1);
  start();
}

PostgresServer::~PostgresServer() {
  if (::getpid() == maker_ && server_ > 0) stop_immediately();
}

void PostgresServer::start() {
  const fs::path data = folder_ / "data";
  // A file of an earlier start could show a server that is not ready yet.
  fs::remove(data / "postmaster.pid");
  server_ = start_program({programs_ / "postgres", "-D", data}, folder_ / "log");
  const auto end = std::chrono::steady_clock::now() + patience;
  while (content_of(data / "postmaster.pid").find("\nready") == std::string::npos) {
    const bool ended = ::waitpid(server_, nullptr, WNOHANG) == server_;
    if (ended || std::chrono::steady_clock::now() > end) {
      if (!ended) ::kill(server_, SIGKILL);
      server_ = 0;
      throw std::runtime_error("PostgreSQL does not start: " + content_of(folder_ / "log"));
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
}

void PostgresServer::stop_immediately() {
  if (server_ <= 0) return;
  ::kill(server_, SIGQUIT);
  ::waitpid(server_, nullptr, 0);  // the server kills its children itself after five seconds
  server_ = 0;
}

void PostgresServer::add_service(const std::string& name, const std::string& role,
                                 const std::string& database, const std::string& more) {
  std::ofstream file(folder_ / "services", std::ios::app);
  file << "[" << name << "]\n";
  if (more.find("host=") == std::string::npos) file << "host=" << (folder_ / "s").string() << "\n";
  if (more.find("port=") == std::string::npos) file << "port=" << port_ << "\n";
  file << "user=" << role << "\ndbname=" << database << "\n" << more << "\n";
}

std::string PostgresServer::sql(const std::string& database, const std::string& text) const {
  std::string name = (folder_ / "sql-XXXXXX").string();
  const int file = ::mkstemp(name.data());
  if (file < 0 || ::fchmod(file, 0666) != 0) throw std::runtime_error("cannot write " + name);
  ::close(file);
  const pid_t child =
      start_program({programs_ / "psql", "-h", folder_ / "s", "-p", std::to_string(port_), "-U", "postgres",
                     "-d", database, "-XqAt", "-v", "ON_ERROR_STOP=1", "-c", text},
                    name);
  int status = 0;
  ::waitpid(child, &status, 0);
  std::string out = content_of(name);
  fs::remove(name);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) throw std::runtime_error(text + ": " + out);
  while (out.ends_with('\n')) out.pop_back();
  return out;
}

PostgresServer& postgres_server() {
  static PostgresServer server;
  return server;
}

}  // namespace test
