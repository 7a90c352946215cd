#include "libsim/bake/bake_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <sys/wait.h>

#include <algorithm>
#include <csignal>
#include <functional>

#include "libsim/bake/layout.hpp"
#include "stats/base/file.hpp"
#include "tests/libsim/bake/make_bake.hpp"

namespace {

using bake_test::error_of;
using bake_test::Folder;
using ::testing::AllOf;
using ::testing::HasSubstr;

void read_everything(const sim::BakeReader& bake) {
  sim::BakeFrame frame;
  sim::PictureReader pictures(bake);
  for (std::int64_t i = 0; i < bake.header().frame_count; ++i) {
    bake.read_frame(i, frame);
    if (bake.header().has_pictures()) pictures.read(i);
  }
}

TEST(BakeFile, HeaderComesBackAsWritten) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 3, 32, 18);
  const sim::BakeReader bake(folder / "a.bake");
  const sim::BakeHeader want = bake_test::header(3, 32, 18);
  EXPECT_EQ(sim::format_bake_header(bake.header()), sim::format_bake_header(want));
  EXPECT_EQ(bake.file_bytes(), std::filesystem::file_size(folder / "a.bake"));
  EXPECT_EQ(bake.content_hash().size(), 16U);
}

TEST(BakeFile, ParticlesComeBackWithinTheQuantisationErrorInOrder) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 4);
  const sim::BakeReader bake(folder / "a.bake");
  sim::BakeFrame frame;
  for (const std::int64_t i : {3, 0, 2, 1}) {
    bake.read_frame(i, frame);
    auto want = bake_test::particles(i);
    std::stable_sort(want.begin(), want.end(),
                     [](const auto& a, const auto& b) { return a.radius_m < b.radius_m; });
    ASSERT_EQ(frame.particles.size(), want.size());
    EXPECT_THAT(frame.facts.account.particles_by_level, ::testing::ElementsAre(768, 192));
    EXPECT_DOUBLE_EQ(frame.facts.time_s, static_cast<double>(i) / 60);
    // The widest axis spans at most 19.6 m. A place may be off by half a step of 16 bits and by the rounding
    // of a float at 20 m.
    const double bound = 19.6 / 131070 + 4e-6;
    ASSERT_LT(bound, 0.05 / 20);
    for (std::size_t p = 0; p < want.size(); ++p) {
      ASSERT_NEAR(frame.particles[p].x_m, want[p].x_m, bound);
      ASSERT_NEAR(frame.particles[p].y_m, want[p].y_m, bound);
      ASSERT_NEAR(frame.particles[p].z_m, want[p].z_m, bound);
      ASSERT_EQ(frame.particles[p].radius_m, want[p].radius_m);
    }
  }
}

void expect_account(const sim::FrameAccount& found, std::int64_t frame) {
  SCOPED_TRACE(frame);
  const sim::FrameAccount want = bake_test::account(frame);
  EXPECT_THAT(found.particles_by_level, ::testing::ElementsAre(768, 192));
  ASSERT_EQ(found.temporal.has_value(), want.temporal.has_value());
  ASSERT_EQ(found.guards.has_value(), want.guards.has_value());
  if (!want.temporal) return;
  EXPECT_EQ(found.temporal->tau, want.temporal->tau);
  EXPECT_EQ(found.temporal->rate, want.temporal->rate);
  EXPECT_EQ(found.temporal->beta, want.temporal->beta);
  EXPECT_EQ(found.temporal->active, want.temporal->active);
  EXPECT_EQ(found.guards->coincident_pairs, want.guards->coincident_pairs);
  EXPECT_EQ(found.guards->nozzle_waited, want.guards->nozzle_waited);
  EXPECT_EQ(found.guards->gaze_lost, want.guards->gaze_lost);
}

