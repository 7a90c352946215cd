/// Files that appear complete at their place in one step and replace nothing but files.

#include "stats/base/new_file.hpp"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <csignal>
#include <filesystem>
#include <fstream>
#include <set>

#include "stats/base/durable.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace base {
namespace {

namespace fs = std::filesystem;

std::size_t entries(const fs::path& folder) {
  return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), fs::directory_iterator()));
}

unsigned rights(const fs::path& path) { return static_cast<unsigned>(fs::status(path).permissions()); }

TEST(NewFile, ALinkWithTheNameOfAnEarlierDraftIsNotWrittenThrough) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "precious", "mine");
  const auto guessed = (folder / "out").string() + ".tmp" + std::to_string(::getpid());
  fs::create_symlink("precious", guessed);
  write_file_atomically(folder / "out", "new");
  EXPECT_EQ(read_file(folder / "precious", 100), "mine");
  EXPECT_EQ(read_file(folder / "out", 100), "new");
  EXPECT_TRUE(fs::is_symlink(guessed));
}

TEST(NewFile, MakesTheFoldersAboveItAndTakesThemAwayUnlessItIsPutInPlace) {
  const test::TemporaryFolder folder;
  const fs::path path = folder / "a" / "b" / "out";
  EXPECT_NO_THROW(check_output(path));
  EXPECT_EQ(entries(folder.path()), 0u) << "asking makes nothing";
  { NewFile given_up(path); }
  EXPECT_EQ(entries(folder.path()), 0u);
  write_file_atomically(path, "new");
  EXPECT_EQ(read_file(path, 10), "new");
  { NewFile given_up(folder / "a" / "c" / "out"); }
  EXPECT_TRUE(fs::exists(path));
  EXPECT_FALSE(fs::exists(folder / "a" / "c"));
  EXPECT_THROW(check_output(path / "below" / "a" / "file"), Error);
  EXPECT_THROW(make_folder_of(path / "below" / "a" / "file"), Error);
}

TEST(NewFile, DraftsHaveNamesThatCannotBeGuessed) {
  std::set<fs::path> names;
  for (int i = 0; i < 100; ++i) names.insert(draft_name("out"));
  EXPECT_EQ(names.size(), 100u);
  EXPECT_EQ(names.begin()->string().size(), std::string("out.tmp").size() + 16);
}

TEST(NewFile, KeepsTheRightsOfTheFileItReplacesAndElseFollowsTheUmask) {
  const test::TemporaryFolder folder;
  const mode_t before = ::umask(027);
  write_file_atomically(folder / "a", "1");
  EXPECT_EQ(rights(folder / "a"), 0640u);
  fs::permissions(folder / "a", fs::perms::owner_read | fs::perms::owner_write);
  ::umask(0);
  write_file_atomically(folder / "a", "2");
  EXPECT_EQ(rights(folder / "a"), 0600u);
  EXPECT_EQ(read_file(folder / "a", 10), "2");
  ::umask(before);
}

TEST(NewFile, ForItsOwnerAloneWhateverTheUmaskAndWhateverStoodThere) {
  const test::TemporaryFolder folder;
  const mode_t before = ::umask(0);
  write_file_atomically(folder / "a", "1");
  for (const char* name : {"a", "b"}) {
    NewFile file(folder / name, Readers::Owner);
    file.put_in_place();
    EXPECT_EQ(rights(folder / name), 0600u) << name;
  }
  ::umask(before);
}

// A rename onto a device would replace the device by the file.
TEST(NewFile, ReplacesNothingButFiles) {
  const test::TemporaryFolder folder;
  fs::create_directory(folder / "folder");
  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  fs::create_symlink("/dev/null", folder / "device");
  for (const char* name : {"folder", "pipe", "device"}) {
    EXPECT_THROW(write_file_atomically(folder / name, "1"), Error) << name;
    EXPECT_FALSE(fs::is_regular_file(fs::symlink_status(folder / name))) << name;
  }
  EXPECT_EQ(entries(folder.path()), 3u);
}

TEST(NewFile, DraftsThatAKillLeftGoAndThoseInHandStay) {
  const test::TemporaryFolder folder;
  for (const char* name : {"out.tmp0123456789abcdef", "out.tmp_mine", "other.tmp0123456789abcdef"})
    write_file_atomically(folder / name, "1");
  NewFile in_hand(folder / "out");
  remove_stale_drafts(folder / "out");
  EXPECT_FALSE(fs::exists(folder / "out.tmp0123456789abcdef"));
  EXPECT_TRUE(fs::exists(folder / "out.tmp_mine"));
  EXPECT_TRUE(fs::exists(folder / "other.tmp0123456789abcdef"));
  in_hand.put_in_place();
  EXPECT_TRUE(fs::exists(folder / "out"));
  EXPECT_EQ(entries(folder.path()), 3u);
}

TEST(NewFile, LeavesNothingBehindWhenItIsNotPutInPlace) {
  const test::TemporaryFolder folder;
  {
    NewFile file(folder / "a");
    file.write("half");
    EXPECT_EQ(entries(folder.path()), 1u);
  }
  EXPECT_EQ(entries(folder.path()), 0u);
  fs::create_directory(folder / "a");
  std::ofstream(folder / "a/b") << "c";
  EXPECT_THROW(write_file_atomically(folder / "a", "text"),
               Error);  // renames over a folder that is not empty
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(NewFile, ADiskThatFillsLeavesTheOldFileAndNoOther) {
  const test::TemporaryFolder folder;
  write_file_atomically(folder / "a", "old");
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  ASSERT_EQ(::getrlimit(RLIMIT_FSIZE, &before), 0);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &small), 0);
  EXPECT_THROW(write_file_atomically(folder / "a", std::string(10000, 'x')), Error);
  ASSERT_EQ(::setrlimit(RLIMIT_FSIZE, &before), 0);
  std::signal(SIGXFSZ, handler);
  EXPECT_EQ(read_file(folder / "a", 10), "old");
  EXPECT_EQ(entries(folder.path()), 1u);
}

TEST(SyncFolders, AFolderThatIsNotThereIsAnErrorThatNamesIt) {
  const test::TemporaryFolder folder;
  fs::create_directories(folder / "a" / "b");
  EXPECT_NO_THROW(sync_folders(folder.path()));
  try {
    sync_folders(folder / "gone");
    ADD_FAILURE() << "no error";
  } catch (const Error& error) {
    EXPECT_TRUE(std::string(error.what()).starts_with((folder / "gone").string())) << error.what();
  }
}

TEST(TemporaryFolder, IsRemovedWithReadOnlyFoldersInIt) {
  fs::path path;
  {
    const test::TemporaryFolder folder;
    path = folder.path();
    fs::create_directories(folder / "a" / "b");
    write_file_atomically(folder / "a" / "b" / "c", "1");
    for (const fs::path& one : {path / "a" / "b", path / "a", path})
      fs::permissions(one, fs::perms::owner_read | fs::perms::owner_exec);
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(FileLock, DoesNotFollowALink) {
  const test::TemporaryFolder folder;
  fs::create_symlink("elsewhere", folder / "a.lock");
  EXPECT_THROW(FileLock(folder / "a"), Error);
  EXPECT_FALSE(fs::exists(folder / "elsewhere"));
}

}  // namespace
}  // namespace base
