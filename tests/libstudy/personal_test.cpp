/// The file of personal data is accepted only if all its rows can be deleted.
#include "libstudy/store/personal.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace study {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// Expects that a file of personal data is refused after `change` was made to it while it was closed.
template <class Change>
void expect_refused(const Change& change, const std::string& words) {
  const test::TemporaryFolder folder;
  const auto database = folder / "study.db";
  PersonalFile(database).keep({{"P01", "age", "Your age", "33"}});
  change(PersonalFile::beside(database));
  EXPECT_THAT([&] { PersonalFile{database}; }, ThrowsMessage<base::Error>(HasSubstr(words)));
}

// SQLite deletes rows by the index, so rows that are missing in the index would remain.
TEST(Personal, AnIndexWithoutItsRowsIsRefused) {
  const auto empty_indices = [](const std::filesystem::path& path) {
    constexpr std::size_t page_bytes = 4096, leaf_of_index = 0x0a;
    std::string bytes = base::read_file(path, 1 << 20);
    for (std::size_t page = page_bytes; page < bytes.size(); page += page_bytes)
      if (bytes[page] == leaf_of_index) bytes[page + 3] = bytes[page + 4] = 0;  // the page's count of entries
    base::write_file_atomically(path, bytes);
  };
  expect_refused(empty_indices, "is damaged");
}

TEST(Personal, WhatVipStudyDidNotMakeIsRefused) {
  const auto by = [](const char* sql) {
    return [sql](const auto& path) { sqlite::Connection(path, sqlite::Open::Write).execute(sql); };
  };
  expect_refused(by("CREATE TRIGGER keeper AFTER DELETE ON personal BEGIN INSERT INTO personal VALUES "
                    "(old.participant, old.question, old.wording, old.answer); END"),
                 "holds 'keeper'");
  expect_refused(by("ALTER TABLE personal ADD COLUMN more TEXT"), "holds 'personal'");
}

}  // namespace
}  // namespace study