TEST(BakeFile, EveryFrameAndPictureKeepsTheSolversAccount) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 7, 32, 18);
  const sim::BakeReader bake(folder / "a.bake");
  sim::PictureReader pictures(bake);
  sim::BakeFrame frame;
  for (std::int64_t i = 0; i < 7; ++i) {
    bake.read_frame(i, frame);
    expect_account(frame.facts.account, i);
    expect_account(pictures.read(i).facts.account, i);
  }
}

/// The file was written by version 0.1.0.
TEST(BakeFile, Format1IsReadAndMeasuredNothingButCounts) {
  const sim::BakeReader bake(base::resource("tests/libsim/bake/fixtures/format_1.bake"));
  ASSERT_TRUE(bake.header().has_pictures());
  sim::PictureReader pictures(bake);
  sim::BakeFrame frame;
  for (std::int64_t i = 0; i < bake.header().frame_count; ++i) {
    bake.read_frame(i, frame);
    EXPECT_EQ(frame.facts.account.particles(), static_cast<std::int64_t>(frame.particles.size()));
    EXPECT_FALSE(frame.facts.account.temporal || frame.facts.account.guards);
    const sim::BakeFacts& facts = pictures.read(i).facts;
    EXPECT_EQ(facts.account.particles_by_level, frame.facts.account.particles_by_level);
    EXPECT_FALSE(facts.account.temporal || facts.account.guards);
  }
}

/// The file was written by the version before format 3: Ours-TSp, three frames.
TEST(BakeFile, Format2IsReadAndDoesNotSayHowItWasWatched) {
  const sim::BakeReader bake(base::resource("tests/libsim/bake/fixtures/format_2.bake"));
  EXPECT_EQ(bake.header().method, "Ours-TSp");
  EXPECT_TRUE(bake.header().view.gaze.empty());
  EXPECT_FALSE(bake.header().view.drawn() || bake.header().tolerance);
  sim::BakeFrame frame;
  bake.read_frame(2, frame);
  EXPECT_TRUE(frame.facts.account.temporal && frame.facts.account.guards);
}

TEST(BakeFile, HeadersThatCannotBeAreRefused) {
  const auto error_with = [](const auto& change) {
    sim::BakeHeader header = bake_test::header(3, 32, 18);
    change(header);
    return error_of(
        [&] { sim::parse_bake_header(sim::format_bake_header(header), sim::format_of(header), "f"); });
  };
  using Header = sim::BakeHeader;
  EXPECT_EQ(error_with([](Header&) {}), "");
  EXPECT_THAT(error_with([](Header& h) { h.view.width_px = -1; }), HasSubstr("size of the drawn picture"));
  EXPECT_THAT(error_with([](Header& h) { h.view.camera_angle_deg = 180; }), HasSubstr("camera's angle"));
  EXPECT_THAT(error_with([](Header& h) { h.view.visual_angle_deg = NAN; }), HasSubstr("eye's view"));
  EXPECT_THAT(error_with([](Header& h) { h.view.gaze_path[1].frame = -1; }), HasSubstr("gaze"));
  EXPECT_THAT(error_with([](Header& h) { h.view.gaze_path.resize(2000); }), HasSubstr("2000 gaze keys"));
  EXPECT_THAT(error_with([](Header& h) { h.tolerance->model.b = NAN; }), HasSubstr("b of the PTPE model"));
  EXPECT_THAT(error_with([](Header& h) { h.max_foam = -1; }), HasSubstr("number of foam particles"));
  EXPECT_THAT(error_with([](Header& h) { h.effects = std::string(70000, ' '); }),
              HasSubstr("70000 characters"));
  EXPECT_EQ(error_with([](Header& h) { h.reference_k = 293.15; }), "");
  EXPECT_THAT(error_with([](Header& h) { h.reference_k = -1; }), HasSubstr("reference temperature"));
  EXPECT_THAT(error_with([](Header& h) { h.overlay = "temperature"; }), HasSubstr("overlay"));
}

