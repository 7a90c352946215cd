/// Accuracy and precision of an eye tracker, and the block that measures them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "libstudy/display/gaze_targets.hpp"
#include "stats/base/error.hpp"
#include "tests/libstudy/permission_fixture.hpp"
#include "tests/libstudy/session_fixture.hpp"

namespace study {
namespace {

using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

/// A direction at these angles from straight ahead, to the right and up.
std::array<double, 3> at(double azimuth_deg, double elevation_deg) {
  const double degree = std::numbers::pi / 180, az = azimuth_deg * degree, el = elevation_deg * degree;
  return {std::sin(az) * std::cos(el), std::sin(el), -std::cos(az) * std::cos(el)};
}

TEST(GazeQuality, IsTheAngleToTheTargetAndTheSpreadAroundTheMean) {
  std::vector<TargetSample> samples;
  for (int i = 0; i < 10; ++i) samples.push_back({true, at(2 + (i % 2 ? 0.5 : -0.5), 0), at(0, 0)});
  samples.push_back({false, {}, at(0, 0)});
  const GazeQuality quality = gaze_quality(samples);
  EXPECT_EQ(quality.samples, 11);
  EXPECT_EQ(quality.valid, 10);
  EXPECT_NEAR(*quality.accuracy_deg, 2, 1e-9);
  EXPECT_NEAR(*quality.sd_deg, 0.5, 1e-9);
  EXPECT_NEAR(*quality.rms_s2s_deg, 1, 1e-9);
}

TEST(GazeQuality, FollowsATargetThatMovesBeforeTheHead) {
  std::vector<TargetSample> samples;
  for (int i = 0; i < 30; ++i) samples.push_back({true, at(i, 10), at(i, 10.5)});
  const GazeQuality quality = gaze_quality(samples);
  EXPECT_NEAR(*quality.accuracy_deg, 0.5, 1e-9);
  EXPECT_NEAR(*quality.sd_deg, 0, 1e-6);
}

TEST(GazeQuality, OfTooFewSamplesIsNotKnown) {
  EXPECT_FALSE(gaze_quality({}).accuracy_deg);
  const TargetSample lost{false, {}, at(0, 0)}, one{true, at(0, 1), at(0, 0)};
  EXPECT_FALSE(gaze_quality({&lost, 1}).sd_deg);
  EXPECT_NEAR(*gaze_quality({&one, 1}).accuracy_deg, 1, 1e-9);
  EXPECT_FALSE(gaze_quality({&one, 1}).rms_s2s_deg);
}

/// A person whose gaze is measured `off` degrees to the right of each target. `off` is a function of the
/// number of the validation, which begins at 1. If it returns 90 or more, the samples are invalid.
class OffTargets final : public GazeTargets {
 public:
  explicit OffTargets(std::function<double(int)> off) : off_(std::move(off)) {}
  void begin() override { ++begun; }
  std::vector<TargetSample> look_at(double azimuth_deg, double elevation_deg, double, double,
                                    const std::function<void()>& check) override {
    check();
    asked.emplace_back(azimuth_deg, elevation_deg);
    const double off = off_(begun);
    return std::vector<TargetSample>(3, {off < 90, at(off, 0), at(0, 0)});
  }
  void end() override { ++ended; }

  int begun = 0, ended = 0;
  std::vector<std::pair<double, double>> asked;

 private:
  std::function<double(int)> off_;
};

/// A session with a gaze validation between consent and trials. Its targets lie up to 8 degrees off the
/// middle.
struct Validated : test::OneSession {
  explicit Validated(std::function<double(int)> off, int gaze_kept = 1)
      : OneSession(validating()), targets(std::move(off)) {
    person.says[gaze_question] = test::score(gaze_kept);
    person.says["rating"] = test::score(4);
  }
  static Protocol validating() {
    return parse_protocol(test::with_before(test::asking_text(), "[[block]]\nkind = \"stimulus\"",
                                            "[[block]]\nkind = \"gaze_validation\"\nid = \"look\"\n"
                                            "extent_deg = 8\nmax_accuracy_deg = 1.5\ntries = 2\n\n"),
                          "validating.toml");
  }
  void run() {
    SessionParts parts = desk.parts(person, store);
    parts.targets = &targets;
    const auto runs = open();
    run_session(protocol, runs.at(0).sessions.at(0), parts, {});
  }
  OffTargets targets;
};

TEST(GazeValidation, IsRepeatedUntilItKeepsToTheBound) {
  Validated session([](int tries) { return tries == 1 ? 3.0 : 1.0; });
  session.run();
  EXPECT_EQ(session.targets.begun, 2);
  EXPECT_EQ(session.targets.ended, 2);
  EXPECT_EQ(session.count("gaze_validation WHERE validation = 1 AND passed = 0 AND abs(accuracy_deg - 3) < "
                          "1e-6"),
            9);
  EXPECT_EQ(session.count("gaze_validation WHERE validation = 2 AND passed = 1 AND samples = 3"), 9);
  EXPECT_EQ(session.count("(SELECT DISTINCT azimuth_deg, elevation_deg FROM gaze_validation)"), 9);
  EXPECT_EQ(session.count("gaze_validation WHERE max(abs(azimuth_deg), abs(elevation_deg)) = 8"), 16);
  EXPECT_EQ(session.count("presentation WHERE state = 'played'"), 2);
}

TEST(GazeValidation, BeyondTheBoundEndsTheCommandAndIsAskedAgain) {
  for (const double off : {3.0, 99.0}) {  // 99: no sample is valid
    Validated session([&](int) { return off; });
    EXPECT_THAT([&] { session.run(); },
                ThrowsMessage<base::Error>(HasSubstr(off < 90 ? "off by 3.00 degrees" : "does not see")));
    EXPECT_EQ(session.count("gaze_validation WHERE passed = 0"), 18);
    EXPECT_EQ(session.count("presentation"), 0);
    EXPECT_EQ(session.open().at(0).sessions.at(0).units.front().plan.block, 1) << "asked again";
  }
}

TEST(GazeValidation, IsLeftOutWhereGazeMayNotBeRecorded) {
  Validated session([](int) { return 3.0; }, 0);
  session.run();
  EXPECT_EQ(session.targets.begun, 0);
  EXPECT_EQ(session.count("gaze_validation"), 0);
  EXPECT_EQ(session.count("event WHERE kind = 'gaze not validated'"), 1);
  EXPECT_EQ(session.count("presentation WHERE state = 'played'"), 2);
}

}  // namespace
}  // namespace study
