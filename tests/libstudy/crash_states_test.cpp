/// The models by which vip-faults, which injects faults, judges commands: two models of a power cut, and one
/// of permission decisions. Also, each way to read a file must report a read that fails.
#include <gtest/gtest.h>

#include <fstream>
#include <functional>

#include "libstudy/store/file/sqlite.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"
#include "tests/faults/crash_states.hpp"
#include "tests/faults/decisions.hpp"
#include "tests/faults/file_calls.hpp"

namespace faults {
namespace {

using Kind = Call::Kind;

constexpr std::uint64_t old_file = 1, new_file = 2;

Call created(const std::string& path, std::uint64_t file) { return {Kind::Create, file, 0, path, "", ""}; }
Call written(std::uint64_t file, std::int64_t at, const std::string& bytes) {
  return {Kind::Write, file, at, "", "", bytes};
}
Call synced(std::uint64_t file) { return {Kind::Sync, file, 0, "", "", ""}; }
Call folder_synced(const std::string& path) { return {Kind::SyncFolder, 9, 0, path, "", ""}; }
Call unlinked(const std::string& path, std::uint64_t file) { return {Kind::Unlink, file, 0, path, "", ""}; }

/// One file of two bytes.
Tree one_file() {
  Tree tree;
  tree.names["/f/old"] = {old_file, false};
  tree.files[old_file] = "ab";
  return tree;
}

Tree least(const std::vector<Call>& calls, Model model) {
  return crash_state(one_file(), calls, calls.size(), model, Kept::Least);
}

class CrashStates : public ::testing::TestWithParam<Model> {};

TEST_P(CrashStates, WhatWasNotSyncedMayBeLost) {
  const std::vector<Call> calls{written(old_file, 0, "xy"), created("/f/new", new_file)};
  const Tree state = least(calls, GetParam());
  EXPECT_EQ(state.files.at(old_file), "ab");
  EXPECT_FALSE(state.names.contains("/f/new"));
  const Tree most = crash_state(one_file(), calls, calls.size(), GetParam(), Kept::Most);
  EXPECT_EQ(most.files.at(old_file), "xy");
  EXPECT_TRUE(most.names.contains("/f/new"));
}

TEST_P(CrashStates, ASyncedFileKeepsItsBytesAndItsName) {
  const Tree state =
      least({created("/f/new", new_file), written(new_file, 0, "xy"), synced(new_file)}, GetParam());
  ASSERT_TRUE(state.names.contains("/f/new"));
  EXPECT_EQ(state.files.at(new_file), "xy");
}

TEST_P(CrashStates, ASyncedFolderKeepsWhatWentAway) {
  EXPECT_TRUE(least({unlinked("/f/old", old_file)}, GetParam()).names.contains("/f/old"));
  EXPECT_FALSE(
      least({unlinked("/f/old", old_file), folder_synced("/f")}, GetParam()).names.contains("/f/old"));
}

TEST_P(CrashStates, ARenamedFileThatWasNotSyncedMayBeEmpty) {
  const Tree state = least({created("/f/new", new_file),
                            written(new_file, 0, "xy"),
                            {Kind::Rename, new_file, 0, "/f/new", "/f/old", ""},
                            folder_synced("/f")},
                           GetParam());
  EXPECT_EQ(state.names.at("/f/old").file, new_file);
  EXPECT_EQ(state.files.at(new_file), "");
}

INSTANTIATE_TEST_SUITE_P(, CrashStates, ::testing::Values(Model::Ext4, Model::Posix),
                         [](const auto& one) { return std::string(name_of(one.param)); });

// On ext4 a sync of any file makes earlier changes of names durable. On other file systems a power cut may
// bring a deleted export back.
TEST(CrashStatesOfNames, ASyncOfAnotherFileHelpsOnExt4Alone) {
  const std::vector<Call> calls{unlinked("/f/old", old_file), created("/f/new", new_file), synced(new_file)};
  EXPECT_FALSE(least(calls, Model::Ext4).names.contains("/f/old"));
  EXPECT_TRUE(least(calls, Model::Posix).names.contains("/f/old"));
}

TEST(CrashStatesOfNames, ACallIsNotKeptWithoutWhatItBuildsOn) {
  const std::vector<Call> calls{{Kind::Mkdir, 5, 0, "/f/draft", "", ""},
                                created("/f/draft/a", new_file),
                                {Kind::Rename, 5, 0, "/f/draft", "/f/out", ""},
                                folder_synced("/f")};
  const Tree state = least(calls, Model::Posix);
  EXPECT_TRUE(state.names.contains("/f/out"));
  for (unsigned seed = 0; seed < 40; ++seed) {
    const Tree some = crash_state(one_file(), calls, 3, Model::Posix, Kept::Some, seed);
    for (const auto& [path, name] : some.names)
      EXPECT_TRUE(path.rfind('/') == 2 || some.names.contains(path.substr(0, path.rfind('/')))) << path;
  }
}

TEST(DecisionsOfStations, ARefusalHoldsUntilAConsentThatKnewOfIt) {
  Decisions decisions;
  Decisions::Known north, south;
  decisions.decide(north, "P01", What::Gaze, true);
  south = north;
  decisions.decide(north, "P01", What::Gaze, false);
  decisions.decide(south, "P01", What::Gaze, true);  // south does not know of the refusal in north
  south.insert(north.begin(), north.end());
  EXPECT_FALSE(decisions.allows(south, "P01", What::Gaze));
  decisions.decide(south, "P01", What::Gaze, true);
  EXPECT_TRUE(decisions.allows(south, "P01", What::Gaze));
  EXPECT_FALSE(decisions.allows(north, "P01", What::Gaze));
  EXPECT_FALSE(decisions.allows(south, "P01", What::Sharing));
}

TEST(FileCalls, FailAtEachReadOfEveryKind) {
  const ::test::TemporaryFolder folder;
  const auto file = folder / "file", database = folder / "database";
  base::write_file_atomically(file, "bytes");
  study::sqlite::Connection(database, study::sqlite::Open::Create).execute("CREATE TABLE t (a)");
  const std::function<void()> ways[] = {
      [&] { base::read_file(file, 100); }, [&] { base::sha256_of_file(file); },
      [&] {
        std::ifstream stream(file);
        stream.exceptions(std::ios::failbit | std::ios::badbit);
        stream.get();
      },
      [&] {
        for (const auto& entry : std::filesystem::directory_iterator(folder.path())) (void)entry;
      },
      [&] {
        study::sqlite::Connection(database, study::sqlite::Open::Read).integer("SELECT count(*) FROM t");
      }};
  for (const auto& way : ways) {
    CallPlan plan{.folder = folder.path(), .reads = true};
    arm_calls(plan);
    way();
    const long reads = counted_reads();
    EXPECT_GT(reads, 0) << &way - ways;
    plan.kind = CallPlan::Kind::Error;
    for (plan.at = 1; plan.at <= reads; ++plan.at) {
      arm_calls(plan);
      EXPECT_ANY_THROW(way()) << &way - ways << " at " << plan.at << " of " << reads;
    }
  }
  arm_calls({});
}

}  // namespace
}  // namespace faults
