/// A library for LD_PRELOAD: the k-th call with which a program changes files below a folder fails, or is its
/// last. Nothing of the program is rebuilt for it; SQLite's calls are met as well, since they go through
/// libc.
///
///   VIP_FAULT_FOLDER  calls on files below it are counted, from 1; absolute, without links
///   VIP_FAULT         "kill:K"    killed before the K-th call
///                     "tear:K"    killed at the K-th call, which writes half of its bytes where it is a
///                     write "eio:K"     the K-th call fails with EIO; eio+:K: so do all that follow
///                     "enospc:K"  the K-th call that needs room, or the next, fails with ENOSPC; enospc+:K:
///                     all
///                                 that follow
///   VIP_FAULT_COUNT   file that gets the number of calls when the program ends by itself
///
/// Counted are open for writing, write, sync, truncate, rename, link, remove, mkdir and the same of stdio;
/// not what is written through a mapping (the index of SQLite's log, which every opening makes anew).
#include <dlfcn.h>
#include <fcntl.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

enum class Kind { None, Kill, Tear, Error, Full };
enum class Need { Room, Nothing };  // whether a full disk makes the call fail

struct Plan {
  char folder[PATH_MAX] = "";
  std::size_t length = 0;
  Kind kind = Kind::None;
  bool from_then_on = false;
  long at = 0;
};

Plan read_plan() {
  Plan plan;
  const char* folder = std::getenv("VIP_FAULT_FOLDER");
  if (!folder || !*folder) return plan;
  std::snprintf(plan.folder, sizeof plan.folder, "%s", folder);
  plan.length = std::strlen(plan.folder);
  const char* fault = std::getenv("VIP_FAULT");
  char name[16] = "";
  if (!fault || std::sscanf(fault, "%15[a-z+]:%ld", name, &plan.at) != 2) return plan;
  const std::size_t last = std::strlen(name) - 1;
  if (name[last] == '+') {
    plan.from_then_on = true;
    name[last] = 0;
  }
  plan.kind = !std::strcmp(name, "kill")     ? Kind::Kill
              : !std::strcmp(name, "tear")   ? Kind::Tear
              : !std::strcmp(name, "eio")    ? Kind::Error
              : !std::strcmp(name, "enospc") ? Kind::Full
                                             : Kind::None;
  return plan;
}

const Plan& plan() {
  static const Plan read = read_plan();
  return read;
}

std::atomic<long> calls{0};
std::atomic<bool> failed{false};

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

[[noreturn]] void die() {
  ::kill(::getpid(), SIGKILL);
  for (;;) ::pause();
}

bool below(const char* path) {
  const Plan& p = plan();
  return p.length > 0 && !std::strncmp(path, p.folder, p.length) &&
         (path[p.length] == '/' || path[p.length] == 0);
}

bool watched(int fd) {
  if (plan().length == 0) return false;
  char link[40], path[PATH_MAX];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const ssize_t n = ::readlink(link, path, sizeof path - 1);
  if (n <= 0) return false;
  path[n] = 0;
  return below(path);
}

bool watched_at(int folder, const char* path) {
  if (plan().length == 0) return false;
  if (path[0] == '/') return below(path);
  if (folder != AT_FDCWD) return watched(folder);
  char here[PATH_MAX];
  return ::getcwd(here, sizeof here) && below(here);
}

enum class Act { Go, Half, Fail };

/// Counts a call; does not return where the program is to end before it.
Act count(Need need) {
  const Plan& p = plan();
  const long k = ++calls;
  if (p.kind == Kind::None || k < p.at) return Act::Go;
  if (p.kind == Kind::Kill) die();
  if (p.kind == Kind::Tear) return Act::Half;
  if (p.kind == Kind::Full && need == Need::Nothing) return Act::Go;
  if (!p.from_then_on && (p.kind == Kind::Error ? k > p.at : failed.load())) return Act::Go;
  failed = true;
  errno = p.kind == Kind::Full ? ENOSPC : EIO;
  return Act::Fail;
}

/// For calls that are done whole or not at all.
bool refuse(Need need) {
  const Act act = count(need);
  if (act == Act::Half) die();
  return act == Act::Fail;
}

