/// Replaces the libc calls that change or read files.
#include <dirent.h>
#include <dlfcn.h>
#include <fcntl.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

#include "tests/faults/file_calls_parts.hpp"

using namespace faults::calls;

namespace {

template <class Function>
Function next(const char* name) {
  return reinterpret_cast<Function>(::dlsym(RTLD_NEXT, name));
}

int open_with(const char* name, int folder, const char* path, int flags, mode_t mode) {
  const auto call = [&] {
    return folder == AT_FDCWD ? next<int (*)(const char*, int, ...)>(name)(path, flags, mode)
                              : next<int (*)(int, const char*, int, ...)>(name)(folder, path, flags, mode);
  };
  const bool changes = (flags & (O_CREAT | O_TRUNC)) || (flags & O_ACCMODE) != O_RDONLY;
  if (!changes && refuse_read(folder, path)) return -1;
  const std::string whole = changes ? watched_at(folder, path) : "";
  if (whole.empty()) return call();
  const Turn turn;
  const struct stat before = look(whole);
  if (refuse(flags & O_CREAT && !stands(before) ? Need::Room : Need::Nothing)) return -1;
  const int fd = call();
  if (fd < 0) return fd;
  if (!stands(before)) record(Done::Create, look(fd).st_ino, 0, whole);
  if (stands(before) && (flags & O_TRUNC)) record(Done::Truncate, look(fd).st_ino, 0, whole);
  return fd;
}

mode_t mode_of(int flags, std::va_list rest) {
  return (flags & O_CREAT) || (flags & O_TMPFILE) == O_TMPFILE ? va_arg(rest, mode_t) : 0;
}

std::int64_t place_of(int fd) {
  if (::fcntl(fd, F_GETFL) & O_APPEND) return look(fd).st_size;
  return ::lseek(fd, 0, SEEK_CUR);
}

/// Bytes of a file, read through a new descriptor, because `fd` may be open only for writing.
std::string bytes_at(int fd, std::int64_t at, std::size_t size) {
  char link[40];
  std::snprintf(link, sizeof link, "/proc/self/fd/%d", fd);
  const int reader = next<int (*)(const char*, int, ...)>("open")(link, O_RDONLY | O_CLOEXEC);
  std::string bytes(size, '\0');
  const ssize_t n = next<ssize_t (*)(int, void*, size_t, off_t)>("pread")(reader, bytes.data(), size, at);
  ::close(reader);
  bytes.resize(n < 0 ? 0 : static_cast<std::size_t>(n));
  return bytes;
}

/// Writes by `whole`, or by `half`, which writes half of the bytes, if the program is to be killed in this
/// call.
template <class Half, class Whole>
ssize_t write_with(int fd, std::int64_t at, Half half, Whole whole) {
  if (!watched(fd)) return whole();
  const Turn turn;
  const Act act = count(Need::Room);
  if (act == Act::Half) {
    half();
    die();
  }
  if (act == Act::Fail) return -1;
  const bool recorded = records();
  if (recorded && at < 0) at = place_of(fd);
  const ssize_t n = whole();
  if (recorded && n > 0)
    record(Done::Write, look(fd).st_ino, at, {}, {}, bytes_at(fd, at, static_cast<std::size_t>(n)));
  return n;
}

int sync_with(const char* name, int fd) {
  const auto call = next<int (*)(int)>(name);
  if (!watched(fd)) return call(fd);
  const Turn turn;
  if (refuse(Need::Room)) return -1;  // a file system that allocates late finds the disk full here
  const int done = call(fd);
  const struct stat found = look(fd);
  if (done == 0) record(S_ISDIR(found.st_mode) ? Done::SyncFolder : Done::Sync, found.st_ino, 0, path_of(fd));
  return done;
}

/// Returns the result of `work`, or -1 with errno set if the plan makes the call fail.
template <class Work>
int resize_with(int fd, Need need, Work work) {
  if (!watched(fd)) return work();
  const Turn turn;
  if (refuse(need)) return -1;
  const int done = work();
  if (done == 0) record(Done::Truncate, look(fd).st_ino, look(fd).st_size, {});
  return done;
}

/// Does `work`, a call that adds, changes or removes a name (from `from` to `to`, if it has a `to`). Does not
/// count if neither path is watched: then both are empty.
template <class Work>
int change_name(Done kind, const std::string& from, const std::string& to, Need need, Work work) {
  if (from.empty() && to.empty()) return work();
  const Turn turn;
  const struct stat before = look(from.empty() ? to : from);
  if (refuse(need)) return -1;
  const int done = work();
  if (done != 0) return done;
  if (kind == Done::Unlink && S_ISDIR(before.st_mode)) kind = Done::Rmdir;
  record(kind, kind == Done::Mkdir ? look(from).st_ino : before.st_ino, 0, from, to);
  return done;
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

int creat(const char* path, mode_t mode) {
  return open_with("open", AT_FDCWD, path, O_WRONLY | O_CREAT | O_TRUNC, mode);
}

ssize_t read(int fd, void* bytes, size_t size) {
  return refuse_read(fd) ? -1 : next<ssize_t (*)(int, void*, size_t)>("read")(fd, bytes, size);
}

#define VIP_PREAD(name)                                                                                     \
  ssize_t name(int fd, void* bytes, size_t size, off_t at) {                                                \
    return refuse_read(fd) ? -1 : next<ssize_t (*)(int, void*, size_t, off_t)>(#name)(fd, bytes, size, at); \
  }
VIP_PREAD(pread)
VIP_PREAD(pread64)

dirent* readdir(DIR* folder) {
  return refuse_read(::dirfd(folder)) ? nullptr : next<dirent* (*)(DIR*)>("readdir")(folder);
}

ssize_t write(int fd, const void* bytes, size_t size) {
  const auto call = next<ssize_t (*)(int, const void*, size_t)>("write");
  return write_with(
      fd, -1, [&] { return call(fd, bytes, size / 2); }, [&] { return call(fd, bytes, size); });
}

#define VIP_PWRITE(name)                                                                                   \
  ssize_t name(int fd, const void* bytes, size_t size, off_t at) {                                         \
    const auto call = next<ssize_t (*)(int, const void*, size_t, off_t)>(#name);                           \
    return write_with(                                                                                     \
        fd, at, [&] { return call(fd, bytes, size / 2, at); }, [&] { return call(fd, bytes, size, at); }); \
  }
VIP_PWRITE(pwrite)
VIP_PWRITE(pwrite64)

ssize_t writev(int fd, const iovec* parts, int n) {
  const auto call = next<ssize_t (*)(int, const iovec*, int)>("writev");
  return write_with(
      fd, -1, [&] { return call(fd, parts, n / 2); }, [&] { return call(fd, parts, n); });
}

ssize_t copy_file_range(int from, off_t* in, int fd, off_t* out, size_t size, unsigned flags) {
  const auto call = next<ssize_t (*)(int, off_t*, int, off_t*, size_t, unsigned)>("copy_file_range");
  return write_with(
      fd, out ? *out : -1, [&] { return call(from, in, fd, out, size / 2, flags); },
      [&] { return call(from, in, fd, out, size, flags); });
}

#define VIP_SENDFILE(name)                                                                               \
  ssize_t name(int fd, int from, off_t* at, size_t size) {                                               \
    const auto call = next<ssize_t (*)(int, int, off_t*, size_t)>(#name);                                \
    return write_with(                                                                                   \
        fd, -1, [&] { return call(fd, from, at, size / 2); }, [&] { return call(fd, from, at, size); }); \
  }
VIP_SENDFILE(sendfile)
VIP_SENDFILE(sendfile64)

int fsync(int fd) { return sync_with("fsync", fd); }
int fdatasync(int fd) { return sync_with("fdatasync", fd); }

#define VIP_TRUNCATE(name)                                                                             \
  int name(int fd, off_t size) noexcept {                                                              \
    return resize_with(fd, Need::Nothing, [&] { return next<int (*)(int, off_t)>(#name)(fd, size); }); \
  }
VIP_TRUNCATE(ftruncate)
VIP_TRUNCATE(ftruncate64)

// These return the error instead of setting errno.
#define VIP_ALLOCATE(name)                                                                                  \
  int name(int fd, off_t at, off_t size) {                                                                  \
    const int done =                                                                                        \
        resize_with(fd, Need::Room, [&] { return next<int (*)(int, off_t, off_t)>(#name)(fd, at, size); }); \
    return done < 0 ? errno : done;                                                                         \
  }
VIP_ALLOCATE(posix_fallocate)
VIP_ALLOCATE(posix_fallocate64)

#define VIP_GOES(name, parameters, arguments, folder)                             \
  int name parameters noexcept {                                                  \
    return change_name(Done::Unlink, watched_at(folder, path), "", Need::Nothing, \
                       [&] { return next<int(*) parameters>(#name) arguments; }); \
  }
VIP_GOES(unlink, (const char* path), (path), AT_FDCWD)
VIP_GOES(unlinkat, (int at, const char* path, int flags), (at, path, flags), at)
VIP_GOES(remove, (const char* path), (path), AT_FDCWD)
VIP_GOES(rmdir, (const char* path), (path), AT_FDCWD)

#define VIP_FOLDER(name, parameters, arguments, folder)                           \
  int name parameters noexcept {                                                  \
    return change_name(Done::Mkdir, watched_at(folder, path), "", Need::Room,     \
                       [&] { return next<int(*) parameters>(#name) arguments; }); \
  }
VIP_FOLDER(mkdir, (const char* path, mode_t mode), (path, mode), AT_FDCWD)
VIP_FOLDER(mkdirat, (int at, const char* path, mode_t mode), (at, path, mode), at)

/// Replaced too, because libc's mkdtemp() makes its folder without calling the mkdir() above.
char* mkdtemp(char* path) noexcept {
  const auto call = next<char* (*)(char*)>("mkdtemp");
  if (watched_at(AT_FDCWD, path).empty()) return call(path);
  const Turn turn;
  if (refuse(Need::Room)) return nullptr;
  if (!call(path)) return nullptr;
  const std::string whole = watched_at(AT_FDCWD, path);
  record(Done::Mkdir, look(whole).st_ino, 0, whole);
  return path;
}

#define VIP_TWO_NAMES(name, kind, parameters, arguments, of, at)                     \
  int name parameters noexcept {                                                     \
    return change_name(kind, watched_at(of, from), watched_at(at, path), Need::Room, \
                       [&] { return next<int(*) parameters>(#name) arguments; });    \
  }
VIP_TWO_NAMES(link, Done::Link, (const char* from, const char* path), (from, path), AT_FDCWD, AT_FDCWD)
VIP_TWO_NAMES(rename, Done::Rename, (const char* from, const char* path), (from, path), AT_FDCWD, AT_FDCWD)
VIP_TWO_NAMES(renameat, Done::Rename, (int of, const char* from, int at, const char* path),
              (of, from, at, path), of, at)

int renameat2(int of, const char* from, int at, const char* path, unsigned flags) noexcept {
  const bool exchange = (flags & RENAME_EXCHANGE) != 0;
  if (exchange && !exchanges()) {
    errno = EINVAL;
    return -1;
  }
  const auto call = next<int (*)(int, const char*, int, const char*, unsigned)>("renameat2");
  return change_name(exchange ? Done::Exchange : Done::Rename, watched_at(of, from), watched_at(at, path),
                     Need::Room, [&] { return call(of, from, at, path, flags); });
}

#define VIP_FOPEN(name)                                                                    \
  FILE* name(const char* path, const char* mode) {                                         \
    const auto call = next<FILE* (*)(const char*, const char*)>(#name);                    \
    const bool changes = std::strpbrk(mode, "wa+");                                        \
    if (!changes && refuse_read(AT_FDCWD, path)) return nullptr;                           \
    const std::string whole = changes ? watched_at(AT_FDCWD, path) : "";                   \
    if (whole.empty()) return call(path, mode);                                            \
    const Turn turn;                                                                       \
    const struct stat before = look(whole);                                                \
    if (refuse(Need::Room)) return nullptr;                                                \
    FILE* const file = call(path, mode);                                                   \
    if (!file) return file;                                                                \
    if (!stands(before)) record(Done::Create, look(whole).st_ino, 0, whole);               \
    if (stands(before) && mode[0] == 'w') record(Done::Truncate, before.st_ino, 0, whole); \
    return file;                                                                           \
  }
VIP_FOPEN(fopen)
VIP_FOPEN(fopen64)

size_t fread(void* bytes, size_t size, size_t n, FILE* file) {
  if (!refuse_read(::fileno(file)))
    return next<size_t (*)(void*, size_t, size_t, FILE*)>("fread")(bytes, size, n, file);
  file->_flags |= _IO_ERR_SEEN;
  return 0;
}

size_t fwrite(const void* bytes, size_t size, size_t n, FILE* file) {
  const auto call = next<size_t (*)(const void*, size_t, size_t, FILE*)>("fwrite");
  const auto flush = next<int (*)(FILE*)>("fflush");
  if (!watched(::fileno(file))) return call(bytes, size, n, file);
  const Turn turn;
  const Act act = count(Need::Room);
  if (act == Act::Half) {
    call(bytes, size, n / 2, file);
    flush(file);
    die();
  }
  if (act == Act::Fail) return 0;
  if (!records()) return call(bytes, size, n, file);
  const auto at = ::ftello(file);
  const std::size_t done = call(bytes, size, n, file);
  flush(file);
  record(Done::Write, look(::fileno(file)).st_ino, at, {}, {},
         {static_cast<const char*>(bytes), size * done});
  return done;
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
