/// The experimenter's desk: measured refresh, certificate, pre-flight list, texts.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <sstream>

#include "libstudy/console/certificate.hpp"
#include "libstudy/console/console.hpp"
#include "libstudy/console/preflight.hpp"
#include "libstudy/console/refresh.hpp"
#include "libstudy/pages/words.hpp"

namespace apps {

namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

/// Times at which swaps return on a screen with this period. The beat after swap `missed` is missed.
std::vector<std::int64_t> swaps(double period_ns, int count, double jitter_ns = 0, int missed = -1) {
  std::vector<std::int64_t> out;
  double at = 1e9;
  for (int i = 0; i < count; ++i) {
    out.push_back(std::llround(at + jitter_ns * std::sin(7.0 * i)));
    at += i == missed ? 2 * period_ns : period_ns;
  }
  return out;
}

TEST(Refresh, IsMeasuredWithJitterAndMissedBeats) {
  const double period_ns = 1e9 / 59.951;
  const auto found = study::judge_swaps(swaps(period_ns, 120, 2e5, 40), 60);
  ASSERT_TRUE(found.in_effect);
  EXPECT_NEAR(found.period_ns, period_ns, 1e-4 * period_ns);
  EXPECT_EQ(found.nominal_hz, 60) << "59.95 is what the system calls 60";
}

/// A cell of four trials with these numbers of degraded and failed ones.
study::CertificateRow cell_with(std::int64_t degraded, std::int64_t fail) {
  study::CertificateRow row;
  row.nominal = {50, 5, 10};
  row.trials = 4;
  row.mean = 49.5;
  row.degraded = degraded;
  row.fail = fail;
  row.pass = 4 - degraded - fail;
  row.grades = "D";
  return row;
}

TEST(Certificate, MarksCellsThatFailedByAWord) {
  const auto text = study::format_certificate({cell_with(0, 0), cell_with(1, 0), cell_with(2, 1)},
                                              study::FpsMean::Harmonic, false);
  std::vector<std::string> lines;
  std::istringstream stream(text);
  for (std::string line; std::getline(stream, line);) lines.push_back(line);
  ASSERT_EQ(lines.size(), 6u);
  EXPECT_THAT(lines[0], HasSubstr("harmonic mean"));
  EXPECT_THAT(lines[2], AllOf(Not(HasSubstr("FAIL")), Not(HasSubstr("DEGRADED"))));
  EXPECT_THAT(lines[3], AllOf(HasSubstr("DEGRADED"), Not(HasSubstr("FAIL"))));
  EXPECT_THAT(lines[4], HasSubstr("FAIL"));
  EXPECT_EQ(lines[5], "8 of 12 trials pass, 1 FAIL");
  EXPECT_THAT(text, Not(HasSubstr("\033"))) << "colour where there is no terminal";
}

TEST(Certificate, OfNoTrialIsEmpty) {
  EXPECT_EQ(study::format_certificate({}, study::FpsMean::Harmonic, false), "");
}

TEST(Certificate, NamesWhatDistinguishesItsRowsAndWhatTheyShare) {
  std::vector<study::CertificateRow> rows;
  for (const char* scene : {"data/scenes/single_dam.toml", "data/scenes/faucet.toml"}) {
    for (const char* method : {"Ours", "Ours-TSp"}) {
      rows.push_back(cell_with(0, 0));
      rows.back().what = {scene, method, "32k", ""};
    }
  }
  const auto text = study::format_certificate(rows, study::FpsMean::Harmonic, false);
  EXPECT_THAT(text, HasSubstr("Timing certificate of 32k (harmonic"));
  EXPECT_THAT(text, HasSubstr("\nscene       method        mu  delta"));
  EXPECT_THAT(text, HasSubstr("\nsingle_dam  Ours          50      5"));
  EXPECT_THAT(text, HasSubstr("\nfaucet      Ours-TSp      50      5"));

  rows.resize(1);
  EXPECT_THAT(study::format_certificate(rows, study::FpsMean::Harmonic, false),
              AllOf(HasSubstr("of single_dam, 32k, Ours (harmonic"), HasSubstr("\n    50      5")));
  rows.push_back(rows[0]);
  rows[1].what.scene = "mine/single_dam.toml";
  EXPECT_THAT(study::format_certificate(rows, study::FpsMean::Harmonic, false),
              AllOf(HasSubstr("\ndata/scenes/single_dam.toml "), HasSubstr("\nmine/single_dam.toml ")));
}

TEST(Certificate, HasNoNominalRateWhereTheMethodRanAsFastAsItCould) {
  auto row = cell_with(0, 0);
  row.nominal = {};
  row.mean_worst = 49.5;
  EXPECT_THAT(study::format_certificate({row}, study::FpsMean::Harmonic, false),
              AllOf(HasSubstr("\n     -      -       4   49.500       - "), Not(HasSubstr(" 0      0 "))));
}

TEST(Certificate, IsRedOnATerminalWhereATrialFailed) {
  const auto coloured = [](const study::CertificateRow& row) {
    return study::format_certificate({row}, study::FpsMean::Harmonic, true);
  };
  EXPECT_THAT(coloured(cell_with(0, 0)), Not(HasSubstr("\033")));
  EXPECT_THAT(coloured(cell_with(1, 0)), AllOf(HasSubstr("\033[33m"), Not(HasSubstr("\033[31m"))));
  EXPECT_THAT(coloured(cell_with(1, 1)), AllOf(HasSubstr("\033[31m"), HasSubstr("FAIL\033[0m\n")));
}

TEST(Refresh, AToldRateThatIsWrongIsNotBelieved) {
  const auto found = study::judge_swaps(swaps(1e9 / 144, 120), 60);
  ASSERT_TRUE(found.in_effect);
  EXPECT_NEAR(found.nominal_hz, 144, 0.01);
}

TEST(Refresh, ScreensOfTelevisionRatesCountAsWholeOnes) {
  for (const double told : {0.0, 59.0, 60.0})
    EXPECT_EQ(study::judge_swaps(swaps(1e9 / 59.94, 120), told).nominal_hz, 60) << told;
}

TEST(Refresh, SwapsThatDoNotWaitAreSeen) {
  EXPECT_FALSE(study::judge_swaps(swaps(3e5, 120), 60).in_effect);       // 0.3 ms: the swap does not wait
  EXPECT_FALSE(study::judge_swaps(swaps(8e6, 120, 3e6), 60).in_effect);  // irregular, like drawing times
  EXPECT_FALSE(study::judge_swaps(swaps(1e9 / 60, 5), 60).in_effect);    // too few swaps
  EXPECT_EQ(study::judge_swaps(swaps(3e5, 120), 60).nominal_hz, 0);
}

TEST(Refresh, ABeatIsWhereTheEarliestSwapsCameBack) {
  // Beats at 20, 36, 52, 68, 100 ms; one swap returned on time, one beat was missed.
  const std::vector<std::int64_t> late{20'300'000, 36'000'000, 52'900'000, 68'200'000, 100'500'000};
  EXPECT_EQ(study::beat_of(late, 16e6), 100'000'000);
}

TEST(Refresh, SchedulesBeginBetweenTwoBeats) {
  study::MeasuredRefresh refresh;
  refresh.in_effect = true;
  refresh.period_ns = 16e6;
  refresh.beat_ns = 1'000'000'000;
  for (const std::int64_t earliest : {1'000'000'000LL, 1'007'999'999LL, 1'008'000'001LL, 5'000'000'003LL}) {
    const std::int64_t at = study::between_beats(refresh, earliest);
    EXPECT_GE(at, earliest);
    EXPECT_LT(at, earliest + 16'000'000);
    EXPECT_EQ((at - refresh.beat_ns) % 16'000'000, 8'000'000);
    EXPECT_EQ(study::next_beat(refresh, at), at + 8'000'000);
  }
  EXPECT_EQ(study::between_beats({}, 12345), 12345);
  EXPECT_EQ(study::next_beat({}, 12345), -1);
}

study::Readiness of(const std::vector<study::PreflightLine>& lines, const std::string& what) {
  for (const study::PreflightLine& line : lines) {
    if (line.what == what) return line.readiness;
  }
  ADD_FAILURE() << "no line about " << what;
  return study::Readiness::Unknown;
}

TEST(Preflight, AGoodStationIsOk) {
  study::ScreenFacts screen{60, 59.95, false, false};
  study::StationFacts station;
  station.governors = {"performance"};
  station.free_disk_bytes = 50'000'000'000;
  station.gpu_clock_mhz = 1500;
  station.gpu_max_mhz = 1900;
  station.on_battery = false;
  const auto lines = study::judge_preflight(screen, station, 1'000'000);
  for (const char* what : {"refresh rate", "compositor", "power governor", "free disk", "GPU clock", "power"})
    EXPECT_EQ(of(lines, what), study::Readiness::Ok) << what;
}

TEST(Preflight, WhatSpoilsTimingIsWarnedOf) {
  study::ScreenFacts screen{60, 0, true, true};
  study::StationFacts station;
  station.governors = {"performance", "powersave"};
  station.free_disk_bytes = 9'000'000;
  station.on_battery = true;
  const auto lines = study::judge_preflight(screen, station, 1'000'000);
  for (const char* what : {"refresh rate", "compositor", "power governor", "free disk", "graphics", "power"})
    EXPECT_EQ(of(lines, what), study::Readiness::Warn) << what;
  screen.measured_hz = 75;
  EXPECT_EQ(of(study::judge_preflight(screen, station, 1), "refresh rate"), study::Readiness::Warn);
}

TEST(Preflight, WhatIsNotToldIsUnknown) {
  const auto lines = study::judge_preflight({}, {}, 1);
  for (const study::PreflightLine& line : lines)
    EXPECT_EQ(line.readiness, study::Readiness::Unknown) << line.what;
  EXPECT_THAT(study::format_preflight(lines), HasSubstr("unknown  power governor"));
}

TEST(Words, UnknownLanguagesAreEnglish) {
  EXPECT_EQ(study::desk_words("de-AT").go_on, "Weiter");
  EXPECT_EQ(study::desk_words("tlh").go_on, "Continue");
}

TEST(Words, NothingIsLeftUnsaidInAnyLanguage) {
  using study::Notice;
  using study::Offer;
  for (const char* language : {"en", "de"}) {
    const study::DeskWords& words = study::desk_words(language);
    for (const std::string& one : {words.go_on, words.confirm, words.finish, words.rest, words.pause,
                                   words.ready, words.first, words.second, words.held_title, words.held,
                                   words.trouble_title, words.trouble, words.corner, words.begin})
      EXPECT_FALSE(one.empty()) << language;
    for (const Notice notice : {Notice::Over, Notice::Refused, Notice::NotEligible, Notice::Kept,
                                Notice::Deleted, Notice::Goodbye}) {
      const study::DeskPage& page = words.page(notice);
      for (const std::string& one : {page.title, page.text, page.button})
        EXPECT_FALSE(one.empty()) << language;
      EXPECT_EQ(page.button == words.finish, notice != Notice::Over) << "the last page says so";
    }
    for (const Offer offer : {Offer::StayOut, Offer::Questionnaire, Offer::Keep}) {
      const study::DeskChoice& choice = words.choice(offer);
      for (const std::string& one : {choice.title, choice.text, choice.question, choice.first, choice.second})
        EXPECT_FALSE(one.empty()) << language;
    }
    EXPECT_THAT(words.begin, HasSubstr("Esc"));
    EXPECT_THAT(words.corner, HasSubstr("Esc"));
  }
  EXPECT_NE(study::desk_words("de").over.text, study::desk_words("en").over.text);
}

TEST(Strip, SignsFollowTheRate) {
  EXPECT_EQ(study::strip_sign(1, 1.01), '.');
  EXPECT_EQ(study::strip_sign(1, 1.1), '+');
  EXPECT_EQ(study::strip_sign(1.1, 1), '-');
  EXPECT_EQ(study::strip_sign(1.5, 1), '!');
  EXPECT_EQ(study::strip_sign(0, 1), '!');
}

}  // namespace

}  // namespace apps
