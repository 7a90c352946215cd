/// What a light sensor saw, in the database: the grade it raises, and what becomes of it elsewhere.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/light_evidence.hpp"
#include "libstudy/store/merge/merge.hpp"
#include "libstudy/store/read/light_record.hpp"
#include "libstudy/store/read/status.hpp"
#include "libstudy/store/salvage/salvage.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/lit_study.hpp"

namespace study {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

LightEvidence evidence(std::int64_t presentation, std::optional<TimingGrade> grade) {
  LightEvidence one;
  one.light.presentation = presentation;
  one.light.frames = 12;
  one.light.matched = 10;
  one.light.missed = {3, 9};
  one.light.lag_ms = 0.25;
  one.grade = grade;
  one.why_not = grade ? "" : "2 frames missed";
  one.log_sha256 = std::string(64, 'a');
  one.interval_ms = 1;
  return one;
}

std::string light_rows(const std::filesystem::path& path) {
  sqlite::Connection database(path, sqlite::Open::Read);
  sqlite::Statement row(
      database,
      "SELECT participant || ' ' || t.position || ' ' || p.grade || ' ' || e.grade || ' ' || "
      "l.missed_frames || ' ' || coalesce(l.why_not, '-') FROM light l JOIN presentation p "
      "USING (presentation_id) JOIN evidence e USING (presentation_id) JOIN trial t USING "
      "(trial_id) JOIN session USING (session_id) ORDER BY 1");
  std::string all;
  while (row.step()) all += row.text(0) + "; ";
  return all;
}

TEST(LightStore, RaisesTheGradeAndIsMergedSalvagedExportedAndWithdrawn) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  const auto showings = test::light_showings(3, 12);
  for (const char* code : {"P01", "P02"}) test::lit_study(path, showings, code);
  std::filesystem::copy_file(path, folder / "before.db");
  {
    Store store(path, sqlite::Open::Write);
    store.add_light(1, std::vector{evidence(1, TimingGrade::Photodiode), evidence(2, {})});
    store.add_light(1, std::vector{evidence(1, TimingGrade::DisplayFeedback)});  // a later log
    store.add_light(2, std::vector{evidence(5, TimingGrade::Photodiode)});
  }
  const std::string first = "P01 0 D B 3 9 -; P01 1 D D 3 9 2 frames missed; ";
  const std::string second = "P02 1 D A 3 9 -; ";
  EXPECT_EQ(light_rows(path), first + second);
  std::string grades;
  for (const CertificateRow& row : read_certificate_of_protocol(path, 1, FpsMean::Harmonic))
    grades += row.grades + ";";
  EXPECT_THAT(grades, HasSubstr("A"));
  EXPECT_THAT(grades, HasSubstr("B"));
  EXPECT_THAT(grades, HasSubstr("D"));
  merge({folder / "before.db", path}, folder / "merged.db");
  EXPECT_EQ(light_rows(folder / "merged.db"), first + second);
  salvage(path, folder / "salvaged.db");
  EXPECT_EQ(light_rows(folder / "salvaged.db"), first + second);
  export_csv(path, folder / "csv");
  EXPECT_THAT(test::bytes_of(folder / "csv/light.csv"),
              HasSubstr(",2 frames missed,12,10,2,3 9,0,0,0.25,0,"));
  EXPECT_THAT(test::bytes_of(folder / "csv/dictionary.csv"), HasSubstr("light.csv,lag_ms,"));
  const std::string ratings = test::bytes_of(folder / "csv/ratings.csv");
  EXPECT_THAT(ratings, HasSubstr(",degraded,A,"));
  EXPECT_THAT(ratings, HasSubstr(",degraded,D,"));
  withdraw(path, "P01");
  EXPECT_EQ(light_rows(path), second);
}

TEST(LightStore, NeverLowersAGrade) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  test::lit_study(path, test::light_showings(1, 12));
  sqlite::Connection(path, sqlite::Open::Write).execute("UPDATE presentation SET grade = 'A'");
  Store(path, sqlite::Open::Write).add_light(1, std::vector{evidence(1, TimingGrade::DisplayFeedback)});
  EXPECT_EQ(light_rows(path), "P01 0 A A 3 9 -; ");
}

TEST(LightRecord, HasTheOnsetsOfEachStartOfTheProgram) {
  const test::TemporaryFolder folder;
  const auto path = folder / "study.db";
  const auto showings = test::light_showings(3, 12);
  test::lit_study(path, showings);
  test::lit_study(path, showings, "P02", "{}");
  auto record = read_light_record(path, "", 0);
  ASSERT_THAT(record, SizeIs(2));
  EXPECT_TRUE(record[0].patch);
  EXPECT_FALSE(record[1].patch);
  EXPECT_THAT(record[1].showings, IsEmpty()) << "no patch, no light";
  ASSERT_THAT(record[0].showings, SizeIs(3));
  EXPECT_EQ(record[0].showings[2].shown.onsets_ns, showings[2].onsets_ns);
  EXPECT_EQ(record[0].showings[2].position, 2);
  // After a resume the computer's clock may be another.
  test::lit_study(path, showings, "P03", R"({"light_patch":true})", 2);
  record = read_light_record(path, "P03", 1);
  ASSERT_THAT(record, SizeIs(2));
  EXPECT_THAT(record[0].showings, SizeIs(2));
  EXPECT_THAT(record[1].showings, SizeIs(1));
  try {
    read_light_record(path, "P09", 0);
    ADD_FAILURE() << "nobody has this code";
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("has no session of P09"));
  }
}

}  // namespace
}  // namespace study
