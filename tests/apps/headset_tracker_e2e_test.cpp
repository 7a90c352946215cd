/// Eye trackers outside OpenXR in the simulated headset: whole sessions in real time, and vip-study gaze.
#include <cmath>
#include <numbers>
#include <regex>

#include "libstudy/headset/headset_recorder.hpp"
#include "libstudy/markers/tcp_socket.hpp"
#include "libstudy/store/file/sqlite.hpp"
#include "tests/apps/headset_runs.hpp"
#include "tests/libstudy/gaze_sender.hpp"
#include "tests/libstudy/permission_fixture.hpp"

namespace apps {
namespace {

namespace fs = std::filesystem;
using ::testing::AllOf;
using ::testing::Each;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::MatchesRegex;
using ::testing::Not;
using ::testing::SizeIs;

constexpr std::int64_t outside_ms = 1'000'000;

/// A slot whose head is turned by this many degrees to the left.
study::HeadsetRecord slot_at_ms(std::int64_t ms, double yaw_deg) {
  const double half = yaw_deg * std::numbers::pi / 360;
  study::HeadsetRecord record;
  record.slot.predicted_ns = ms * outside_ms;
  record.input.head.turn = {0, static_cast<float>(std::sin(half)), 0, static_cast<float>(std::cos(half))};
  record.input.head.place_valid = record.input.head.turn_valid = record.input.head.turn_tracked = true;
  return record;
}

TEST(OutsideEyes, ASampleIsJoinedWithTheNearestSlotAndItsHead) {
  study::OutsideEyes eyes;
  const std::vector<study::HeadsetRecord> slots{slot_at_ms(100, 0), slot_at_ms(110, 90),
                                                slot_at_ms(120, 180)};
  const std::vector<study::TrackedGaze> samples{{104 * outside_ms, 7, 0, true, {0.6, 0, -0.8}},
                                                {106 * outside_ms, 8, 0, true, {0, 0.6, -0.8}},
                                                {130 * outside_ms, 9, 0, true, {0, 0, 1}},
                                                {131 * outside_ms, 10, 0, false, {0, 0, -1}}};
  EXPECT_FALSE(study::OutsideEyes().newest());
  EXPECT_THAT(study::OutsideEyes().join({}, samples), SizeIs(0));
  const auto joined = eyes.join(slots, samples);
  ASSERT_THAT(joined, SizeIs(4));
  EXPECT_EQ(joined[0].slot.predicted_ns, 100 * outside_ms);
  EXPECT_EQ(joined[1].slot.predicted_ns, 110 * outside_ms);
  EXPECT_EQ(joined[2].slot.predicted_ns, 120 * outside_ms);
  // In the room: ahead of a head that is turned to the left by 90 degrees is -x.
  const auto in_room = direction_of(joined[1].input.gaze->ray);
  EXPECT_NEAR(in_room[0], -0.8, 1e-6);
  EXPECT_NEAR(in_room[1], 0.6, 1e-6);
  EXPECT_NEAR(in_room[2], 0, 1e-6);
  for (std::size_t i = 0; i < joined.size(); ++i) {
    const study::GazeSample sample = study::gaze_of(joined[i], study::GazeOrigin::Tracker);
    EXPECT_EQ(sample.sampled_ns, samples[i].sampled_ns);
    EXPECT_EQ(sample.device_ns, samples[i].device_ns);
    EXPECT_EQ(sample.valid, samples[i].valid);
    for (std::size_t k = 0; sample.valid && k < 3; ++k)
      EXPECT_NEAR(sample.ray->direction[k], samples[i].direction[k], 1e-6) << i;
  }
  EXPECT_FALSE(eyes.newest()->input.gaze->ray.turn_valid) << "the newest sample is a blink";
  eyes.join({}, std::vector<study::TrackedGaze>{samples[0]});
  EXPECT_TRUE(eyes.newest()->input.gaze->ray.turn_valid);
  eyes.join(std::vector{slot_at_ms(400, 0)}, {});
  EXPECT_FALSE(eyes.newest()->input.gaze) << "too old to be followed";
}

class HeadsetTrackerE2e : public test::HeadsetRuns {
 protected:
  /// Two showings of half a second after a consent page.
  std::vector<std::string> session(const std::string& gaze, int consent = 1,
                                   const std::vector<std::string>& more = {}) {
    if (!fs::exists(dam_)) bake_dam(dam_, 60);
    if (!fs::exists(protocol_)) base::write_file_atomically(protocol_, test::asking_at_60());
    fs::remove(database_);
    fs::remove(database_ + ".answers.jsonl");
    std::vector<std::string> all{"run",
                                 protocol_,
                                 "--db",
                                 database_,
                                 "--observer",
                                 "constant:" + std::to_string(consent),
                                 "--display",
                                 "openxr",
                                 "--clock",
                                 "real",
                                 "--stimulus",
                                 dam_,
                                 "--participants",
                                 "1",
                                 "--gaze",
                                 gaze};
    all.insert(all.end(), more.begin(), more.end());
    return all;
  }
  std::int64_t count(const std::string& rows) {
    return study::sqlite::Connection(database_, study::sqlite::Open::Read)
        .integer("SELECT count(*) FROM " + rows);
  }
  std::vector<std::string> column(const std::string& sql) { return study::test::column(database_, sql); }