/// `half`: does half of the work, before the program ends.
template <class Half, class Whole>
auto write_with(int fd, Half half, Whole whole) -> decltype(whole()) {
  if (watched(fd)) {
    const Act act = count(Need::Room);
    if (act == Act::Half) {
      half();
      die();
    }
    if (act == Act::Fail) return -1;
  }
  return whole();
}

struct AtEnd {
  ~AtEnd() {
    const char* path = std::getenv("VIP_FAULT_COUNT");
    if (!path || plan().length == 0) return;
    const int fd = next<int (*)(const char*, int, ...)>("open")(path, O_WRONLY | O_CREAT | O_TRUNC, 0600);
    char text[24];
    const int n = std::snprintf(text, sizeof text, "%ld\n", calls.load());
    if (fd < 0) return;
    if (next<ssize_t (*)(int, const void*, size_t)>("write")(fd, text, n) != n) std::abort();
    ::close(fd);
  }
} at_end;

int open_with(const char* name, int folder, const char* path, int flags, mode_t mode) {
  const bool changes = (flags & (O_CREAT | O_TRUNC)) || (flags & O_ACCMODE) != O_RDONLY;
  if (changes && watched_at(folder, path) &&
      refuse(flags & O_CREAT && ::faccessat(folder, path, F_OK, 0) != 0 ? Need::Room : Need::Nothing))
    return -1;
  return folder == AT_FDCWD ? next<int (*)(const char*, int, ...)>(name)(path, flags, mode)
                            : next<int (*)(int, const char*, int, ...)>(name)(folder, path, flags, mode);
}

mode_t mode_of(int flags, std::va_list rest) {
  return (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(rest, mode_t) : 0;
}

}  // namespace

