/// Moves and deletions must be on the disk before the database records them: at each commit, every folder in
/// which an export was renamed or removed has been synced. File systems such as btrfs may otherwise bring a
/// deleted export back after a power loss, without a row that registers it.
#include <dlfcn.h>
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <set>
#include <string>
#include <vector>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace {

/// Records this process's calls during its lifetime.
struct Follower {
  std::set<std::string> unsynced;        ///< folders with a name that was moved or removed
  std::vector<std::string> early, seen;  ///< commits with such folders; all calls
};
Follower* follower = nullptr;

std::string path_of(int fd) {
  char text[4096];
  const ssize_t n = ::readlink(("/proc/self/fd/" + std::to_string(fd)).c_str(), text, sizeof text);
  return n > 0 ? std::string(text, static_cast<std::size_t>(n)) : "";
}

std::string whole_path(int folder, const char* path) {
  return path[0] == '/' || folder == AT_FDCWD ? path : path_of(folder) + "/" + path;
}

void changed(int folder, const char* name) {
  if (!follower) return;
  const std::string path = whole_path(folder, name);
  if (path.find("/export-of-") == std::string::npos) return;
  follower->seen.push_back("changed " + path);
  follower->unsynced.insert(path.substr(0, path.rfind('/')));
}

void synced(int fd) {
  if (!follower) return;
  const std::string path = path_of(fd);
  follower->unsynced.erase(path);
  if (!path.ends_with("study.db-wal")) return;
  follower->seen.push_back("commit");
  for (const std::string& folder : follower->unsynced)
    if (folder.find("/export-of-") == std::string::npos) follower->early.push_back(folder);
}

template <class Function>
Function* next(const char* name) {
  return reinterpret_cast<Function*>(::dlsym(RTLD_NEXT, name));
}

}  // namespace

extern "C" {

int fsync(int fd) {
  const int done = next<int(int)>("fsync")(fd);
  synced(fd);
  return done;
}

int fdatasync(int fd) {
  const int done = next<int(int)>("fdatasync")(fd);
  synced(fd);
  return done;
}

int unlink(const char* path) noexcept {
  changed(AT_FDCWD, path);
  return next<int(const char*)>("unlink")(path);
}

int unlinkat(int folder, const char* path, int flags) noexcept {
  changed(folder, path);
  return next<int(int, const char*, int)>("unlinkat")(folder, path, flags);
}

int renameat2(int from, const char* path, int to, const char* other, unsigned flags) noexcept {
  changed(from, path);
  changed(to, other);
  return next<int(int, const char*, int, const char*, unsigned)>("renameat2")(from, path, to, other, flags);
}

int rename(const char* path, const char* other) noexcept {
  changed(AT_FDCWD, path);
  changed(AT_FDCWD, other);
  return next<int(const char*, const char*)>("rename")(path, other);
}

}  // extern "C"

namespace study {
namespace {

TEST(ExportSync, NoCommitComesBeforeWhatItSaysIsOnTheDisk) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db", csv = folder / "export-of-all", page = folder / "export-of-all.html";
  Store(path, sqlite::Open::Create).add_run(test::run_plan(test::pairs(), {"P01", "P02"}));
  Follower seen;
  follower = &seen;
  for (int times = 0; times < 2; ++times) {  // first a new export, then over an earlier one
    export_csv(path, csv);
    RegisteredFiles(path).write("vip-stats report", page, "P01");
  }
  const Withdrawal done = withdraw(path, "P01");
  follower = nullptr;
  EXPECT_EQ(done.beside.cleaned.size(), 2u);
  EXPECT_THAT(seen.early, ::testing::IsEmpty()) << ::testing::PrintToString(seen.seen);
  for (const std::string& wanted :
       {std::string("commit"), "changed " + csv.string(), "changed " + page.string()})
    EXPECT_THAT(seen.seen, ::testing::Contains(wanted));
}

}  // namespace
}  // namespace study
