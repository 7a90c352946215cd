#include "tests/faults/file_calls.hpp"

#include <fcntl.h>
#include <signal.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdio>
#include <filesystem>

#include "tests/faults/file_calls_parts.hpp"

namespace faults {

namespace calls {

using Kind = CallPlan::Kind;

namespace {

struct State {
  CallPlan plan;
  std::atomic<bool> active{false};
  std::atomic<long> calls{0}, reads{0};
  std::atomic<bool> failed{false};
  std::atomic<bool> exchanges{true};
  std::atomic<std::int64_t> clock_ahead_s{0};
  std::recursive_mutex turn;
};

/// Never destroyed, because it must outlive every destructor of the program.
State& state() {
  static State* const one = new State;
  return *one;
}

bool below(const std::string& path) {
  const std::string& folder = state().plan.folder;
  return path.starts_with(folder) && (path.size() == folder.size() || path[folder.size()] == '/');
}

bool read_fails() {
  const CallPlan& plan = state().plan;
  const long k = ++state().reads;
  if (plan.kind == Kind::Pause && k % plan.at == 0) ::raise(SIGSTOP);
  if (plan.kind != Kind::Error || (plan.from_then_on ? k < plan.at : k != plan.at)) return false;
  errno = EIO;
  return true;
}

}  // namespace

Turn::Turn() : guard_(state().turn) {}

bool records() { return state().plan.record; }
bool exchanges() { return state().exchanges; }
std::int64_t clock_ahead_s() { return state().clock_ahead_s; }

[[noreturn]] void die() {
  ::kill(::getpid(), SIGKILL);
  for (;;) ::pause();
}

std::string path_of(int fd) {
  char link[40], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = ::readlink(link, path, sizeof path);
  return n <= 0 ? std::string() : std::string(path, static_cast<std::size_t>(n));
}

/// Full path, or empty if calls on it do not count.
std::string watched_at(int folder, const char* path) {
  if (!state().active) return {};
  std::filesystem::path whole = path;
  if (path[0] != '/') {
    char here[PATH_MAX] = "";
    whole = (folder != AT_FDCWD ? path_of(folder) : std::string(::getcwd(here, sizeof here) ? here : "")) +
            '/' + path;
  }
  std::string text = whole.lexically_normal().string();
  if (text.size() > 1 && text.ends_with('/')) text.pop_back();
  return below(text) ? text : std::string();
}

bool watched(int fd) { return state().active && below(path_of(fd)); }

struct stat look(int fd) {
  struct stat found {};
  ::fstat(fd, &found);
  return found;
}

struct stat look(const std::string& path) {
  struct stat found {};
  if (::lstat(path.c_str(), &found) != 0) found = {};
  return found;
}

void record(Done kind, std::uint64_t file, std::int64_t at, std::string_view path, std::string_view to,
            std::string_view bytes) {
  if (state().plan.record) state().plan.log->add(kind, file, at, path, to, bytes);
}

/// Counts a call; does not return if the program is to be killed before it.
Act count(Need need) {
  State& now = state();
  const CallPlan& plan = now.plan;
  const long k = ++now.calls;
  if (plan.kind == Kind::None || plan.reads || k < plan.at) return Act::Go;
  if (plan.kind == Kind::Kill) die();
  if (plan.kind == Kind::Tear) return Act::Half;
  if (plan.kind == Kind::Full && need == Need::Nothing) return Act::Go;
  if (!plan.from_then_on && (plan.kind == Kind::Error ? k > plan.at : now.failed.load())) return Act::Go;
  now.failed = true;
  errno = plan.kind == Kind::Full ? ENOSPC : EIO;
  return Act::Fail;
}

/// For calls that cannot be done in part: a kill in the middle of one is a kill before it. True if the call
/// must fail.
bool refuse(Need need) {
  const Act act = count(need);
  if (act == Act::Half) die();
  return act == Act::Fail;
}

bool refuse_read(int fd) { return state().plan.reads && watched(fd) && read_fails(); }
bool refuse_read(int folder, const char* path) {
  return state().plan.reads && !watched_at(folder, path).empty() && read_fails();
}

}  // namespace calls

void arm_calls(const CallPlan& plan) {
  calls::State& now = calls::state();
  now.plan = plan;
  now.calls = now.reads = 0;
  now.failed = false;
  now.clock_ahead_s = plan.clock_ahead_s;
  now.active = !plan.folder.empty();
}

void refuse_exchanges() { calls::state().exchanges = false; }

long counted_calls() { return calls::state().calls; }

long counted_reads() { return calls::state().reads; }

void record_words(const std::string& words) {
  const calls::Turn turn;
  if (CallLog* log = calls::state().plan.log) log->add(Call::Kind::Words, 0, 0, {}, {}, words);
}

}  // namespace faults
