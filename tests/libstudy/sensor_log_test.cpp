/// Logs of light sensors: the formats that are read, and logs that are refused.
#include "libstudy/light/sensor_log.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "libstudy/light/light_edges.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

using study::read_sensor_log;
using study::SensorChoice;
using study::SensorLog;
using ::testing::AllOf;
using ::testing::DoubleNear;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Pointwise;

SensorLog read(const std::string& text, const SensorChoice& choice = {}) {
  const test::TemporaryFolder folder;
  base::write_file_atomically(folder / "log.csv", text);
  return read_sensor_log(folder / "log.csv", choice);
}

std::string problem_of(const std::function<void()>& act) {
  try {
    act();
  } catch (const base::Error& error) {
    return error.what();
  }
  return "";
}

std::string refusal(const std::string& text, const SensorChoice& choice = {}) {
  return problem_of([&] { read(text, choice); });
}

TEST(SensorLog, NamesGiveColumnsAndUnitsInAnyOrder) {
  for (const std::string text :
       {"time_ms,level\n10,1\n11,2\n12,5\n", "Level;Time (ms)\n1;10\n2;11\n5;12\n",
        "# a comment\n\"t [ms]\"\t\"photodiode\"\n10\t1\n11\t2\n12\t5\n", "millis,A0\n10,1\n11,2\n12,5\n",
        "time_s,level\r\n0.010,1\r\n0.011,2\r\n0.012,5\r\n",
        "\xEF\xBB\xBFzeit;level;time_s\n0;1;0,010\n1;2;0,011\n2;5;0,012\n",
        "lsl_timestamp,light\n5000.010,1\n5000.011,2\n5000.012,5\n",
        "time_us,sensor\n1e4,1\n1.1e4,2\n12000,5\n", "time_\xC2\xB5s,sensor\n10000,1\n11000,2\n12000,5\n"}) {
    SCOPED_TRACE(text);
    const SensorLog log = read(text);
    EXPECT_THAT(log.time_s, Pointwise(DoubleNear(1e-9), std::vector<double>{0, 0.001, 0.002}));
    EXPECT_THAT(log.level, ElementsAre(1, 2, 5));
    EXPECT_THAT(log.trigger, IsEmpty());
    EXPECT_NEAR(log.interval_s, 0.001, 1e-9);
    EXPECT_FALSE(log.events);
  }
}

TEST(SensorLog, ATriggerLineIsTheThirdColumn) {
  EXPECT_THAT(read("time_ms,level,trigger\n1,5,0\n2,6,1\n").trigger, ElementsAre(0, 1));
  EXPECT_THAT(read("ttl,time_ms,x\n0,1,5\n1,2,6\n").level, ElementsAre(5, 6));
  EXPECT_THAT(read("a,b,c,d\n1,2,3,4\n2,3,4,5\n", {"ms", {"a", "d", "2"}}).trigger, ElementsAre(2, 3));
  EXPECT_THAT(read("1 9 0\n2 8 1\n", {"ms", {"1", "2", "3"}}).trigger, ElementsAre(0, 1));
}

TEST(SensorLog, AnArduinosLinesNeedAUnitAndMayBeCutAndBeginAgain) {
  EXPECT_THAT(refusal("1000 5\n2000 6\n"),
              AllOf(HasSubstr("does not say the unit"), HasSubstr("--unit s, ms or us")));
  EXPECT_THAT(read("1000 5\n2000 6\n", {"us", {}}).level, ElementsAre(5, 6));
  const SensorLog cut = read("7\n1000,5\n2000,6\n3000,6", {"us", {}});
  EXPECT_THAT(cut.level, ElementsAre(5, 6));
  EXPECT_THAT(cut.remarks,
              ElementsAre("the first line was cut and is left out", "line 4 does not end and is left out"));
  EXPECT_THAT(read("12:00:01.234 -> 1000\t5\n12:00:01.235 -> 2000\t6\n", {"us", {}}).level,
              ElementsAre(5, 6));
  EXPECT_THAT(read("4294966796,5\n500,6\n1500,7\n", {"us", {}}).time_s,
              Pointwise(DoubleNear(1e-9), std::vector<double>{0, 0.001, 0.002}));
  EXPECT_THAT(refusal("1 5 0\n2 6 0\n", {"ms", {}}), HasSubstr("--columns 1,2,3"));
}

TEST(SensorLog, EventsOfABlackBoxToolkitStandAtChanges) {
  const SensorLog log = read(
      ",timestamp,Opto2,Opto1,TTLin2,TTLin1,Mic1\n0,0.0,0,0,0,0,0\n1,756.25,0,1,0,0,0\n2,1287.5,0,0,0,1,0\n");
  EXPECT_TRUE(log.events);
  EXPECT_THAT(log.level, ElementsAre(0, 1, 0));
  EXPECT_THAT(log.trigger, ElementsAre(0, 0, 1));
  const auto edges = study::find_edges(log, log.level, {0, 1, 0}, 0);
  ASSERT_EQ(edges.size(), 2u);
  EXPECT_NEAR(edges[0].time_s, 0.75625, 1e-9) << "not between the rows";
  EXPECT_NEAR(edges[1].time_s, 1.2875, 1e-9);
}

