/// Databases damaged by SQL from a grammar (tests/fuzz/database_grammar.hpp), with fixed seeds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "tests/fuzz/database_attack.hpp"
#include "tests/libstudy/hostile_files.hpp"
#include "tests/libstudy/journal_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;

/// Limit of processor time for all commands on one database.
constexpr int most_seconds = 10;

void attack_many(std::uint64_t first_seed, int count) {
  const test::TemporaryFolder folder;
  const fs::path sound = folder / "sound.db";
  test::write_small_study(sound);
  std::set<std::string> made;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    // The number of bytes, and so of statements, varies: commands often accept a database that one statement
    // has changed, but seldom one that many have changed.
    std::vector<std::uint8_t> bytes(4 + random() % 60);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const test::ProcessorTime limit(most_seconds);
    EXPECT_THAT(fuzz::attack(folder.path(), sound, bytes.data(), bytes.size()), ::testing::IsEmpty());
    for (const std::string& statement : fuzz::statements_of(bytes.data(), bytes.size()))
      made.insert(statement.substr(0, 8));
  }
  EXPECT_GE(made.size(), 5u) << "the grammar chooses among few statements";
}

/// Sets each text of a table to bytes that are not UTF-8, where constraints and triggers allow it. Triggers
/// protect the event log.
void set_texts(const fs::path& path, const std::string& table) {
  sqlite::Connection database(path, sqlite::Open::Write);
  database.execute("PRAGMA foreign_keys = OFF");
  for (const std::string& column : columns_of(table)) {
    fuzz::outcome_of([&] {
      database.execute("UPDATE OR IGNORE " + table + " SET " + column +
                       " = CAST(X'78ff79' AS TEXT) WHERE typeof(" + column + ") = 'text'");
    });
  }
}

TEST(DatabaseGrammar, TextsThatAreNotUtf8EndNoCommandUnsaid) {
  const test::TemporaryFolder folder;
  const fs::path sound = folder / "sound.db";
  test::write_small_study(sound);
  for (const auto& [key, object] : schema_of(*make_temporary_database("the schema"))) {
    if (key.first != "table" || key.second.starts_with("sqlite_")) continue;
    SCOPED_TRACE(key.second);
    const fs::path box = folder / "box", study = box / "study.db";
    fs::remove_all(box);
    fs::create_directories(box);
    fs::copy_file(sound, study);
    set_texts(study, key.second);
    // Each command succeeds or throws base::Error, which outcome_of catches. Any other exception fails the
    // test.
    EXPECT_NO_THROW(fuzz::outcome_of([&] { read_status(study); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { export_csv(study, box / "csv"); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { export_bids(study, box / "bids", true); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { export_psych_ds(study, box / "psych"); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { merge({study}, box / "merged.db"); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { salvage(study, box / "new.db"); }));
    EXPECT_NO_THROW(fuzz::outcome_of([&] { withdraw(study, "P02"); }));
  }
}

TEST(DatabaseGrammar, SpoiltDatabasesAreRefusedOrRight) { attack_many(1, 6); }

TEST(DatabaseGrammarSlow, ManySpoiltDatabasesAreRefusedOrRight) { attack_many(1000, 600); }

}  // namespace
}  // namespace study
