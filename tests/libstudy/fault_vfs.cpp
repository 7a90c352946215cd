#include "tests/libstudy/fault_vfs.hpp"

#include <fcntl.h>
#include <sqlite3.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <map>
#include <random>
#include <string>
#include <utility>
#include <vector>

namespace study::test {

namespace {

using Kind = VfsFault::Kind;
using Bytes = std::vector<char>;

constexpr std::int64_t sector = 512;

/// Earlier bytes of a part of a file that is not yet synced.
struct Undo {
  std::int64_t at, size_before;
  Bytes bytes;
};

struct State {
  sqlite3_vfs* real = nullptr;
  VfsFault fault;
  long calls = 0;
  bool done = false;
  std::function<void()> before_each;
  bool between = false;  ///< true while before_each runs
  std::map<std::string, std::vector<Undo>> unsynced;
};
State state;

/// An open file; SQLite's own file object follows it in memory.
struct File {
  sqlite3_file base;
  const char* path;  ///< SQLite keeps the name while the file is open; null: a temporary file
  sqlite3_file* real() { return reinterpret_cast<sqlite3_file*>(this + 1); }
};
File* of(sqlite3_file* file) { return reinterpret_cast<File*>(file); }
sqlite3_file* real(sqlite3_file* file) { return of(file)->real(); }

void take_back(int fd, const Undo& undo, bool torn, std::mt19937& random) {
  const auto end = undo.at + static_cast<std::int64_t>(undo.bytes.size());
  for (std::int64_t at = undo.at; at < end;) {
    const std::int64_t next = std::min(end, (at / sector + 1) * sector);
    const bool lost = !torn || random() % 2 == 0;
    if (lost && ::pwrite(fd, undo.bytes.data() + (at - undo.at), static_cast<std::size_t>(next - at), at) < 0)
      ::_exit(1);
    at = next;
  }
  if (!torn && ::ftruncate(fd, undo.size_before) != 0) ::_exit(1);
}

[[noreturn]] void cut_power(bool torn) {
  std::mt19937 random(static_cast<unsigned>(state.calls));
  for (auto& [path, undos] : state.unsynced) {
    const int fd = ::open(path.c_str(), O_RDWR | O_CLOEXEC);
    for (auto undo = undos.rbegin(); fd >= 0 && undo != undos.rend(); ++undo)
      take_back(fd, *undo, torn, random);
    if (fd >= 0) ::close(fd);
    ::unlink((path + "-shm").c_str());
  }
  ::_exit(stopped_status);
}

/// Counts a call. Returns the error that it must fail with, or SQLITE_OK.
int count(int error, bool writes = false) {
  ++state.calls;
  if (state.before_each && !std::exchange(state.between, true)) {
    state.before_each();
    state.between = false;
  }
  const auto [kind, at] = state.fault;
  if (kind == Kind::None || state.calls < at) return SQLITE_OK;
  if (kind == Kind::Stop) ::_exit(stopped_status);
  if (kind == Kind::PowerCut || kind == Kind::TornCut) cut_power(kind == Kind::TornCut);
  const bool full = kind == Kind::Full || kind == Kind::FullOn;
  const bool once = kind == Kind::Error || kind == Kind::Full;
  if ((full && !writes) || (once && state.done)) return SQLITE_OK;
  state.done = true;
  return full ? SQLITE_FULL : error;
}

bool cuts_power() { return state.fault.kind == Kind::PowerCut || state.fault.kind == Kind::TornCut; }

/// Remembers the bytes at [at, at + size) before they change.
void remember(sqlite3_file* file, std::int64_t at, std::int64_t size) {
  if (!cuts_power() || !of(file)->path) return;
  Undo undo{at, 0, {}};
  real(file)->pMethods->xFileSize(real(file), reinterpret_cast<sqlite3_int64*>(&undo.size_before));
  const std::int64_t there = std::clamp<std::int64_t>(undo.size_before - at, 0, size);
  undo.bytes.resize(static_cast<std::size_t>(there));
  if (there > 0) real(file)->pMethods->xRead(real(file), undo.bytes.data(), static_cast<int>(there), at);
  // Bytes beyond the old end read as zeros if they are inside a torn file.
  if (state.fault.kind == Kind::TornCut) undo.bytes.resize(static_cast<std::size_t>(size));
  state.unsynced[of(file)->path].push_back(std::move(undo));
}

// Each of SQLite's calls is counted, then fails or goes to the real file.

int do_close(sqlite3_file* file) { return real(file)->pMethods->xClose(real(file)); }
int do_read(sqlite3_file* file, void* bytes, int size, sqlite3_int64 at) {
  if (const int code = count(SQLITE_IOERR_READ)) return code;
  return real(file)->pMethods->xRead(real(file), bytes, size, at);
}
int do_write(sqlite3_file* file, const void* bytes, int size, sqlite3_int64 at) {
  if (const int code = count(SQLITE_IOERR_WRITE, true)) return code;
  remember(file, at, size);
  return real(file)->pMethods->xWrite(real(file), bytes, size, at);
}
int do_truncate(sqlite3_file* file, sqlite3_int64 size) {
  if (const int code = count(SQLITE_IOERR_TRUNCATE)) return code;
  sqlite3_int64 now = 0;
  real(file)->pMethods->xFileSize(real(file), &now);
  if (now > size) remember(file, size, now - size);
  return real(file)->pMethods->xTruncate(real(file), size);
}
int do_sync(sqlite3_file* file, int flags) {
  if (const int code = count(SQLITE_IOERR_FSYNC)) return code;
  const int code = real(file)->pMethods->xSync(real(file), flags);
  if (code == SQLITE_OK && of(file)->path) state.unsynced.erase(of(file)->path);
  return code;
}
int do_file_size(sqlite3_file* file, sqlite3_int64* size) {
  if (const int code = count(SQLITE_IOERR_FSTAT)) return code;
  return real(file)->pMethods->xFileSize(real(file), size);
}
int do_lock(sqlite3_file* file, int lock) {
  if (const int code = count(SQLITE_IOERR_LOCK)) return code;
  return real(file)->pMethods->xLock(real(file), lock);
}
// Unlocking never fails: SQLite's own tests do not expect it to survive that.
int do_unlock(sqlite3_file* file, int lock) { return real(file)->pMethods->xUnlock(real(file), lock); }
int do_check_reserved(sqlite3_file* file, int* held) {
  if (const int code = count(SQLITE_IOERR_CHECKRESERVEDLOCK)) return code;
  return real(file)->pMethods->xCheckReservedLock(real(file), held);
}
int do_control(sqlite3_file* file, int what, void* value) {
  if (what == SQLITE_FCNTL_SIZE_HINT) {
    if (const int code = count(SQLITE_IOERR_WRITE, true)) return code;
  }
  return real(file)->pMethods->xFileControl(real(file), what, value);
}
int do_sector_size(sqlite3_file*) { return static_cast<int>(sector); }
/// With power cuts, promises no characteristics that a power cut could break.
int do_characteristics(sqlite3_file* file) {
  const int promised = real(file)->pMethods->xDeviceCharacteristics(real(file));
  return cuts_power() ? 0 : promised;
}
int do_shm_map(sqlite3_file* file, int page, int size, int extend, void volatile** memory) {
  if (const int code = count(SQLITE_IOERR_SHMMAP, extend != 0)) return code;
  return real(file)->pMethods->xShmMap(real(file), page, size, extend, memory);
}
int do_shm_lock(sqlite3_file* file, int at, int n, int flags) {
  if (flags & SQLITE_SHM_LOCK) {
    if (const int code = count(SQLITE_IOERR_SHMLOCK)) return code;
  }
  return real(file)->pMethods->xShmLock(real(file), at, n, flags);
}
void do_shm_barrier(sqlite3_file* file) { real(file)->pMethods->xShmBarrier(real(file)); }
int do_shm_unmap(sqlite3_file* file, int remove) {
  return real(file)->pMethods->xShmUnmap(real(file), remove);
}

constexpr sqlite3_io_methods methods{2,
                                     do_close,
                                     do_read,
                                     do_write,
                                     do_truncate,
                                     do_sync,
                                     do_file_size,
                                     do_lock,
                                     do_unlock,
                                     do_check_reserved,
                                     do_control,
                                     do_sector_size,
                                     do_characteristics,
                                     do_shm_map,
                                     do_shm_lock,
                                     do_shm_barrier,
                                     do_shm_unmap,
                                     nullptr,
                                     nullptr};

int do_open(sqlite3_vfs*, const char* name, sqlite3_file* file, int flags, int* out) {
  file->pMethods = nullptr;
  if (const int code = count(SQLITE_CANTOPEN)) return code;
  of(file)->path = flags & SQLITE_OPEN_DELETEONCLOSE ? nullptr : name;
  std::memset(static_cast<void*>(real(file)), 0, static_cast<std::size_t>(state.real->szOsFile));
  const int code = state.real->xOpen(state.real, name, real(file), flags, out);
  if (real(file)->pMethods) file->pMethods = &methods;
  return code;
}
int do_delete(sqlite3_vfs*, const char* name, int sync) {
  if (const int code = count(SQLITE_IOERR_DELETE)) return code;
  const int code = state.real->xDelete(state.real, name, sync);
  if (code == SQLITE_OK) state.unsynced.erase(name);
  return code;
}
int do_access(sqlite3_vfs*, const char* name, int flags, int* out) {
  if (const int code = count(SQLITE_IOERR_ACCESS)) return code;
  return state.real->xAccess(state.real, name, flags, out);
}

}  // namespace

FaultVfs::FaultVfs() {
  state = {};
  state.real = sqlite3_vfs_find(nullptr);
  vfs_ = new sqlite3_vfs(*state.real);
  vfs_->zName = "fault";
  vfs_->szOsFile = static_cast<int>(sizeof(File)) + state.real->szOsFile;
  vfs_->xOpen = do_open;
  vfs_->xDelete = do_delete;
  vfs_->xAccess = do_access;
  sqlite3_vfs_register(vfs_, 1);
}

FaultVfs::~FaultVfs() {
  sqlite3_vfs_unregister(vfs_);
  sqlite3_vfs_register(state.real, 1);
  delete vfs_;
}

void FaultVfs::arm(const VfsFault& fault) {
  state.fault = fault;
  state.calls = 0;
  state.done = false;
  state.unsynced.clear();
}

long FaultVfs::calls() const { return state.calls; }

void FaultVfs::before_each(std::function<void()> work) { state.before_each = std::move(work); }

}  // namespace study::test
