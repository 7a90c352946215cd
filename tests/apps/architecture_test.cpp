/// Dependencies between the libraries and between their folders ("rooms"), from the includes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <functional>
#include <map>
#include <regex>
#include <set>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "stats/base/file.hpp"

namespace {

namespace fs = std::filesystem;

/// One `#include` of the project.
struct Include {
  std::string from;  ///< path from the project's root
  std::string what;  ///< between the brackets
};

std::vector<Include> includes_of(const std::string& from, const std::string& text) {
  static const std::regex pattern(R"(^\s*#\s*include\s*[<"]([^>"]+)[>"])");
  std::vector<Include> found;
  std::istringstream lines(text);
  std::smatch match;
  for (std::string line; std::getline(lines, line);) {
    if (line.find("include") == std::string::npos) continue;
    if (std::regex_search(line, match, pattern)) found.push_back({from, match[1]});
  }
  return found;
}

std::vector<Include> project_includes() {
  const fs::path root = fs::path(VIP_TEST_DIR).parent_path();
  std::vector<Include> all;
  for (const char* folder : {"apps", "libsim", "libstudy", "stats"}) {
    for (const auto& entry : fs::recursive_directory_iterator(root / folder)) {
      const std::string kind = entry.path().extension();
      if (kind != ".cpp" && kind != ".hpp" && kind != ".cu") continue;
      const auto some =
          includes_of(fs::relative(entry.path(), root).string(), base::read_file(entry.path(), 1 << 20));
      all.insert(all.end(), some.begin(), some.end());
    }
  }
  return all;
}

bool begins(const std::string& text, const std::vector<std::string>& starts) {
  for (const std::string& start : starts) {
    if (text.starts_with(start)) return true;
  }
  return false;
}

/// Paths in includes that start with `what` are allowed only in files whose paths start with `allowed_from`.
struct Rule {
  std::vector<std::string> what;
  std::vector<std::string> allowed_from;
};

const std::vector<Rule> rules{
    {{"apps/"}, {"apps/"}},
    {{"apps/bench/"}, {"apps/bench/"}},
    {{"apps/stats/"}, {"apps/stats/"}},
    {{"apps/study/"}, {"apps/study/"}},
    {{"apps/view/"}, {"apps/view/"}},
    // The parts of libstudy that may use libsim. All other parts of libstudy include only
    // display/stimulus.hpp.
    {{"libsim/"},
     {"apps/", "libsim/", "libstudy/analysis/", "libstudy/headset/", "libstudy/pages/window/",
      "libstudy/runner/", "libstudy/stimulus/", "libstudy/sweep/"}},
    {{"libsim/measure/"}, {"apps/", "libsim/measure/", "libstudy/sweep/run/"}},
    {{"libsim/bake/"}, {"apps/", "libsim/", "libstudy/stimulus/"}},
    {{"libsim/render/"},
     {"apps/", "libsim/measure/", "libsim/render/", "libstudy/runner/", "libstudy/stimulus/"}},
    {{"libstudy/"}, {"apps/", "libstudy/"}},
    {{"tests/"}, {}},
    {{"sqlite3"}, {"libstudy/store/"}},
    {{"libpq"}, {"libstudy/store/central/libpq.hpp"}},
    {{"stats/base/"}, {"apps/", "libsim/", "libstudy/", "stats/base/", "stats/figures/"}},
    {{"stats/figures/"}, {"apps/", "libsim/measure/", "libstudy/", "stats/figures/"}},
    {{"toml"}, {"stats/base/toml_parser.hpp"}},
    {{"stats/base/toml_parser"}, {"stats/base/toml.cpp"}},
    {{"gsl/"}, {"stats/"}},
    {{"nlohmann/"}, {"stats/base/json_text.cpp"}},
    {{"CLI/"}, {"apps/"}},
    {{"GLFW/", "backends/imgui_impl_glfw"},
     {"apps/view/window/", "libstudy/pages/window/", "libstudy/window/"}},
    {{"imgui", "backends/imgui"},
     {"apps/view/window/", "libstudy/pages/gui/", "libstudy/pages/headset/", "libstudy/pages/window/"}},
    {{"epoxy/", "GL/", "EGL/"},
     {"apps/", "libsim/gl/", "libsim/measure/", "libsim/render/", "libstudy/headset/", "libstudy/pages/",
      "libstudy/stimulus/", "libstudy/window/"}},
    {{"openxr/"}, {"libstudy/headset/"}},
    {{"cuda", "cub/", "thrust/"}, {"libsim/exec/"}},
};

/// Folders of libstudy that may include parts of libsim, and the only folders of libsim that each may
/// include: displays draw with OpenGL, analyses read settings and fits from files. None of them runs a fluid.
const std::vector<std::pair<std::string, std::vector<std::string>>> parts_of_libsim{
    {"libstudy/analysis/", {"libsim/ptpe/", "libsim/setting/"}},
    {"libstudy/headset/", {"libsim/gl/"}},
    {"libstudy/pages/window/", {"libsim/gl/"}}};

/// A folder of a library. Its files may include their own folder and folders of the same library on lower
/// floors.
struct Room {
  std::string folder;
  int floor;
  /// Folders of the same floor that it may include too; they must come before it in the table, so that there
  /// are no cycles.
  std::vector<std::string> beside = {};
};
using Rooms = std::vector<Room>;

/// Each folder with sources in one of these needs a row in `rooms`.
const std::vector<std::string> libraries{"apps", "libsim", "libstudy", "stats"};

const Rooms rooms{
    {"stats", 0},
    {"stats/base", 0},
    {"stats/figures", 0},
    {"stats/image", 0},
    {"stats/adaptive", 1},
    {"stats/ordinal", 1},
    {"stats/inference", 2},
    {"stats/preference", 3},
    {"stats/ptpe", 3},
    {"stats/analysis", 4},

    {"libsim/exec", 0},
    {"libsim/methods", 0},
    {"libsim/ptpe", 0},
    {"libsim/gl", 1},
    {"libsim/particles", 1},
    {"libsim/scene", 1},
    {"libsim/activation", 2},
    {"libsim/flow", 2},
    {"libsim/impulse", 2},
    {"libsim/neighbors", 2},
    {"libsim/pressure", 2},
    {"libsim/view", 2},
    {"libsim/foam", 3},
    {"libsim/levels", 3},
    {"libsim/saliency", 3},
    {"libsim/surface", 3},
    {"libsim", 4},
    {"libsim/solver/stages", 4},
    {"libsim/bake", 5},
    {"libsim/cases", 5},
    {"libsim/render", 5},
    {"libsim/solver", 5},
    {"libsim/solver/effects/loops", 5},
    {"libsim/setting", 6},
    {"libsim/solver/effects", 6},
    {"libsim/measure", 7},

    {"libstudy/base", 0},
    {"libstudy/store/file", 0},
    {"libstudy/display", 1},
    {"libstudy/store/central", 1},
    {"libstudy/sweep", 1},
    {"libstudy/pacing", 2},
    {"libstudy/sweep/run", 2},
    {"libstudy/light", 3},
    {"libstudy/markers", 3},
    {"libstudy/protocol", 3},
    {"libstudy/design", 4},
    {"libstudy/trackers", 4},
    {"libstudy/store", 5},
    {"libstudy/session", 6},
    {"libstudy/store/import", 6},
    {"libstudy/store/merge", 6},
    {"libstudy/store/read", 6},
    {"libstudy/store/salvage", 6},
    {"libstudy/store/remote", 7},
    {"libstudy/analysis", 7},
    {"libstudy/check", 7},
    {"libstudy/console", 7},
    {"libstudy/observer", 7},
    {"libstudy/pages", 7},
    {"libstudy/store/export", 7},
    {"libstudy/store/push", 7},
    {"libstudy/analysis/ptpe", 8},
    {"libstudy/analysis/rivals", 8},
    {"libstudy/pages/gui", 8},
    {"libstudy/power", 8},
    {"libstudy/stimulus", 8},
    {"libstudy/analysis/tasks", 9},
    {"libstudy/headset", 9},
    {"libstudy/report", 9},
    {"libstudy/stimulus/bakes", 9},
    {"libstudy/pages/headset", 10},
    {"libstudy/preregistration", 10},
    {"libstudy/window", 10},
    {"libstudy/runner", 11},
    {"libstudy/pages/window", 12},

    {"apps/common", 0},
    {"apps/bench", 1},
    {"apps/stats", 1},
    {"apps/study", 1},
    {"apps/view", 1},
    {"apps/bench/accuracy", 2},
    {"apps/view/window", 2},
};

std::string folder_of(const std::string& path) { return fs::path(path).parent_path(); }
std::string library_of(const std::string& path) { return *fs::path(path).begin(); }

/// Reason why files of the folder `from` may not include the folder `what`; empty if they may. Both are rows
/// of the table.
std::string forbidden(const Room& from, const Room& what) {
  if (what.folder == from.folder || what.floor < from.floor) return "";
  if (what.floor > from.floor) return "goes up";
  const bool named = std::find(from.beside.begin(), from.beside.end(), what.folder) != from.beside.end();
  return named ? "" : "goes to another room of its floor";
}

/// Includes inside the libraries that the table does not allow, and folders that are missing in it.
std::vector<std::string> arrows_against(const Rooms& table, const std::vector<Include>& includes) {
  std::set<std::string> missing;
  const auto find = [&](const std::string& folder) {
    const auto row =
        std::find_if(table.begin(), table.end(), [&](const Room& room) { return room.folder == folder; });
    if (row == table.end()) missing.insert(folder);
    return row;
  };
  std::vector<std::string> found;
  for (const Include& include : includes) {
    if (std::count(libraries.begin(), libraries.end(), library_of(include.from)) == 0) continue;
    const auto from = find(folder_of(include.from));
    if (library_of(include.what) != library_of(include.from)) continue;
    const auto what = find(folder_of(include.what));
    if (from == table.end() || what == table.end()) continue;
    const std::string why = forbidden(*from, *what);
    if (!why.empty()) found.push_back(include.from + " includes " + include.what + ", which " + why);
  }
  for (const std::string& folder : missing) {
    found.push_back(folder + " has no floor: add a row to `rooms` in tests/apps/architecture_test.cpp");
  }
  return found;
}

std::vector<std::string> violations(const std::vector<Include>& includes) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    for (const Rule& rule : rules) {
      if (begins(include.what, rule.what) && !begins(include.from, rule.allowed_from)) {
        found.push_back(include.from + " includes " + include.what);
      }
    }
    for (const auto& [room, parts] : parts_of_libsim) {
      if (include.from.starts_with(room) && include.what.starts_with("libsim/") &&
          !begins(include.what, parts))
        found.push_back(include.from + " includes " + include.what);
    }
    if (include.what.starts_with("gsl/") && !include.from.ends_with(".cpp")) {
      found.push_back(include.from + " shows GSL in a header");
    }
  }
  return found;
}

