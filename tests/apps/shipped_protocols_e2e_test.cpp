/// Each shipped protocol from check to report: each number of the page is in the JSON, and each session is in
/// a flow of participants.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <ostream>
#include <set>
#include <string>
#include <vector>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/apps/report_walk.hpp"
#include "tests/common/temporary_folder.hpp"

namespace apps::test {
namespace {

using report_walk::Json;
using ::testing::IsEmpty;

const std::filesystem::path protocols = std::filesystem::path(VIP_TEST_DIR).parent_path() / "protocols";

/// Four people for a study with a plan, two for each level of its between-subject factor; three for other
/// studies.
int people_of(const std::string& protocol) {
  return std::filesystem::exists(protocols / "plans" / (protocol + ".toml")) ? 4 : 3;
}

struct Walk {
  std::string protocol, observer;
};

/// Part of the test's name that differs between Walks.
std::string name_of(const Walk& walk) {
  return walk.protocol + (walk.observer == "random" ? "_left_out" : "");
}
void PrintTo(const Walk& walk, std::ostream* out) { *out << name_of(walk); }

/// Each protocol with an observer whose answers count. One protocol also with an observer all of whose
/// answers the rules exclude.
std::vector<Walk> walks() {
  std::vector<Walk> out{{"task2_lab", "random"}};
  for (const auto& entry : std::filesystem::directory_iterator(protocols)) {
    const std::string name = entry.path().stem();
    if (entry.path().extension() != ".toml") continue;
    const bool detects = name.starts_with("hitch") || name.starts_with("trace");
    out.push_back({name, name.starts_with("task1")   ? "frames"
                         : name.starts_with("trace") ? "detect:latency_ms,threshold=60"
                         : detects                   ? "detect:hitch_ms,threshold=80,spread=0.2"
                         : name == "foam_worth"      ? "ptpe:a=65,b=0.02,effects=1"
                                                     : "ptpe:a=24,b=0.02"});
  }
  std::sort(out.begin() + 1, out.end(), [](const Walk& a, const Walk& b) { return a.protocol < b.protocol; });
  return out;
}

/// The results of a study with factors by its shipped plan: every declared test has its figures, and what the
/// plan does not declare is called exploratory.
void expect_study(const std::string& protocol, const std::string& database,
                  const std::filesystem::path& folder) {
  const auto plan = protocols / "plans" / (protocol + ".toml");
  if (!std::filesystem::exists(plan)) return;
  const Ended ended =
      run_shell(VIP_BIN_DIR "/vip-stats study " + database + " --plan " + plan.string() + " --json " +
                (folder / "study.json").string() + " --html " + (folder / "study.html").string());
  ASSERT_EQ(ended.exit_code, 0) << ended.out;
  const Json json = Json::parse(base::read_file(folder / "study.json", 1 << 24));
  ASSERT_FALSE(json.at("hypotheses").empty());
  for (const auto& one : json.at("hypotheses")) {
    EXPECT_FALSE(one.at("estimate").is_null()) << one.dump();
    EXPECT_TRUE(one.at("p_adjusted").is_number()) << one.dump();
  }
  EXPECT_FALSE(json.at("descriptives").empty());
  EXPECT_EQ(json.at("participants").size(), static_cast<std::size_t>(people_of(protocol)));
}

class ShippedProtocolsE2e : public ::testing::TestWithParam<Walk> {};

TEST_P(ShippedProtocolsE2e, GoFromCheckToReport) {
  const int people = people_of(GetParam().protocol);
  const ::test::TemporaryFolder folder;
  const std::string protocol = protocols / (GetParam().protocol + ".toml"), database = folder / "s.db";
  const auto typed = [](const std::string& line) {
    const Ended ended = run_shell(VIP_BIN_DIR "/" + line);
    EXPECT_EQ(ended.exit_code, 0) << ended.out;
  };
  // The check of a pilot takes long because of its many schedules. It is left to the test that runs the
  // commands of docs/statistics.md, one of which is this check.
  if (!GetParam().protocol.starts_with("ptpe_pilot")) typed("vip-study check " + protocol);
  // With this seed the rules exclude each of those who answer at random; with others they miss one.
  const std::string seed = GetParam().observer == "random" ? "4" : "2";
  typed("vip-study run " + protocol + " --db " + database + " --observer " + GetParam().observer +
        " --seed " + seed + " --participants " + std::to_string(people));
  typed("vip-stats report " + database + " --html " + (folder / "r.html").string() + " --json " +
        (folder / "r.json").string());
  const Json json = Json::parse(base::read_file(folder / "r.json", 1 << 24));
  const auto page = html_reader::read(base::read_file(folder / "r.html", 1 << 24));
  EXPECT_THAT(report_walk::wrong_fields(page, json), IsEmpty());
  EXPECT_THAT(report_walk::unmarked_numbers(page, json), IsEmpty());
  EXPECT_EQ(report_walk::sessions_in_flows(json), people);
  EXPECT_EQ(json.at("roster").at("participants"), people);
  EXPECT_EQ(json.at("roster").at("protocols").at(0).at("simulated"), people);
  const bool counts = GetParam().observer != "random";
  EXPECT_EQ(json.at("study").at("simulated"), people) << "whether or not an answer counts";
  std::set<std::string> described;
  for (const Json* document : report_walk::documents(json)) {
    EXPECT_FALSE(document->at("timing").empty());
    for (const auto& question : document->at("descriptives")) {
      EXPECT_TRUE(described.insert(question.at("question")).second) << "described twice";
      EXPECT_EQ(question.at("cells").empty(), !counts) << question.at("question");
    }
  }
  const bool own_factors = study::read_protocol(protocol).format == 3;
  EXPECT_EQ(described.empty(), own_factors) << "vip-stats study describes the cells of a study with factors";
  EXPECT_EQ(own_factors, json.dump().find("vip-stats study analyses it") != std::string::npos);
  expect_study(GetParam().protocol, database, folder.path());
}

INSTANTIATE_TEST_SUITE_P(Of, ShippedProtocolsE2e, ::testing::ValuesIn(walks()),
                         [](const auto& one) { return name_of(one.param); });

}  // namespace
}  // namespace apps::test
