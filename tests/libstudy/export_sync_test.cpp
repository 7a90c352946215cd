/// Moves and deletions must be on the disk before the database records them: at each commit, every folder in
/// which an export was renamed or removed has been synced. File systems such as btrfs may otherwise bring a
/// deleted export back after a power loss, without a row that registers it.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export_register.hpp"
#include "libstudy/store/withdraw.hpp"
#include "tests/faults/call_log.hpp"
#include "tests/faults/file_calls.hpp"
#include "tests/libstudy/study_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;
using faults::Call;

bool is_export(const std::string& path) { return path.find("/export-of-") != std::string::npos; }

TEST(ExportSync, NoCommitComesBeforeWhatItSaysIsOnTheDisk) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db", csv = folder / "export-of-all", page = folder / "export-of-all.html";
  Store(path, sqlite::Open::Create).add_run(test::run_plan(test::pairs(), {"P01", "P02"}));
  faults::CallLog log;
  faults::arm_calls({.folder = folder.path(), .log = &log, .record = true});
  for (int times = 0; times < 2; ++times) {  // first a new export, then over an earlier one
    export_csv(path, csv);
    RegisteredFiles(path).write("vip-stats report", page, "P01");
  }
  const Withdrawal done = withdraw(path, "P01");
  faults::arm_calls({});
  EXPECT_EQ(done.beside.cleaned.size(), 2u);
  std::set<fs::path> changed, unsynced;  // names moved or removed; their folders while unsynced
  int commits = 0;
  for (const Call& call : log.read()) {
    using enum Call::Kind;
    if (call.kind == Rename || call.kind == Exchange || call.kind == Unlink || call.kind == Rmdir)
      for (const fs::path one : {call.path, call.to})
        if (is_export(one)) {
          changed.insert(one);
          unsynced.insert(one.parent_path());
        }
    if (call.kind == SyncFolder) unsynced.erase(call.path);
    if (call.kind != Sync || !call.path.ends_with("study.db-wal")) continue;
    ++commits;
    for (const fs::path& one : unsynced) EXPECT_TRUE(is_export(one)) << one << " at commit " << commits;
  }
  EXPECT_GT(commits, 0);
  EXPECT_THAT(changed, ::testing::IsSupersetOf({csv, page}));
}

}  // namespace
}  // namespace study