TEST(BakeFile, AccountsThatCannotBeAreRefused) {
  const auto error_with = [](const auto& change) {
    sim::BakeFacts facts{0, {{10}, sim::TemporalReport{-6.0, {}, 0.5, 4}, sim::GuardCounts{}}};
    change(facts.account);
    sim::Bytes bytes;
    sim::ByteWriter out(bytes);
    sim::put_facts(out, facts);
    sim::ByteReader in(bytes, "f");
    return error_of([&] { sim::get_facts(in, sim::bake_format, 1); });
  };
  using Account = sim::FrameAccount;
  EXPECT_EQ(error_with([](Account&) {}), "");
  EXPECT_THAT(error_with([](Account& a) { a.temporal->tau = NAN; }), HasSubstr("not finite"));
  EXPECT_THAT(error_with([](Account& a) { a.temporal->beta = 1.5; }), HasSubstr("outside 0 to 1"));
  EXPECT_THAT(error_with([](Account& a) { a.temporal->active = 11; }), HasSubstr("particles were solved"));
  EXPECT_THAT(error_with([](Account& a) { a.guards->gaze_lost = UINT64_MAX; }),
              HasSubstr("impossible number of guard cases"));
}

TEST(BakeFile, EndsOfTheBoxAreKeptExactly) {
  const Folder folder;
  sim::BakeWriter writer(folder / "a.bake", bake_test::header(1));
  writer.add_frame(0, {{-1.25F, 0, 0, 0.05F}, {7.5F, 0, 0, 0.05F}}, {});
  writer.finish();
  sim::BakeFrame frame;
  sim::BakeReader(folder / "a.bake").read_frame(0, frame);
  EXPECT_EQ(frame.particles[0].x_m, -1.25F);
  EXPECT_NEAR(frame.particles[1].x_m, 7.5F, 1e-6);
  EXPECT_EQ(frame.particles[1].y_m, 0);
}

TEST(BakeFile, FrameWithoutParticles) {
  const Folder folder;
  sim::BakeWriter writer(folder / "a.bake", bake_test::header(2));
  writer.add_frame(0, {}, {});
  writer.add_frame(1, {{1, 2, 3, 0.1F}}, {});
  writer.finish();
  const sim::BakeReader bake(folder / "a.bake");
  sim::BakeFrame frame;
  bake.read_frame(0, frame);
  EXPECT_TRUE(frame.particles.empty());
  EXPECT_THAT(frame.facts.account.particles_by_level, ::testing::ElementsAre(0, 0));
  bake.read_frame(1, frame);
  ASSERT_EQ(frame.particles.size(), 1U);
  EXPECT_EQ(frame.particles[0].z_m, 3);
}

TEST(BakeFile, PicturesComeBackExactlyInAnyOrder) {
  const Folder folder;
  const int frames = 2 * static_cast<int>(sim::bake::key_interval) + 5;
  bake_test::write(folder / "a.bake", frames, 34, 18);
  const sim::BakeReader bake(folder / "a.bake");
  sim::PictureReader pictures(bake);
  for (int i = 0; i < frames; ++i) ASSERT_EQ(pictures.read(i).rgba, bake_test::picture(i, 34, 18)) << i;
  for (const int i : {0, 40, 41, 5, 5, 64, 29, 30}) {
    ASSERT_EQ(pictures.read(i).rgba, bake_test::picture(i, 34, 18)) << i;
    ASSERT_DOUBLE_EQ(pictures.read(i).facts.time_s, i / 60.0);
    ASSERT_THAT(pictures.read(i).facts.account.particles_by_level, ::testing::ElementsAre(768, 192));
  }
}

