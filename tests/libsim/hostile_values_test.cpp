/// Any value of any key of a scene or of the solver's file: either it is accepted and all steps up to the
/// allocation of memory work, or an error gives its place and the remedy.

#include <gtest/gtest.h>

#include <filesystem>

#include "libsim/ptpe/ptpe_file.hpp"
#include "libsim/scene/extent.hpp"
#include "libsim/scene/fill.hpp"
#include "libsim/scene/gaze.hpp"
#include "stats/base/file.hpp"
#include "tests/common/hostile_values.hpp"

namespace {

namespace fs = std::filesystem;

std::vector<test::SoundText> texts_in(const fs::path& folder) {
  std::vector<test::SoundText> out;
  for (const auto& file : fs::directory_iterator(folder))
    out.push_back({file.path().filename().string(), base::read_file(file.path(), 1 << 20)});
  return out;
}

TEST(HostileValues, OfAnyKeyOfASceneAreTakenOrRefusedWithPlaceAndMend) {
  const auto names = test::try_hostile_values(
      texts_in(base::resource("data/scenes")),
      [](const std::string& text) {
        return sim::parse_scene(text, test::hostile_name, base::resource("data/scenes"));
      },
      [](const sim::Scene& scene) {
        const auto method = sim::MethodKind::HiRes;
        sim::substeps_of(scene, 64);
        sim::check_extent(scene, method, 64, 4 * sim::resolution_of(scene, method, 64).spacing_m);
        sim::fill_positions(scene, method, 64);
        sim::gaze_point(scene, 100);
      });
  for (const char* key : {"format", "name", "size_m", "max_m", "gate", "v_ref_m_s", "diameter_m", "corner_m",
                          "eye_m", "near_m", "frame", "checkpoints"})
    EXPECT_TRUE(names.contains(key)) << key;
}

TEST(HostileValues, OfAnyKeyOfASolversFileAreTakenOrRefusedWithPlaceAndMend) {
  const auto good = fs::path(VIP_TEST_DIR) / "fuzz/corpus/ptpe/good.toml";
  const auto names = test::try_hostile_values(
      {{"good.toml", base::read_file(good, 1 << 20)}},
      [](const std::string& text) { return sim::parse_ptpe_file(text, test::hostile_name); },
      [](const sim::PtpeFile& file) { sim::parse_ptpe_file(sim::format_ptpe_file(file), "again"); });
  EXPECT_TRUE(names.contains("a_fps"));
  EXPECT_TRUE(names.contains("date_utc"));
}

}  // namespace