  const std::string real_ = "size=32x32;clock=real;rates=30;rate=30;gaze=0;";
  const std::string dam_ = folder_ / "dam.bake", database_ = folder_ / "study.db";
  const std::string protocol_ = folder_ / "asking.toml";
};

TEST_F(HeadsetTrackerE2e, SamplesAreKeptWithTheSessionsTime) {
  const ::test::GazeSender sender({.rate_hz = 100, .ahead_s = 500, .direction = "-0.6 0 -0.8"});
  const auto ended = study(real_ + "yaw=30;pitch=15", session(sender.name()));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(calls(), Not(HasSubstr("XR_EXT_eye_gaze_interaction")))
      << "the runtime's tracker is not asked for";
  EXPECT_THAT(ended.err, Not(HasSubstr("network")));
  EXPECT_GT(count("gaze"), 60);
  EXPECT_EQ(count("gaze WHERE source <> 'tracker' OR NOT valid OR NOT tracked"), 0);
  // Each time is the tracker's plus one of the offsets, and the offsets are right within half a round trip.
  EXPECT_EQ(count("gaze g JOIN presentation p USING (presentation_id) WHERE NOT EXISTS (SELECT 1 FROM "
                  "tracker_clock c WHERE c.offset_ns = g.sampled_ns + p.start_ns - g.device_ns)"),
            0);
  EXPECT_GE(count("tracker_clock"), 2);
  EXPECT_EQ(count("tracker_clock WHERE source <> '" + sender.name() +
                  "' OR device <> 'A tracker' OR abs(offset_ns + 500000000000) > round_trip_ns / 2 + 1"),
            0);
  // The direction is relative to the head, however the head is turned.
  EXPECT_EQ(count("gaze WHERE abs(direction_x + 0.6) > 1e-5 OR abs(direction_z + 0.8) > 1e-5"), 0);
  EXPECT_GT(count("gaze WHERE x IS NOT NULL"), 40);
  EXPECT_EQ(count("presentation WHERE gaze_source = 'tracked' AND state = 'played'"), 2);
  EXPECT_EQ(count("session WHERE gaze_source = 'tracked'"), 1);
  const auto exported = run({"export", "--db", database_, "--bids", folder_ / "bids", "--gaze"}, {});
  ASSERT_EQ(exported.exit_code, 0) << exported.err;
  std::string sidecars;
  for (const auto& entry : fs::recursive_directory_iterator(folder_ / "bids")) {
    if (entry.path().string().ends_with("_recording-eye1_physio.json"))
      sidecars += base::read_file(entry.path().string(), 1 << 20);
  }
  EXPECT_THAT(sidecars, HasSubstr("\"ManufacturersModelName\": \"A tracker\""));
}

TEST_F(HeadsetTrackerE2e, WhatCannotBeReadIsRefusedBeforeAnythingIsWritten) {
  base::write_file_atomically(dam_, "no bake is read");
  const auto refused = [&](const std::vector<std::string>& arguments, int status, const std::string& says) {
    const auto ended = study("", arguments);
    EXPECT_EQ(ended.exit_code, status) << says;
    EXPECT_THAT(ended.err, HasSubstr(says));
    EXPECT_FALSE(fs::exists(database_));
  };
  const auto changed = [&](const std::string& what, const std::string& into,
                           const std::string& gaze = "tcp:9") {
    auto arguments = session(gaze);
    *(std::find(arguments.begin(), arguments.end(), what) + 1) = into;
    return arguments;
  };
  refused(changed("--clock", "virtual"), 1, "time stands still on the virtual clock");
  refused(changed("--display", "none"), 1, "only a headset knows the head");
  refused(changed("--gaze", "udp:9"), 2, "'udp:9' is not fixed, mouse, head, tracked, none, tcp:");
  refused(session("tcp:9", 1, {"--gaze-turn", "1,2"}), 2, "write three angles");
  base::write_file_atomically(protocol_, test::asking_at_60(false));
  refused(session("tcp:9"), 1, "ask gaze_kept");
}

using HeadsetTrackerSlow = HeadsetTrackerE2e;

TEST_F(HeadsetTrackerSlow, WithoutConsentNothingIsKeptAndTheHeadStandsIn) {
  const ::test::GazeSender sender;
  const auto ended = study(real_, session(sender.name(), 0));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_GT(count("slot"), 20);
  EXPECT_EQ(count("gaze"), 0);
  EXPECT_EQ(count("head"), 0);
  EXPECT_EQ(count("presentation WHERE gaze_source = 'head'"), 2);
}

TEST_F(HeadsetTrackerSlow, ASenderThatDiesCutsTheTrialWhichIsShownAgainOnceItIsBack) {
  ::test::GazeSender sender;
  ::test::Listener markers;
  auto arguments = session(sender.name(), 1, {"--markers", "tcp:" + markers.port()});
  arguments.insert(arguments.begin(), bin + "/vip-study");
  test::Process program(arguments, [&] { prepare(simulated(real_)); });
  markers.accept();
  markers.read_until("stimulus_onset");
  sender.gone = true;
  markers.read_until("cut,");
  sender.gone = false;
  markers.read_until("session_end");
  const auto ended = program.wait();
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(count("presentation WHERE state = 'interrupted'"), 1);
  EXPECT_EQ(count("presentation WHERE state = 'played'"), 2);
  EXPECT_THAT(column("SELECT words FROM note"),
              ElementsAre(AllOf(HasSubstr("lost the eyes for over 100 ms: the sender of gaze from "),
                                HasSubstr("is gone: it closed the connection"))));
  EXPECT_THAT(column("SELECT detail FROM event WHERE kind = 'gaze' ORDER BY event_id"),
              ElementsAre(HasSubstr("is gone"), HasSubstr("is back")));
}

TEST_F(HeadsetTrackerSlow, ItIsValidatedAtNineTargets) {
  session("");
  test::replace_in(protocol_, "[[block]]\nkind = \"stimulus\"",
                   "[[block]]\nkind = \"gaze_validation\"\nid = \"look\"\n\n[[block]]\nkind = \"stimulus\"");
  // The eyes look 10 degrees to the left, and a rotation of 10 degrees to the right mends it.
  const ::test::GazeSender sender({.direction = "-0.173648 0 -0.984808"});
  const auto ended = study(real_ + "yaw=30", session(sender.name(), 1, {"--gaze-turn", "-10,0,0"}));
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_EQ(count("gaze_validation WHERE valid > 100"), 9);
  EXPECT_EQ(count("gaze_validation WHERE azimuth_deg = 0 AND elevation_deg = 0 AND accuracy_deg < 0.1"), 1);
  EXPECT_EQ(
      count("gaze_validation WHERE accuracy_deg BETWEEN 9 AND 11 OR accuracy_deg BETWEEN 13.5 AND 14.5"), 8);
  EXPECT_EQ(count("tracker_clock WHERE yaw_deg = -10"), count("tracker_clock"));
}

TEST(GazeCommandE2e, TheExampleOfThePageSendsWhatTheCommandReads) {
  const ::test::TemporaryFolder folder;
  const std::string page = base::read_file(base::find_input("docs/headset.md"), 1 << 20);
  std::smatch block;
  ASSERT_TRUE(std::regex_search(page, block, std::regex("```python\n([^`]*)```")));
  std::string text = block[1];
  const std::string port = ::test::Listener().port();
  ASSERT_NE(text.find("7007"), std::string::npos);
  base::write_file_atomically(folder / "sender.py", text.replace(text.find("7007"), 4, port));
  test::Process sender({"/usr/bin/env", "python3", folder / "sender.py"});
  const std::vector<std::string> arguments{
      std::string(VIP_BIN_DIR) + "/vip-study", "gaze", "--test", "tcp:" + port, "--seconds", "0.3"};
  study::MarkerFile socket;
  const auto addresses = study::look_up_tcp("", port);
  for (int i = 0; i < 200 && !study::connect_tcp(addresses, 1'000'000'000, socket).empty(); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  socket.close();
  const auto ended = test::run_program(arguments);
  ASSERT_EQ(ended.exit_code, 0) << ended.err;
  EXPECT_THAT(ended.out, HasSubstr("tracker     Example sender, from tcp:" + port + "\n"));
  EXPECT_THAT(ended.out, HasSubstr("a second; 100.0 % valid\n"));
  EXPECT_THAT(ended.out, HasSubstr("direction   on average 5.0 degrees right, 0.0 up\n"));
  EXPECT_THAT(ended.out, HasSubstr("refused     0 unreadable, 0 not after"));
}

TEST(GazeCommandE2e, AnLslStreamIsTriedAndASilentSenderIsAnError) {
  const ::test::TemporaryFolder folder;
  const auto try_out = [](const std::string& source) {
    return test::run_program(
        {std::string(VIP_BIN_DIR) + "/vip-study", "gaze", "--test", source, "--seconds", "0.3"});
  };
  {
    const ::test::LslStub stub(folder.path());
    const auto ended = try_out("lsl:eyes");
    ASSERT_EQ(ended.exit_code, 0) << ended.err;
    EXPECT_THAT(ended.out, HasSubstr("tracker     eyes on lab-pc, from lsl:eyes\n"));
    EXPECT_THAT(ended.out, HasSubstr("clock       offset -100.000"));
    EXPECT_THAT(ended.err, HasSubstr("crosses a network without encryption, and gaze is personal data"));
  }
  ::test::GazeSender sender;
  sender.silent = true;
  const auto silent = try_out(sender.name());
  EXPECT_EQ(silent.exit_code, 1) << silent.signal;
  EXPECT_THAT(silent.out, HasSubstr("samples     0 in 0.3 s"));
  EXPECT_THAT(silent.err, HasSubstr("sends no samples"));
  const auto wrong = try_out("mouse");
  EXPECT_EQ(wrong.exit_code, 2);
  EXPECT_THAT(wrong.err, HasSubstr("'mouse' is not tcp:[HOST:]PORT or lsl:NAME"));
}

}  // namespace
}  // namespace apps
