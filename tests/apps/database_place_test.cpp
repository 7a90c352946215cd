/// Warnings, with the reason, about databases on network file systems and in folders that a service copies.
#include "libstudy/console/database_place.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <set>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

/// A probe for which every path has this kind of file system and this mount. Only "/", "/data" and `paths`
/// exist.
study::PlaceProbe made_probe(std::uint32_t kind, const std::string& mount = "",
                             std::set<std::string> paths = {}) {
  paths.insert({"/", "/data"});
  return {[kind](const fs::path&) { return kind; }, [mount](const fs::path&) { return mount; },
          [paths](const fs::path& path) { return paths.contains(path.string()); }};
}
constexpr std::uint32_t ext4 = 0xEF53, fuse = 0x65735546;

TEST(DatabasePlace, NetworkFileSystemsAreNamedWithReasonAndMend) {
  const std::pair<std::uint32_t, const char*> kinds[] = {
      {0x6969, "NFS"}, {0xFF534D42, "SMB"}, {0x517B, "SMB"}, {0xFE534D42, "SMB"}, {0x01021997, "9p"}};
  for (const auto& [kind, name] : kinds)
    EXPECT_THAT(study::place_problems("/data/s.db", made_probe(kind)),
                ElementsAre(AllOf(HasSubstr("/data/s.db: "), HasSubstr(name), HasSubstr("locks"),
                                  HasSubstr("mend: "))));
  EXPECT_THAT(study::place_problems("/data/s.db", made_probe(fuse, "fuse.sshfs")),
              ElementsAre(HasSubstr("fuse.sshfs")));
}

TEST(DatabasePlace, LocalDisksPass) {
  EXPECT_THAT(study::place_problems("/data/s.db", made_probe(ext4)), IsEmpty());
  EXPECT_THAT(study::place_problems("/data/not/there/s.db", made_probe(ext4)), IsEmpty());
  EXPECT_THAT(study::place_problems("/data/s.db", made_probe(fuse, "fuseblk")), IsEmpty());
  EXPECT_THAT(study::place_problems("/data/Dropboxes of pigeons/s.db", made_probe(ext4)), IsEmpty());
}

TEST(DatabasePlace, FoldersThatAServiceCopiesAreKnownByNameOrMark) {
  const std::pair<const char*, const char*> names[] = {
      {"Dropbox", "Dropbox"},     {"Dropbox (Lab)", "Dropbox"},     {"OneDrive - University", "OneDrive"},
      {"Nextcloud", "Nextcloud"}, {"Google Drive", "Google Drive"}, {"iCloud Drive", "iCloud"}};
  for (const auto& [name, service] : names) {
    const std::string folder = std::string("/data/") + name;
    EXPECT_THAT(
        study::place_problems(folder + "/study/s.db", made_probe(ext4, "", {folder, folder + "/study"})),
        ElementsAre(AllOf(HasSubstr(service), HasSubstr("copies"), HasSubstr("mend: "))))
        << name;
  }
  EXPECT_THAT(study::place_problems("/data/s.db", made_probe(ext4, "", {"/data/.stfolder"})),
              ElementsAre(HasSubstr("Syncthing")));
}

// The warning must appear once on the console, and no command may refuse.
TEST(DatabasePlaceE2e, RunMergeAndWithdrawWarn) {
  const TemporaryFolder folder;
  fs::create_directory(folder / "Nextcloud");
  base::write_file_atomically(folder / "short.toml", short_protocol("0.1"));
  const std::string database = folder / "Nextcloud" / "s.db", all = folder / "Nextcloud" / "all.db";
  for (const std::vector<std::string>& arguments :
       {run_arguments(folder / "short.toml", database, {"--participants", "2"}),
        std::vector<std::string>{vip_study, "resume", "--db", database},
        std::vector<std::string>{vip_study, "merge", database, "--into", all},
        std::vector<std::string>{vip_study, "withdraw", "P01", "--db", all, "--yes"}}) {
    const Ended ended = run_program(arguments);
    EXPECT_EQ(ended.exit_code, 0) << ended.err;
    const std::size_t first = ended.err.find("Nextcloud copies");
    EXPECT_NE(first, std::string::npos) << arguments[1] << ": " << ended.err;
    EXPECT_EQ(ended.err.find("Nextcloud copies", first + 1), std::string::npos) << ended.err;
  }
}

}  // namespace
}  // namespace apps::test