TEST(Architecture, ArrowsPointOneWay) {
  const auto includes = project_includes();
  ASSERT_GT(includes.size(), 500u) << "the sources were not found";
  EXPECT_THAT(violations(includes), ::testing::IsEmpty());
}

TEST(Architecture, EachForbiddenArrowIsSeen) {
  const std::vector<Include> forbidden{{"libstudy/session/a.cpp", "libsim/simulation.hpp"},
                                       {"stats/a.cpp", "libstudy/pacing/pacer.hpp"},
                                       {"libstudy/headset/a.cpp", "libsim/simulation.hpp"},
                                       {"libstudy/analysis/a.cpp", "libsim/gl/png.hpp"},
                                       {"libstudy/sweep/run/a.cpp", "libsim/render/fluid_picture.hpp"},
                                       {"libsim/scene/a.cpp", "libstudy/store/store.hpp"},
                                       {"stats/a.hpp", "gsl/gsl_cdf.h"},
                                       {"libstudy/session/a.cpp", "sqlite3.h"},
                                       {"libstudy/store/store.cpp", "libpq-fe.h"},
                                       {"stats/base/file.cpp", "toml++/toml.h"},
                                       {"libsim/stages/a.cpp", "cuda_runtime.h"},
                                       {"libsim/scene/a.cpp", "apps/common/program.hpp"},
                                       {"stats/a.cpp", "stats/base/file.hpp"},
                                       {"stats/ptpe/a.cpp", "stats/base/error.hpp"},
                                       {"apps/common/a.cpp", "apps/view/choices.hpp"},
                                       {"apps/study/a.cpp", "apps/bench/commands.hpp"},
                                       {"apps/view/a.cpp", "apps/stats/commands.hpp"},
                                       {"apps/bench/a.cpp", "apps/study/commands.hpp"}};
  for (const Include& one : forbidden) {
    EXPECT_EQ(violations(includes_of(one.from, "#include <" + one.what + ">\n")).size(), 1u) << one.from;
  }
}

