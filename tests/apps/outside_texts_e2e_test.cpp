/// Texts of a foreign database or protocol move no cursor, clear no screen and name no file outside the
/// requested folder.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <tuple>

#include "tests/apps/study_test_support.hpp"

namespace apps::test {
namespace {

using study::sqlite::Connection;
using study::sqlite::Open;
using ::testing::HasSubstr;

constexpr const char* clears = "\x1b[2J\r\x07\xC2\x9B";

/// Bytes that a terminal would interpret.
std::string controls_in(const std::string& text) {
  std::string found;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const auto byte = static_cast<unsigned char>(text[i]);
    const bool control = (byte < 0x20 && byte != '\n' && byte != '\t') || byte == 0x7F;
    const bool high = byte == 0xC2 && i + 1 < text.size() && static_cast<unsigned char>(text[i + 1]) < 0xA0;
    if (control || high) found += std::to_string(byte) + " at " + std::to_string(i) + " ";
  }
  return found;
}

class OutsideTextsE2e : public ::testing::Test {
 protected:
  OutsideTextsE2e() {
    base::write_file_atomically(folder_ / "short.toml", short_protocol("1"));
    const Ended ran =
        run_program(run_arguments(folder_ / "short.toml", database_,
                                  {"--clock", "virtual", "--participants", "2", "--station", "north"}));
    EXPECT_EQ(ran.exit_code, 0) << ran.err;
    fs::remove(database_ + ".answers.jsonl");
  }
  void change(const std::string& sql) { Connection(database_, Open::Write).execute(sql); }

