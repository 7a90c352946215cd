/// The page of a study's results: its numbers, its reach, its structure.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/stats/report/page.hpp"
#include "apps/stats/tasks/results.hpp"
#include "apps/stats/tasks/sickness_json.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/simulated_pilot.hpp"

namespace apps {
namespace {

using OrderedJson = nlohmann::ordered_json;

const OrderedJson& example() {
  static const auto json =
      OrderedJson::parse(base::read_file(std::string(VIP_TEST_DIR) + "/apps/results_example.json", 1 << 24));
  return json;
}

/// Both tasks as the program computes them, and a pilot.
const OrderedJson& made() {
  static const OrderedJson json = [] {
    PlanInForce plan;
    plan.plan.resamples = 200;
    const auto pilot = testing_pilot::simulated_pilot("ptpe:a=24,b=0.02", 16, 7);
    auto out =
        make_results({{pilot, made_study::task1(26), made_study::task2(26)}, 1},
                     {"folder/study.db", {TaskKind::Pilot, TaskKind::Task1, TaskKind::Task2}, "", plan})
            .json;
    out["sickness"] = sickness_json(made_study::sickness(26), plan.plan);
    return out;
  }();
  return json;
}

/// Without printing the whole page where it does not.
bool holds(const std::string& html, const std::string& words) {
  return html.find(words) != std::string::npos;
}

html_reader::Page page_of(const OrderedJson& json) { return html_reader::read(report::results_page(json)); }

/// Digits behind the point.
int decimals(const std::string& text) {
  const auto point = text.find('.');
  if (point == std::string::npos) return 0;
  int n = 0;
  for (auto i = point + 1; i < text.size() && std::isdigit(static_cast<unsigned char>(text[i]));) ++i, ++n;
  return n;
}

/// Whether what is printed is the value, rounded to the digits printed.
bool says(std::string text, const OrderedJson& value, bool percent) {
  if (value.is_boolean()) return text == (value.get<bool>() ? "yes" : "no");
  if (value.is_string()) {
    const auto word = value.get<std::string>();
    return text == word || (word == "Inf" && text == "\u221e") || (word == "-Inf" && text == "\u2212\u221e");
  }
  if (!value.is_number()) return false;
  double number = value.get<double>();
  if (text == "< .001") return number < 0.001;
  if (text == "> .999") return number > 0.999;
  if (percent) {
    if (!text.ends_with(" %")) return false;
    text.resize(text.size() - 2);
    number *= 100;
  }
  if (text.starts_with("\u2212")) text = "-" + text.substr(std::string("\u2212").size());
  char* end = nullptr;
  const double printed = std::strtod(text.c_str(), &end);
  if (end == text.c_str() || *end != '\0') return false;
  return std::abs(printed - number) <= 0.5 * std::pow(10.0, -decimals(text)) * (1 + 1e-9);
}

/// Fields of the page that do not say what the JSON says.
std::vector<std::string> wrong_fields(const html_reader::Page& page, const OrderedJson& json) {
  std::vector<std::string> wrong;
  for (const auto& text : page.texts) {
    const auto field = text.attribute("data-field");
    if (field.empty()) continue;
    const OrderedJson::json_pointer pointer(field);
    if (!json.contains(pointer) || !says(text.words, json.at(pointer), !text.attribute("data-unit").empty()))
      wrong.push_back(field + ": " + text.words);
  }
  return wrong;
}

std::size_t count_fields(const html_reader::Page& page) {
  std::size_t n = 0;
  for (const auto& text : page.texts) n += !text.attribute("data-field").empty();
  return n;
}

TEST(ReportPage, EveryMarkedNumberStandsInTheJson) {
  for (const auto* json : {&example(), &made()}) {
    const auto page = page_of(*json);
    EXPECT_GT(count_fields(page), 2000u);
    EXPECT_THAT(wrong_fields(page, *json), ::testing::IsEmpty());
  }
}

TEST(ReportPage, AWrongNumberWouldBeSeen) {
  auto changed = made();
  const auto page = page_of(changed);
  changed["task1"]["comparisons"][3]["p"] = 0.5 + changed["task1"]["comparisons"][3]["p"].get<double>() / 3;
  EXPECT_FALSE(wrong_fields(page, changed).empty());
  EXPECT_TRUE(says(".029", 0.0291, false));
  EXPECT_FALSE(says(".029", 0.0296, false));
  EXPECT_FALSE(says("< .001", 0.002, false));
  EXPECT_TRUE(says("\u22120.46", -0.4649, false));
  EXPECT_FALSE(says("0.46", -0.46, false));
  EXPECT_FALSE(says("0.46", OrderedJson(), false));
}

TEST(ReportPage, NoOtherNumberIsPrinted) {
  // Names and definitions; everything else with a digit has its place in the JSON.
  const std::vector<std::string> fixed{"Task 1", "Task 2",  "Fig. 6",   "Fig. 9",    "Fig. 10",
                                       "(1993)", "< .05",   "< .01",    "below .05", ".05 after Holm",
                                       "< .001", "SHA-256", "H1 to H6", "H1 to H3", "p95, ms"};
  for (const auto* json : {&example(), &made()}) {
    std::vector<std::string> known = fixed;
    for (const auto& protocol : json->at("study").at("protocols")) {
      // Sessions are counted by these words of theirs, which are the results' own.
      for (const char* by : {"displays", "angles", "mixed_pictures"})
        for (const auto& [words, sessions] : protocol.at(by).items()) known.push_back(words);
    }
    for (const auto& text : page_of(*json).texts) {
      if (!text.attribute("data-field").empty() || text.within("style") || text.within("svg")) continue;
      if (text.within("title") || text.attribute("class") == "ordinal") continue;
      if (!text.attribute("data-count").empty()) {
        EXPECT_EQ(text.words,
                  std::to_string(json->at(OrderedJson::json_pointer(text.attribute("data-count"))).size()));
        continue;
      }
      std::string rest = text.words;
      for (const auto& words : known)
        for (auto at = rest.find(words); at != std::string::npos; at = rest.find(words))
          rest.erase(at, words.size());
      EXPECT_EQ(rest.find_first_of("0123456789"), std::string::npos) << text.words;
    }
  }
}

TEST(ReportPage, FiguresPrintNumbersOfTheJsonAndAxesOnly) {
  std::size_t seen = 0;
  for (const auto& text : page_of(made()).texts) {
    if (!text.within("svg") || text.within("title") || text.within("desc")) continue;
    if (!text.attribute("data-field").empty()) {
      ++seen;
    } else if (text.attribute("class") != "axis") {
      EXPECT_EQ(text.words.find_first_of("0123456789"), std::string::npos) << text.words;
    }
  }
  EXPECT_GT(seen, 60u);
}

TEST(ReportPage, ReachesForNothingOutside) {
  const std::string html = report::results_page(made());
  for (const char* word : {"http:", "https:", "//", "src=", "@import", "<script", "<link", "javascript",
                           "<iframe", "<img", ">nan", "NaN", ">null"})
    EXPECT_FALSE(holds(html, word)) << word;
  for (const auto& element : html_reader::read(html).elements) {
    for (const auto& [name, value] : element.attributes) {
      EXPECT_FALSE(name.starts_with("on")) << element.name << " " << name;
      if (name == "href") {
        EXPECT_TRUE(value.starts_with("#")) << value;
      }
      for (auto at = value.find("url("); at != std::string::npos; at = value.find("url(", at + 1))
        EXPECT_EQ(value[at + 4], '#') << value;
    }
  }
}

TEST(ReportPage, IdsAreUniqueAndEveryReferenceHasItsTarget) {
  std::set<std::string> ids, wanted;
  for (const auto& element : page_of(made()).elements) {
    for (const auto& [name, value] : element.attributes) {
      if (name == "id") {
        EXPECT_TRUE(ids.insert(value).second) << value;
      }
      if (name == "href") wanted.insert(value.substr(1));
      if (const auto at = value.find("url(#"); at != std::string::npos)
        wanted.insert(value.substr(at + 5, value.find(')', at) - at - 5));
      if (name != "aria-labelledby") continue;
      for (std::size_t at = 0; at < value.size(); at = std::min(value.find(' ', at), value.size() - 1) + 1)
        wanted.insert(value.substr(at, value.find(' ', at) - at));
    }
  }
  for (const auto& id : wanted) EXPECT_TRUE(ids.contains(id)) << id;
}

TEST(ReportPage, TablesAndFiguresCanBeReadAloud) {
  const auto page = page_of(made());
  std::map<std::string, int> n;
  int heading = 0;
  for (const auto& element : page.elements) {
    ++n[element.name];
    if (element.name == "th") {
      EXPECT_TRUE(element.attributes.contains("scope"));
    }
    if (element.name == "svg") {
      EXPECT_EQ(element.attributes.at("role"), "img");
    }
    if (element.name == "html") {
      EXPECT_EQ(element.attributes.at("lang"), "en");
    }
    if (element.name.size() == 2 && element.name[0] == 'h' && std::isdigit(element.name[1])) {
      EXPECT_LE(element.name[1] - '0', heading + 1) << "a level is left out";
      heading = element.name[1] - '0';
    }
  }
  EXPECT_EQ(n["h1"], 1);
  EXPECT_GT(n["table"], 10);
  EXPECT_EQ(n["caption"], n["table"]);
  EXPECT_EQ(n["figcaption"], n["figure"]);
  EXPECT_EQ(n["svg"], n["figure"]);
  EXPECT_EQ(n["desc"], n["svg"]);
  EXPECT_EQ(n["title"], n["svg"] + 1);  // and the page's own
  EXPECT_GE(n["svg"], 10) << "three flows, three timings, heat map, two box plots, preferences";
}

TEST(ReportPage, TablesAndFiguresAreNumberedInTheirOrder) {
  std::map<std::string, int> n;
  for (const auto& text : page_of(made()).texts) {
    if (text.attribute("class") != "ordinal") continue;
    const std::string name = text.within("caption") ? "Table" : "Figure";
    EXPECT_EQ(text.words, name + " " + std::to_string(++n[name]) + ".");
  }
  EXPECT_GT(n["Table"], 10);
  EXPECT_GE(n["Figure"], 10);
}

TEST(ReportPage, ShowsWhyWhatIsNotGivenIsNotGiven) {
  auto json = example();
  json["task2"]["bradley_terry"] = {{"refused", "the methods fall into two groups never compared"}};
  json["task1"]["ordinal"][0] = {{"question", "realism"}, {"n_star", "16k"}, {"refused", "one answer only"}};
  json["task1"]["omnibus"][1]["friedman"] = {{"refused", "all ranks tie"}};
  auto& pair = json["task1"]["comparisons"][0];
  for (const char* key : {"t", "df", "p", "ci", "p_holm", "p_bh"}) pair[key] = nullptr;
  pair["reason"] = "all differences are equal";
  auto& test = json["hypotheses"][0]["tests"][0];
  test["p"] = test["p_holm"] = nullptr;
  test["reason"] = "fewer than two participants";
  json["pilot"] = {{"status", "failed"}, {"reason", "no contour at this level"}};
  const std::string html = report::results_page(json);
  for (const char* reason :
       {"never compared", "one answer only", "all ranks tie", "all differences are equal",
        "fewer than two participants", "no contour at this level"})
    EXPECT_TRUE(holds(html, reason));
  EXPECT_THAT(wrong_fields(html_reader::read(html), json), ::testing::IsEmpty());
}

TEST(ReportPage, ATaskWithoutResultsSaysSo) {
  auto json = example();
  json.erase("task2");
  json["task1"] = {{"refused", "no answer counts"}};
  json.erase("hypotheses");
  const std::string html = report::results_page(json);
  EXPECT_TRUE(holds(html, "no answer counts"));
  EXPECT_FALSE(holds(html, "Task 2: preference"));
  EXPECT_NO_THROW(html_reader::read(html));
}

TEST(ReportPage, WordsOfTheStudyCannotBreakIt) {
  auto json = example();
  const std::string nasty = "<script>alert(\"1\")</script> & 'x'";
  json["exclusions"][0]["reason"] = nasty;
  json["study"]["database"] = nasty;
  json["study"]["displays"] = {{nasty, 3}};
  json["task1"]["cells"][0]["method"] = nasty;
  const std::string html = report::results_page(json);
  EXPECT_FALSE(holds(html, "<script"));
  EXPECT_NO_THROW(html_reader::read(html));
}

TEST(ReportPage, SimulatedAndTestDataAreNamedFirst) {
  auto json = made();
  json["study"]["protocols"][1]["test_data"] = true;
  const std::string html = report::results_page(json);
  EXPECT_LT(html.find("Simulated participants"), html.find("<h2"));
  EXPECT_LT(html.find("Test data."), html.find("<h2"));
}

TEST(ReportPage, OnlyWhatABundleHoldsIsCalledPreregistered) {
  auto json = example();
  EXPECT_FALSE(holds(report::results_page(json), ">Preregistered<"));
  json["preregistration"] = {{"sha256", "ab"},
                             {"tasks", {{"task1", true}, {"task2", false}}},
                             {"summary", "differs"},
                             {"differences", {"protocol task2 was not preregistered"}}};
  const std::string html = report::results_page(json);
  EXPECT_TRUE(holds(html, "protocol task2 was not preregistered"));
  std::size_t n = 0;
  for (auto at = html.find(">Preregistered<"); at != std::string::npos;
       at = html.find(">Preregistered<", at + 1))
    ++n;
  EXPECT_EQ(n, 7u) << "H1 to H3 in the table and in their sections, and the list of parts";
}

TEST(ReportPage, RefusesAnotherSchema) {
  EXPECT_THROW(report::results_page({{"schema", "vip-results/2"}}), base::Error);
  EXPECT_THROW(report::results_page(OrderedJson::array()), base::Error);
}

}  // namespace
}  // namespace apps
