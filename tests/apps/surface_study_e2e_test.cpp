/// A shortened study of protocols/surface.toml, from the bakes of both surfaces to the report.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/shown_study.hpp"

namespace apps::test {
namespace {

using base::Json;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

const std::string plan = base::resource("protocols/plans/surface.toml").string();

class SurfaceStudyE2e : public ShownStudy {
 protected:
  SurfaceStudyE2e() : ShownStudy("surface", "64x36") {
    std::string text = shipped_text("surface");
    for (const auto& [from, to] :
         std::map<std::string, std::string>{{"n_star = \"32k\"", "n_star = \"64\""},
                                            {"duration_s = 8", "duration_s = 0.2"},
                                            {"repetitions = 4", "repetitions = 1"},
                                            {"break_every = 12\nbreak_s = 20\n", ""}})
      text = replaced(text, from, to);
    base::write_file_atomically(protocol_, text);
  }
  fs::path bake_of(const std::string& method, const std::string& surface) const {
    return fs::path(bakes_) / ("single_dam_64_" + method + "_" + surface + ".bake");
  }
  Json read(const fs::path& path) const { return Json::parse(base::read_file(path, 1 << 24)); }
};

TEST_F(SurfaceStudyE2e, ABakeOfOneSurfaceIsNeverShownForTheOther) {
  const Ended baked = bake({"--keep", "pictures"});
  ASSERT_EQ(baked.exit_code, 0) << baked.err;
  for (const char* method : {"HiRes", "Ours"}) {
    std::vector<sim::Bytes> pictures;
    for (const char* surface : {"ellipsoids", "spheres"}) {
      const sim::BakeReader bake(bake_of(method, surface));
      EXPECT_EQ(bake.header().view.surface, surface);
      pictures.push_back(sim::PictureReader(bake).read(5).rgba);
    }
    EXPECT_NE(pictures[0], pictures[1]) << method;
  }
  EXPECT_THAT(bake({"--keep", "pictures"}).out, HasSubstr("single_dam_64_Ours_spheres.bake: whole, kept"));
  ASSERT_EQ(run({"--participants", "1", "--stimulus", bakes_}).exit_code, 0);
  EXPECT_THAT(stimulus(), AllOf(HasSubstr("single_dam 64 HiRes spheres bake "),
                                HasSubstr("faucet 64 Ours ellipsoids bake ")));

  fs::copy_file(bake_of("HiRes", "spheres"), bake_of("HiRes", "ellipsoids"),
                fs::copy_options::overwrite_existing);
  const Ended refused = run({"--participants", "1", "--stimulus", bakes_});
  EXPECT_EQ(refused.exit_code, 1);
  EXPECT_THAT(refused.err,
              HasSubstr("HiRes_ellipsoids.bake: holds pictures of spheres instead of ellipsoids"));
  EXPECT_THAT(bake({"--keep", "pictures"}).out,
              HasSubstr("HiRes_ellipsoids.bake: pictures of spheres instead of ellipsoids; is made again"));
}

TEST_F(SurfaceStudyE2e, ABakeOfASceneRecordsItsSurfaceWherePicturesAreDrawn) {
  const auto one = [&](const std::vector<std::string>& more) {
    std::vector<std::string> all{vip_study,  "bake",      "data/scenes/single_dam.toml",
                                 "--n-star", "64",        "--frames",
                                 "2",        "--backend", "cpu",
                                 "--force",  "--out",     folder_ / "one.bake"};
    all.insert(all.end(), more.begin(), more.end());
    return run_program(all);
  };
  const Ended made = one({"--surface", "spheres", "--pictures", "64x36"});
  ASSERT_EQ(made.exit_code, 0) << made.err;
  EXPECT_THAT(run_program({vip_study, "bake", "--verify", folder_ / "one.bake"}).out,
              HasSubstr("64x36 pictures (view, of spheres)"));
  const Ended nothing = one({"--surface", "spheres"});
  EXPECT_EQ(nothing.exit_code, 1);
  EXPECT_THAT(nothing.err, AllOf(HasSubstr("--surface spheres: has no effect"), HasSubstr("--pictures")));
}

TEST_F(SurfaceStudyE2e, GoesFromTheBundleToTheReport) {
  const Ended checked = run_program({vip_study, "check", protocol_, "--json", folder_ / "check.json"});
  ASSERT_EQ(checked.exit_code, 0) << checked.err;
  EXPECT_THAT(checked.out, HasSubstr("Ours faucet 64 ellipsoids"));
  const Json cells = read(folder_ / "check.json").at("cells");
  ASSERT_EQ(cells.size(), 12u);
  for (const auto& cell : cells) EXPECT_EQ(cell.at("surface"), cell.at("levels").at("surface"));

  const std::string vip_stats = VIP_BIN_DIR "/vip-stats";
  const Ended frozen =
      run_program({vip_stats, "preregister", protocol_, "--plan", plan, "--out", folder_ / "bundle"});
  ASSERT_EQ(frozen.exit_code, 0) << frozen.err;
  EXPECT_THAT(base::read_file(folder_ / "bundle" / "PREREGISTRATION.txt", 1 << 20),
              AllOf(HasSubstr("hires: real, method HiRes, surface ellipsoids against 0.5"),
                    HasSubstr("methods: real, "), Not(HasSubstr("FovFluid"))));

  // Without its own plan, the bundle holds none of the paper's hypotheses.
  const Ended usual = run_program({vip_stats, "preregister", protocol_, "--out", folder_ / "usual"});
  ASSERT_EQ(usual.exit_code, 0) << usual.err;
  EXPECT_THAT(
      base::read_file(folder_ / "usual" / "PREREGISTRATION.txt", 1 << 20),
      HasSubstr("Hypotheses\nNone.\n- Not tested: H1 to H6 of surface: the surface is a factor, and H1 "
                "to H6 are about methods alone"));

  const Ended shown = run({"--participant", "P01", "--seed", "3"});
  ASSERT_EQ(shown.exit_code, 0) << shown.err;
  EXPECT_THAT(shown.err, Not(HasSubstr("test data")));
  EXPECT_THAT(stimulus(), HasSubstr("drawn as ellipsoids, spheres"));
  EXPECT_EQ(count_in(database_, "SELECT count(*) FROM cell WHERE surface = 'spheres'"), 6);
  const Ended ran =
      run_program({vip_study, "run", protocol_, "--db", database_, "--observer", "random", "--seed", "3",
                   "--participant", "P02", "--participant", "P03", "--participant", "P04"});
  ASSERT_EQ(ran.exit_code, 0) << ran.err;

  const Ended told = run_program({vip_stats, "study", database_, "--preregistered", folder_ / "bundle",
                                  "--json", folder_ / "study.json", "--html", folder_ / "study.html"});
  ASSERT_EQ(told.exit_code, 0) << told.err;
  const Json study = read(folder_ / "study.json");
  EXPECT_EQ(study.at("design").at("standard"), (Json{{"surface", "spheres"}}));
  EXPECT_EQ(study.at("design").at("surfaces"),
            (Json{{"ellipsoids", "surface ellipsoids"}, {"spheres", "surface spheres"}}));
  ASSERT_EQ(study.at("hypotheses").size(), 3u);
  for (const auto& one : study.at("hypotheses")) EXPECT_TRUE(one.at("p_adjusted").is_number()) << one.dump();
  EXPECT_EQ(study.at("hypotheses")[0].at("a"), "method HiRes, surface ellipsoids");
  ASSERT_EQ(study.at("descriptives").size(), 1u);
  EXPECT_EQ(study.at("descriptives")[0].at("cells").size(), 6u) << "one for each pair";
  const std::string page =
      std::regex_replace(base::read_file(folder_ / "study.html", 1 << 24), std::regex("<[^>]*>"), "");
  EXPECT_THAT(
      page, AllOf(HasSubstr("the standard, surface spheres, both with the same level of method and scene."),
                  HasSubstr("The particles were drawn as ellipsoids in cells with surface ellipsoids and as "
                            "spheres in cells with surface spheres."),
                  Not(HasSubstr("H1"))));

  const Ended reported = run_program(
      {vip_stats, "report", database_, "--html", folder_ / "r.html", "--json", folder_ / "r.json"});
  ASSERT_EQ(reported.exit_code, 0) << reported.err;
  const Json report = read(folder_ / "r.json");
  EXPECT_EQ(report.at("hypotheses"), Json::array()) << "none of the paper's";
}

}  // namespace
}  // namespace apps::test