TEST(BakeFile, PicturesOfPureNoiseAndOfOneColourComeBack) {
  std::mt19937 random(3);
  for (const bool noise : {true, false}) {
    sim::Bytes rgba(4 * 40 * 30, 200), before(rgba.size(), 10), payload, scratch;
    for (std::size_t i = 0; i < rgba.size(); ++i) {
      if (noise) rgba[i] = static_cast<std::uint8_t>(random());
      if (i % 4 == 3) rgba[i] = 255;
    }
    for (const sim::ByteSpan previous : {sim::ByteSpan(), sim::ByteSpan(before)}) {
      sim::encode_picture({0, {{1}, {}, {}}}, rgba, previous, 40, 30, 3, payload);
      sim::BakePicture out;
      sim::decode_picture(payload, sim::bake_format, 1, previous, 40, 30, "p", scratch, out);
      EXPECT_EQ(out.rgba, rgba);
    }
  }
}

TEST(BakeFile, EqualContentGivesEqualBytesAndHash) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 3, 32, 18);
  bake_test::write(folder / "b.bake", 3, 32, 18);
  bake_test::write(folder / "c.bake", 4, 32, 18);
  EXPECT_EQ(bake_test::read_all(folder / "a.bake"), bake_test::read_all(folder / "b.bake"));
  EXPECT_NE(sim::BakeReader(folder / "a.bake").content_hash(),
            sim::BakeReader(folder / "c.bake").content_hash());
}

TEST(BakeFile, EveryTruncationIsRefusedByName) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 3, 32, 18);
  const sim::Bytes bytes = bake_test::read_all(folder / "a.bake");
  for (std::size_t size = 0; size < bytes.size(); size += size < 400 ? 1 : 37) {
    const sim::Bytes cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    const std::string error = error_of([&] { const sim::BakeReader bake(cut, "cut.bake"); });
    ASSERT_THAT(error, AllOf(HasSubstr("cut.bake"), HasSubstr(size ? "truncated" : "not a bake"))) << size;
  }
}

TEST(BakeFile, EveryFlippedBitIsFound) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 2, 16, 9);
  sim::Bytes bytes = bake_test::read_all(folder / "a.bake");
  for (std::size_t at = 0; at < bytes.size(); at += at % 97 ? 1 : 5) {
    // The content hash in the footer identifies the content; no check covers its own bytes.
    const std::size_t from_end = bytes.size() - at;
    if (from_end <= 16 && from_end > 8) continue;
    bytes[at] ^= static_cast<std::uint8_t>(1U << at % 8);
    const std::string error = error_of([&] { read_everything(sim::BakeReader(bytes, "flipped.bake")); });
    ASSERT_THAT(error, HasSubstr("flipped.bake")) << "byte " << at;
    bytes[at] ^= static_cast<std::uint8_t>(1U << at % 8);
  }
  EXPECT_EQ(error_of([&] { read_everything(sim::BakeReader(bytes, "whole.bake")); }), "");
}

TEST(BakeFile, DamagedFrameIsNamedAndOthersStayReadable) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 2);
  sim::Bytes bytes = bake_test::read_all(folder / "a.bake");
  const std::size_t in_last = bytes.size() - sim::bake::footer_bytes - 2 * sim::bake::entry_bytes - 10;
  bytes[in_last] ^= 1;
  const sim::BakeReader bake(bytes, "x.bake");
  sim::BakeFrame frame;
  EXPECT_EQ(error_of([&] { bake.read_frame(0, frame); }), "");
  EXPECT_THAT(error_of([&] { bake.read_frame(1, frame); }), HasSubstr("x.bake: frame 1: does not match"));
  EXPECT_THAT(error_of([&] { bake.read_frame(2, frame); }), HasSubstr("has no frame 2"));
}

TEST(BakeFile, NewerVersionIsRefused) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 1);
  sim::Bytes bytes = bake_test::read_all(folder / "a.bake");
  bytes[8] = sim::bake_format + 1;
  EXPECT_THAT(error_of([&] { const sim::BakeReader bake(bytes, "new.bake"); }),
              AllOf(HasSubstr("new.bake"), HasSubstr("format " + std::to_string(sim::bake_format + 1)),
                    HasSubstr("newer program")));
}