extern "C" {

#define VIP_OPEN(name)                                    \
  int name(const char* path, int flags, ...) {            \
    std::va_list rest;                                    \
    va_start(rest, flags);                                \
    const mode_t mode = mode_of(flags, rest);             \
    va_end(rest);                                         \
    return open_with(#name, AT_FDCWD, path, flags, mode); \
  }
VIP_OPEN(open)
VIP_OPEN(open64)

#define VIP_OPENAT(name)                                                         \
  int name(int folder, const char* path, int flags, ...) {                       \
    std::va_list rest;                                                           \
    va_start(rest, flags);                                                       \
    const mode_t mode = mode_of(flags, rest);                                    \
    va_end(rest);                                                                \
    if (folder == AT_FDCWD) return open_with("open", folder, path, flags, mode); \
    return open_with(#name, folder, path, flags, mode);                          \
  }
VIP_OPENAT(openat)
VIP_OPENAT(openat64)

ssize_t write(int fd, const void* bytes, size_t size) {
  const auto call = next<ssize_t (*)(int, const void*, size_t)>("write");
  return write_with(
      fd, [&] { call(fd, bytes, size / 2); }, [&] { return call(fd, bytes, size); });
}

#define VIP_PWRITE(name)                                                                        \
  ssize_t name(int fd, const void* bytes, size_t size, off_t at) {                              \
    const auto call = next<ssize_t (*)(int, const void*, size_t, off_t)>(#name);                \
    return write_with(                                                                          \
        fd, [&] { call(fd, bytes, size / 2, at); }, [&] { return call(fd, bytes, size, at); }); \
  }
VIP_PWRITE(pwrite)
VIP_PWRITE(pwrite64)

ssize_t writev(int fd, const iovec* parts, int n) {
  const auto call = next<ssize_t (*)(int, const iovec*, int)>("writev");
  return write_with(
      fd, [&] { call(fd, parts, n / 2); }, [&] { return call(fd, parts, n); });
}

#define VIP_ON_FILE(result, name, parameters, arguments, need) \
  result name parameters {                                     \
    if (watched(fd) && refuse(need)) return -1;                \
    return next<result(*) parameters>(#name) arguments;        \
  }
VIP_ON_FILE(int, fsync, (int fd), (fd), Need::Room)  // a late allocation fails here
VIP_ON_FILE(int, fdatasync, (int fd), (fd), Need::Room)
VIP_ON_FILE(int, ftruncate, (int fd, off_t size), (fd, size), Need::Nothing)
VIP_ON_FILE(int, ftruncate64, (int fd, off_t size), (fd, size), Need::Nothing)
VIP_ON_FILE(ssize_t, copy_file_range, (int from, off_t* in, int fd, off_t* out, size_t size, unsigned flags),
            (from, in, fd, out, size, flags), Need::Room)
VIP_ON_FILE(ssize_t, sendfile, (int fd, int from, off_t* at, size_t size), (fd, from, at, size), Need::Room)
VIP_ON_FILE(ssize_t, sendfile64, (int fd, int from, off_t* at, size_t size), (fd, from, at, size), Need::Room)

// These return what is wrong instead of setting errno.
#define VIP_ALLOCATE(name)                                        \
  int name(int fd, off_t at, off_t size) {                        \
    if (watched(fd) && refuse(Need::Room)) return errno;          \
    return next<int (*)(int, off_t, off_t)>(#name)(fd, at, size); \
  }
VIP_ALLOCATE(posix_fallocate)
VIP_ALLOCATE(posix_fallocate64)

#define VIP_ON_PATH(name, parameters, arguments, folder, need) \
  int name parameters {                                        \
    if (watched_at(folder, path) && refuse(need)) return -1;   \
    return next<int(*) parameters>(#name) arguments;           \
  }
VIP_ON_PATH(unlink, (const char* path), (path), AT_FDCWD, Need::Nothing)
VIP_ON_PATH(unlinkat, (int at, const char* path, int flags), (at, path, flags), at, Need::Nothing)
VIP_ON_PATH(remove, (const char* path), (path), AT_FDCWD, Need::Nothing)
VIP_ON_PATH(rmdir, (const char* path), (path), AT_FDCWD, Need::Nothing)
VIP_ON_PATH(mkdir, (const char* path, mode_t mode), (path, mode), AT_FDCWD, Need::Room)
VIP_ON_PATH(mkdirat, (int at, const char* path, mode_t mode), (at, path, mode), at, Need::Room)
VIP_ON_PATH(link, (const char* from, const char* path), (from, path), AT_FDCWD, Need::Room)
VIP_ON_PATH(symlink, (const char* from, const char* path), (from, path), AT_FDCWD, Need::Room)
VIP_ON_PATH(rename, (const char* from, const char* path), (from, path), AT_FDCWD, Need::Room)
VIP_ON_PATH(renameat, (int of, const char* from, int at, const char* path), (of, from, at, path), at,
            Need::Room)
VIP_ON_PATH(renameat2, (int of, const char* from, int at, const char* path, unsigned flags),
            (of, from, at, path, flags), at, Need::Room)

#define VIP_FOPEN(name)                                                                                \
  FILE* name(const char* path, const char* mode) {                                                     \
    if (std::strpbrk(mode, "wa+") && watched_at(AT_FDCWD, path) && refuse(Need::Room)) return nullptr; \
    return next<FILE* (*)(const char*, const char*)>(#name)(path, mode);                               \
  }
VIP_FOPEN(fopen)
VIP_FOPEN(fopen64)

size_t fwrite(const void* bytes, size_t size, size_t n, FILE* file) {
  const auto call = next<size_t (*)(const void*, size_t, size_t, FILE*)>("fwrite");
  if (watched(::fileno(file))) {
    const Act act = count(Need::Room);
    if (act == Act::Half) {
      call(bytes, size, n / 2, file);
      next<int (*)(FILE*)>("fflush")(file);
      die();
    }
    if (act == Act::Fail) return 0;
  }
  return call(bytes, size, n, file);
}

int fflush(FILE* file) {
  if (file && watched(::fileno(file)) && refuse(Need::Room)) return EOF;
  return next<int (*)(FILE*)>("fflush")(file);
}

int fclose(FILE* file) {
  const bool refused = watched(::fileno(file)) && refuse(Need::Room);
  const int problem = errno;
  const int done = next<int (*)(FILE*)>("fclose")(file);
  if (!refused) return done;
  errno = problem;
  return EOF;
}

}  // extern "C"
