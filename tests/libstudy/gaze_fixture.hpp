#pragma once
/// A study with gaze of two people, for tests: samples of an eye tracker for one, of the mouse for the other.

#include "tests/libstudy/permission_fixture.hpp"

namespace study::test {

/// The screen is 520 mm wide, seen from 600 mm.
inline std::filesystem::path make_gaze_study(const TemporaryFolder& folder) {
  const std::filesystem::path path = folder / "gaze.db";
  Store store(path, sqlite::Open::Create);
  add_people(store, asking_protocol(), {{"P01", 1, 1}, {"P02", 1, 1}});
  const std::vector<GazeSample> looked{{1'000'000, 7, true, GazePoint{0.25, 0.75}},
                                       {6'000'000, 12, false, {}},
                                       {11'000'000, 17, true, GazePoint{0.5, 0.5}}};
  store.add_gaze(1, 0, GazeOrigin::Tracker, looked);
  store.add_gaze(2, 0, GazeOrigin::Mouse, looked);
  sqlite::Connection(path, sqlite::Open::Write)
      .execute(
          "UPDATE session SET display = 'window 1920x1080', screen_width_mm = 520, viewing_distance_mm = "
          "600");
  return path;
}

}  // namespace study::test