TEST(Architecture, RoomsIncludeLowerFloorsOnly) {
  EXPECT_THAT(arrows_against(rooms, project_includes()), ::testing::IsEmpty());
}

TEST(Architecture, RoomsHaveOneRowEachAndNoneGoRound) {
  std::map<std::string, int> floors;  // floors of the rows so far, by folder
  for (const Room& room : rooms) {
    for (const std::string& other : room.beside) {
      ASSERT_TRUE(floors.contains(other)) << room.folder << " goes to " << other << ", which stands below";
      EXPECT_EQ(floors.at(other), room.floor) << room.folder << " goes to " << other << ", of another floor";
    }
    EXPECT_TRUE(floors.emplace(room.folder, room.floor).second) << room.folder << " stands there twice";
    EXPECT_TRUE(fs::is_directory(fs::path(VIP_TEST_DIR).parent_path() / room.folder)) << room.folder;
  }
}

TEST(Architecture, EachArrowAgainstTheFloorsIsSeen) {
  const Rooms house{{"stats/cellar", 0},
                    {"stats", 1},
                    {"stats/left", 2},
                    {"stats/right", 2, {"stats/left"}},
                    {"stats/roof", 3}};
  const auto arrow = [&](const std::string& from, const std::string& what) {
    return arrows_against(house, includes_of(from + "/a.cpp", "#include \"" + what + "/b.hpp\"\n"));
  };
  using ::testing::ElementsAre;
  using ::testing::HasSubstr;
  EXPECT_THAT(arrow("stats/cellar", "stats/roof"), ElementsAre(HasSubstr("stats/roof/b.hpp, which goes up")));
  EXPECT_THAT(arrow("stats/cellar", "stats"), ElementsAre(HasSubstr("stats/b.hpp, which goes up")));
  EXPECT_THAT(arrow("stats", "stats/left"), ElementsAre(HasSubstr("goes up")));
  EXPECT_THAT(arrow("stats/left", "stats/right"), ElementsAre(HasSubstr("another room of its floor")));
  const std::string mend = " has no floor: add a row to `rooms` in tests/apps/architecture_test.cpp";
  EXPECT_THAT(arrow("stats/shed", "stats/cellar"), ElementsAre("stats/shed" + mend));
  EXPECT_THAT(arrow("stats/shed", "gsl"), ElementsAre("stats/shed" + mend));
  EXPECT_THAT(arrow("stats/roof", "stats/left/cupboard"), ElementsAre("stats/left/cupboard" + mend));

  for (const auto& [from, what] :
       std::vector<std::pair<std::string, std::string>>{{"stats/right", "stats/left"},
                                                        {"stats/roof", "stats"},
                                                        {"stats/left", "stats/left"},
                                                        {"stats", "gsl"},
                                                        {"stats/left", "libsim/render"}}) {
    EXPECT_THAT(arrow(from, what), ::testing::IsEmpty()) << from << " to " << what;
  }
}

}  // namespace
