/// Databases spoilt by SQL that a grammar makes (tests/fuzz/database_grammar.hpp), with fixed seeds.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <random>

#include "tests/fuzz/database_attack.hpp"
#include "tests/libstudy/hostile_files.hpp"
#include "tests/libstudy/journal_fixture.hpp"

namespace study {
namespace {

namespace fs = std::filesystem;

/// Most of processor time that all commands on one database may take.
constexpr int most_seconds = 10;

void attack_many(std::uint64_t first_seed, int count) {
  const test::TemporaryFolder folder(::test::memory_folder());
  const fs::path sound = folder / "sound.db";
  test::write_small_study(sound);
  std::set<std::string> made;
  for (int i = 0; i < count; ++i) {
    const std::uint64_t seed = first_seed + static_cast<std::uint64_t>(i);
    SCOPED_TRACE("seed " + std::to_string(seed));
    std::mt19937_64 random(seed);
    // Of one statement there is often something to be taken; of many there seldom is.
    std::vector<std::uint8_t> bytes(4 + random() % 60);
    for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(random());
    const test::ProcessorTime limit(most_seconds);
    EXPECT_THAT(fuzz::attack(folder.path(), sound, bytes.data(), bytes.size()), ::testing::IsEmpty());
    for (const std::string& statement : fuzz::statements_of(bytes.data(), bytes.size()))
      made.insert(statement.substr(0, 8));
  }
  EXPECT_GE(made.size(), 5u) << "the grammar chooses among few statements";
}

TEST(DatabaseGrammar, SpoiltDatabasesAreRefusedOrRight) { attack_many(1, 6); }

TEST(DatabaseGrammarSlow, ManySpoiltDatabasesAreRefusedOrRight) { attack_many(1000, 600); }

}  // namespace
}  // namespace study
