/// The arrows between the libraries, as the includes draw them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <functional>
#include <regex>
#include <sstream>
#include <string>
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

/// Who may include what begins like this.
struct Rule {
  std::vector<std::string> what;
  std::vector<std::string> allowed_from;
};

const std::vector<Rule> rules{
    {{"apps/"}, {"apps/"}},
    {{"libsim/"}, {"apps/", "libsim/"}},
    {{"libstudy/"}, {"apps/", "libstudy/"}},
    {{"tests/"}, {}},
    {{"sqlite3"}, {"libstudy/store/"}},
    {{"toml"}, {"stats/base/toml_parser.hpp"}},
    {{"stats/base/toml_parser", "stats/base/toml_state"}, {"stats/base/toml.cpp", "stats/base/toml_state"}},
    {{"gsl/"}, {"stats/"}},
    {{"nlohmann/"}, {"apps/", "libstudy/store/"}},
    {{"CLI/"}, {"apps/"}},
    {{"GLFW/", "imgui", "backends/imgui"},
     {"apps/common/window/", "apps/view/window/", "apps/study/window/"}},
    {{"epoxy/", "GL/", "EGL/"}, {"apps/", "libsim/render/"}},
    {{"cuda", "cub/", "thrust/"}, {"libsim/exec/"}},
};

std::vector<std::string> violations(const std::vector<Include>& includes) {
  std::vector<std::string> found;
  for (const Include& include : includes) {
    for (const Rule& rule : rules) {
      if (begins(include.what, rule.what) && !begins(include.from, rule.allowed_from)) {
        found.push_back(include.from + " includes " + include.what);
      }
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
                                       {"libsim/scene/a.cpp", "libstudy/store/store.hpp"},
                                       {"stats/a.hpp", "gsl/gsl_cdf.h"},
                                       {"libstudy/session/a.cpp", "sqlite3.h"},
                                       {"stats/base/file.cpp", "toml++/toml.h"},
                                       {"libsim/stages/a.cpp", "cuda_runtime.h"},
                                       {"libsim/scene/a.cpp", "apps/common/program.hpp"}};
  for (const Include& one : forbidden) {
    EXPECT_EQ(violations(includes_of(one.from, "#include <" + one.what + ">\n")).size(), 1u) << one.from;
  }
}

}  // namespace