TEST(BakeFile, LyingCountsAreRefusedBeforeMemoryIsTaken) {
  const std::vector<float> radii{0.05F};
  sim::Bytes payload, scratch;
  sim::ByteWriter out(payload);
  sim::put_facts(out, {0, {{sim::max_bake_particles}, {}, {}}});
  for (int i = 0; i < 6; ++i) out.put(float(i % 2));
  sim::pack(sim::Bytes(600), 1, payload);
  sim::BakeFrame frame;
  const auto decode = [&](std::int64_t most) {
    return error_of([&] { sim::decode_particles(payload, {4, radii, most, false}, "f", scratch, frame); });
  };
  EXPECT_THAT(decode(1000), HasSubstr("states 33554432 particles"));
  EXPECT_THAT(decode(sim::max_bake_particles), HasSubstr("more data than its bytes can hold"));
  EXPECT_LT(scratch.capacity() + frame.particles.capacity(), 1000U);
}

TEST(BakeFile, WriterRefusesWhatItCannotKeep) {
  const Folder folder;
  sim::BakeWriter writer(folder / "a.bake", bake_test::header(9));
  const auto add = [&](const std::vector<sim::RenderParticle>& particles) {
    return error_of([&] { writer.add_frame(0, particles, {}); });
  };
  EXPECT_THAT(add({{NAN, 0, 0, 0.05F}}), HasSubstr("not finite"));
  EXPECT_THAT(add({{0, 0, 0, 0.07F}}), HasSubstr("not among the header's radii"));
  // A step of 16 bit over 400 m is 6 mm: more than 0.05 / 20 m on each side.
  EXPECT_THAT(add({{0, 0, 0, 0.05F}, {400, 0, 0, 0.05F}}), HasSubstr("spread over 400 m"));
  EXPECT_EQ(add({{0, 0, 0, 0.05F}, {300, 0, 0, 0.05F}}), "");
}

TEST(BakeFile, UnfinishedWriterLeavesNothing) {
  const Folder folder;
  {
    sim::BakeWriter writer(folder / "a.bake", bake_test::header(2));
    writer.add_frame(0, bake_test::particles(0), {});
    EXPECT_THROW(writer.finish(), std::logic_error);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(BakeFile, ExistingFileStaysUnlessOverwritten) {
  const Folder folder;
  bake_test::write(folder / "a.bake", 1);
  const sim::Bytes before = bake_test::read_all(folder / "a.bake");
  EXPECT_THAT(error_of([&] { const sim::BakeWriter w(folder / "a.bake", bake_test::header(2)); }),
              HasSubstr("exists already"));
  EXPECT_EQ(bake_test::read_all(folder / "a.bake"), before);
  bake_test::write(folder / "a.bake", 2);
  EXPECT_EQ(sim::BakeReader(folder / "a.bake").header().frame_count, 2);
}

TEST(BakeFile, PlaceThatCannotBeIsNamed) {
  const Folder folder;
  bake_test::write(folder / "no", 1);
  EXPECT_THAT(error_of([&] { const sim::BakeWriter w(folder / "no/a.bake", bake_test::header(1)); }),
              HasSubstr(folder / "no"));
  EXPECT_THAT(error_of([&] { const sim::BakeReader r(folder / "a.bake"); }), HasSubstr("cannot be read"));
}

TEST(BakeFile, FullDiskIsOneErrorAndLeavesNothing) {
  const Folder folder;
  // In a child process, because the limit on file sizes applies to the whole process.
  const pid_t child = fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{5000, 5000};
    setrlimit(RLIMIT_FSIZE, &limit);
    const std::string error = error_of([&] { bake_test::write(folder / "a.bake", 20); });
    _exit(error.find("a.bake: cannot be written") != std::string::npos ? 0 : 1);
  }
  int status = -1;
  ASSERT_EQ(waitpid(child, &status, 0), child);
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

}  // namespace