  TemporaryFolder folder_;
  std::string database_ = folder_ / "study.db";
};

// Puts control characters into all texts of a database that the schema does not restrict.
TEST_F(OutsideTextsE2e, OfADatabaseReachNoTerminal) {
  for (const char* column :
       {"protocol.name",   "protocol.version",  "question.wording", "question.code",
        "session.station", "session.observer",  "session.display",  "session.stimulus",
        "session.machine", "session.time_zone", "session.code",     "cell.scene",
        "cell.method",     "cell.n_star",       "unit.block",       "presentation.reason",
        "event.kind",      "event.detail",      "run.options",      "run.program_version",
        "framing.scene"}) {
    const std::string name = column, table = name.substr(0, name.find('.'));
    try {
      change("UPDATE " + table + " SET " + name.substr(table.size() + 1) + " = " +
             name.substr(table.size() + 1) + " || '" + clears + "'");
    } catch (const std::exception&) {  // the schema restricts it
    }
  }
  const std::string stats = VIP_BIN_DIR "/vip-stats", out = folder_ / "out", copy = folder_ / "copy.db";
  const std::vector<std::vector<std::string>> commands{
      {vip_study, "status", "--db", database_},
      {vip_study, "export", "--db", database_, "--csv", out, "--bids", out + "b", "--psych-ds", out + "p"},
      {vip_study, "consent", "P01", "--db", database_},
      {vip_study, "merge", database_, "--into", copy},
      {vip_study, "resume", "--db", database_},
      {vip_study, "salvage", "--db", database_, "--into", folder_ / "new.db"},
      {stats, "report", database_, "--html", folder_ / "r.html"},
      {stats, "fit-ptpe", database_},
      {stats, "task1", database_},
      {stats, "task2", database_},
      {vip_study, "withdraw", "P01", "--db", database_, "--yes"}};
  for (const auto& command : commands) {
    const Ended ended = run_program(command);
    EXPECT_EQ(controls_in(ended.out), "") << command[0] << " " << command[1] << "\n" << ended.out;
    EXPECT_EQ(controls_in(ended.err), "") << command[0] << " " << command[1] << "\n" << ended.err;
  }
}

TEST_F(OutsideTextsE2e, OfAProtocolReachNoTerminal) {
  const std::string text = base::read_file(folder_ / "short.toml", 1 << 20);
  for (const std::string key : {"name = \"", "version = \""}) {
    std::string changed = text;
    changed.insert(changed.find("\n" + key) + 1 + key.size(), "\\u001b[2J");
    base::write_file_atomically(folder_ / "hostile.toml", changed);
    for (const auto& command :
         {std::vector<std::string>{vip_study, "check", folder_ / "hostile.toml"},
          run_arguments(folder_ / "hostile.toml", folder_ / "hostile.db", {"--clock", "virtual"})}) {
      const Ended ended = run_program(command);
      EXPECT_EQ(controls_in(ended.out), "") << key << ended.out;
      EXPECT_EQ(controls_in(ended.err), "") << key << ended.err;
    }
  }
}

TEST_F(OutsideTextsE2e, OfADatabaseNameNoFileOutsideOfAnExport) {
  fs::create_directories(folder_ / "a" / "b");
  change("UPDATE protocol SET sha256 = substr('/../../../PWN' || hex(zeroblob(40)), 1, 64)");
  const auto names = [&] {
    std::set<std::string> all;
    for (const auto& entry : fs::recursive_directory_iterator(folder_.path())) {
      const std::string name = entry.path().lexically_relative(folder_.path());
      if (!name.starts_with("study.db")) all.insert(name);
    }
    return all;
  };
  const auto before = names();
  const Ended ended =
      run_program({vip_study, "export", "--db", database_, "--csv", folder_ / "a" / "b" / "out"});
  EXPECT_EQ(ended.exit_code, 1);
  EXPECT_THAT(ended.err, HasSubstr("mend: "));
  EXPECT_EQ(names(), before);
}

/// Makes a locale with German numbers for one test; returns its parent folder, empty if the system cannot
/// make the locale.
std::string german_locales(const fs::path& folder) {
  const std::string made = folder / "de_DE.UTF-8";
  // The exit status does not tell success: localedef returns 1 after mere warnings.
  std::ignore = std::system(("localedef -i de_DE -f UTF-8 " + made + " >/dev/null 2>&1").c_str());
  return fs::exists(fs::path(made) / "LC_NUMERIC") ? folder.string() : "";
}

TEST_F(OutsideTextsE2e, ExcelFilesFollowTheLocale) {
  const auto exported = [&](const char* name, const std::string& locale, const std::string& locales) {
    return run_program({vip_study, "export", "--db", database_, "--csv", folder_ / name, "--excel"}, [&] {
      ::setenv("LC_ALL", locale.c_str(), 1);
      if (!locales.empty()) ::setenv("LOCPATH", locales.c_str(), 1);
    });
  };
  const auto head_of = [&](const char* name) {
    return base::read_file(folder_ / name / "responses.csv", 1 << 20).substr(0, 24);
  };
  const Ended plain = exported("plain", "C.UTF-8", "");
  EXPECT_THAT(plain.out, HasSubstr("',' between fields, '.' as the decimal mark")) << plain.err;
  EXPECT_EQ(head_of("plain"), "\xEF\xBB\xBFresponse_id,unit_id,a");
  const Ended unknown = exported("unknown", "xx_XX.UTF-8", "");
  EXPECT_EQ(unknown.exit_code, 1);
  EXPECT_THAT(unknown.err, HasSubstr("is not installed"));
  EXPECT_FALSE(fs::exists(folder_ / "unknown"));
  fs::create_directory(folder_ / "locales");
  const std::string locales = german_locales(folder_ / "locales");
  ASSERT_NE(locales, "") << "localedef makes no German locale; scripts/setup.sh tools installs its sources";
  const Ended german = exported("german", "de_DE.UTF-8", locales);
  EXPECT_THAT(german.out, HasSubstr("';' between fields, ',' as the decimal mark")) << german.err;
  EXPECT_EQ(head_of("german"), "\xEF\xBB\xBFresponse_id;unit_id;a");
}

}  // namespace
}  // namespace apps::test