TEST(SensorLog, WhatIsNotUnderstoodIsRefusedAtItsLine) {
  const std::string head = "time_ms,level\n";
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("# only a comment\n"), HasSubstr("is empty"));
  EXPECT_THAT(refusal(head), HasSubstr("fewer than two rows"));
  EXPECT_THAT(refusal(head + "1,2\n"), HasSubstr("fewer than two rows"));
  EXPECT_THAT(refusal(head + "1,2\n2,nan\n3,4\n"),
              AllOf(HasSubstr("log.csv:3"), HasSubstr("'nan' is no number")));
  EXPECT_THAT(refusal(head + "1,2\n2,inf\n"), HasSubstr("'inf' is no number"));
  EXPECT_THAT(refusal(head + "1,2\n2,\n3,4\n"), HasSubstr("'' is no number"));
  EXPECT_THAT(refusal(head + "1,2\n3,2\n2,2\n"),
              AllOf(HasSubstr("log.csv:4"), HasSubstr("goes back in time")));
  EXPECT_THAT(refusal(head + "1,2\n1,2\n"), HasSubstr("has the time of the line before"));
  EXPECT_THAT(refusal(head + "1,2\n2\n3,4\n"), HasSubstr("has 1 fields where 2 belong"));
  EXPECT_THAT(refusal("time_ms,level\n0,5,3,2\n1,5,3,2\n"), HasSubstr("decimal commas need semicolons"));
  EXPECT_THAT(refusal(std::string("time_ms,level\n1,2\n2,\0003\n", 23)), HasSubstr("is no number"));
  EXPECT_THAT(refusal("\xFF\xFE,x\n1,2\n"), HasSubstr("UTF-8"));
  EXPECT_THAT(refusal(std::string(5000, 'x')), HasSubstr("4096 bytes"));
  EXPECT_THAT(refusal("time_ms,a,b\n1,2,3\n2,3,4\n"), HasSubstr("--columns TIME,LEVEL"));
  EXPECT_THAT(refusal(head + "1,2\n2,3\n", {"", {"time_ms", "amount"}}), HasSubstr("'amount'"));
  EXPECT_THAT(refusal(head + "1,2\n2,3\n", {"", {"time_ms"}}), HasSubstr("names 1 columns"));
  EXPECT_THAT(problem_of([] { read_sensor_log("/no/such/file", {}); }), HasSubstr("cannot be read"));
}

TEST(SensorLog, AWrongOrMissingUnitIsRefused) {
  const std::string rows = "1,2\n2,3\n3,4\n";
  EXPECT_THAT(refusal("time,level\n" + rows), HasSubstr("does not say the unit"));
  EXPECT_THAT(refusal("time_ms,level\n" + rows, {"us", {}}),
              AllOf(HasSubstr("--unit us"), HasSubstr("contradicts")));
  EXPECT_THAT(refusal("time,level\n" + rows, {"s", {}}), HasSubstr("has samples 1 s apart"));
  EXPECT_THAT(refusal("time,level\n" + rows, {"us", {}}), HasSubstr("has samples 1e-06 s apart"));
  EXPECT_EQ(refusal("time,level\n" + rows, {"ms", {}}), "");
  EXPECT_THAT(refusal("time_s,level\n0,2\n0.001,3\n90000,4\n"), HasSubstr("lasts 25 hours"));
}

TEST(SensorLog, MissingRowsAreAGap) {
  std::string text = "time_ms,level\n";
  for (int i = 0; i < 100; ++i)
    if (i < 40 || i > 60) text += std::to_string(i) + ",5\n";
  const SensorLog log = read(text);
  ASSERT_EQ(log.gaps.size(), 1u);
  EXPECT_NEAR(log.gaps[0].from_s, 0.039, 1e-9);
  EXPECT_NEAR(log.gaps[0].to_s, 0.061, 1e-9);
}

TEST(LightEdges, ALogWithoutTwoLevelsIsRefused) {
  const auto refused = [](const std::vector<float>& samples) {
    return problem_of([&] { study::find_levels(samples, "log.csv", "its level"); });
  };
  const std::string words = "does not change between two levels";
  EXPECT_THAT(refused(std::vector<float>(100, 5.0f)), HasSubstr(words));
  std::vector<float> ramp, sine, square;
  for (int i = 0; i < 1000; ++i) {
    ramp.push_back(static_cast<float>(i));
    sine.push_back(static_cast<float>(std::sin(0.1 * i)));
    square.push_back(static_cast<float>(i % 50 < 25 ? 100 : 900) + static_cast<float>(i % 7));
  }
  EXPECT_THAT(refused(ramp), HasSubstr(words));
  EXPECT_THAT(refused(sine), HasSubstr(words)) << "mains hum";
  EXPECT_EQ(refused(square), "");
}

TEST(LightEdges, NoiseAtTheThresholdIsOneEdgeAndGapsAreBridged) {
  SensorLog log;
  log.level = {0, 0, 10, 6, 4, 6, 10, 10, 0, 10, 10, 0, 0, 0};
  for (std::size_t i = 0; i < log.level.size(); ++i) log.time_s.push_back(0.001 * static_cast<double>(i));
  const auto times = [&](double hold_s) {
    std::vector<double> out;
    for (const auto& edge : study::find_edges(log, log.level, {0, 10, 0}, hold_s))
      out.push_back((edge.rise ? 1e3 : -1e3) * edge.time_s);
    return out;
  };
  EXPECT_THAT(times(0), Pointwise(DoubleNear(1e-6), std::vector<double>{1.5, -7.5, 8.5, -10.5}));
  EXPECT_THAT(times(0.002), Pointwise(DoubleNear(1e-6), std::vector<double>{1.5, -10.5}));
}

}  // namespace
