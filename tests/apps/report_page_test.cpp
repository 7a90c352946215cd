/// The page of a study's results: its numbers, its completeness, its structure.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "libstudy/report/field.hpp"
#include "libstudy/report/page.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/made_task_study.hpp"
#include "tests/apps/report_walk.hpp"

namespace apps {
namespace {

using report_walk::example;
using OrderedJson = base::Json;

const OrderedJson& made() {
  static const OrderedJson json = made_study::whole_study(26, made_study::task1(26));
  return json;
}

// An earlier version printed [-0.000024, 0.0217] as [0.0000, 0.0217].
TEST(IntervalsOfTheReport, ShowOnWhichSideOf0TheyLie) {
  const auto shown = [](double low, double high, int decimals) {
    const OrderedJson ci{low, high};
    std::string out;
    const std::string html = "<!DOCTYPE html>" + study::report::interval(study::report::Field(ci), decimals);
    for (const auto& text : html_reader::read(html).texts) out += text.words;
    return out;
  };
  EXPECT_EQ(shown(-2.4e-05, 0.0217, 4), "[\u22120.00002, 0.02170]");
  EXPECT_EQ(shown(0.004, 0.4, 2), "[0.004, 0.400]");
  EXPECT_EQ(shown(-0.3, -0.0049, 2), "[\u22120.300, \u22120.005]");
  EXPECT_EQ(shown(0, 1, 2), "[0.00, 1.00]");
  EXPECT_EQ(shown(-1e-17, 0.5, 2), "[0.00, 0.50]") << "rounding";
}

/// Whether the page contains the words. Unlike HasSubstr, a failure does not print the whole page.
bool holds(const std::string& html, const std::string& words) {
  return html.find(words) != std::string::npos;
}

html_reader::Page page_of(const OrderedJson& json) {
  return html_reader::read(study::report::results_page(json));
}

std::size_t count_fields(const html_reader::Page& page) {
  std::size_t n = 0;
  for (const auto& text : page.texts) n += !text.attribute("data-field").empty();
  return n;
}

/// Changes every number, and every text with a space, so that codes stay.
OrderedJson changed(OrderedJson json) {
  if (json.is_number()) {
    const double number = json.get<double>();
    json = number > 0.5 ? number * 0.75 : number + 0.25;
  } else if (json.is_string() && holds(json.get<std::string>(), " ")) {
    json = json.get<std::string>() + " changed";
  }
  if (json.is_structured())
    for (OrderedJson& part : json) part = changed(std::move(part));
  return json;
}

TEST(ReportPage, EveryMarkedNumberStandsInTheJson) {
  for (const OrderedJson& json : {example(), made(), changed(made())}) {
    const auto page = page_of(json);
    EXPECT_GT(count_fields(page), 2000u);
    EXPECT_THAT(report_walk::wrong_fields(page, json), ::testing::IsEmpty());
  }
}

// The page says that intervals hold the plan's confidence "unless another share stands beside them".
// Intervals of equivalence, of H2 and of H3 hold 90 %, and must print this.
TEST(ReportPage, IntervalsOfAnotherShareSaySo) {
  std::set<std::string> said;
  for (const auto& text : page_of(example()).texts) said.insert(text.attribute("data-field"));
  std::size_t quoted = 0;
  const auto look = [&](const std::string& list, const std::string& part) {
    const OrderedJson& rows = example().at(OrderedJson::json_pointer(list));
    for (std::size_t i = 0; i < rows.size(); ++i) {
      const std::string share = list + "/" + std::to_string(i) + part + "/ci_confidence";
      const OrderedJson::json_pointer place(share);
      if (!example().contains(place) || example().at(place) == example().at("plan").at("confidence"))
        continue;
      ++quoted;
      EXPECT_TRUE(said.contains(share)) << share;
    }
  };
  for (std::size_t h = 0; h < example().at("hypotheses").size(); ++h)
    look("/hypotheses/" + std::to_string(h) + "/tests", "");
  look("/task1/comparisons", "/tost");
  EXPECT_GT(quoted, 20u);
}

TEST(ReportPage, AWrongNumberWouldBeSeen) {
  auto changed = made();
  const auto page = page_of(changed);
  changed["task1"]["comparisons"][3]["p"] = 0.5 + changed["task1"]["comparisons"][3]["p"].get<double>() / 3;
  EXPECT_FALSE(report_walk::wrong_fields(page, changed).empty());
  EXPECT_TRUE(report_walk::says(".029", 0.0291, false));
  EXPECT_FALSE(report_walk::says(".029", 0.0296, false));
  EXPECT_FALSE(report_walk::says("< .001", 0.002, false));
  EXPECT_TRUE(report_walk::says("\u22120.46", -0.4649, false));
  EXPECT_FALSE(report_walk::says("0.46", -0.46, false));
  EXPECT_FALSE(report_walk::says("0.46", OrderedJson(), false));
}

TEST(ReportPage, NoOtherNumberIsPrinted) {
  for (const auto* json : {&example(), &made()})
    EXPECT_THAT(report_walk::unmarked_numbers(page_of(*json), *json), ::testing::IsEmpty());
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
  const std::string html = study::report::results_page(made());
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
  EXPECT_THAT(report_walk::wrong_references(page_of(made())), ::testing::IsEmpty());
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
  EXPECT_EQ(n["title"], n["svg"] + 1);  // plus the page's own title
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
  json["task2"]["triads"] = {{"refused", "everybody answered one pair twice"}};
  const std::string html = study::report::results_page(json);
  for (const char* reason :
       {"never compared", "one answer only", "all ranks tie", "all differences are equal",
        "fewer than two participants", "no contour at this level", "everybody answered one pair twice"})
    EXPECT_TRUE(holds(html, reason));
  EXPECT_THAT(report_walk::wrong_fields(html_reader::read(html), json), ::testing::IsEmpty());
}

TEST(ReportPage, ATaskWithoutResultsSaysSo) {
  auto json = example();
  json.erase("task2");
  json["task1"] = {{"refused", "no answer counts"}};
  json.erase("hypotheses");
  const std::string html = study::report::results_page(json);
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
  const std::string html = study::report::results_page(json);
  EXPECT_FALSE(holds(html, "<script"));
  EXPECT_NO_THROW(html_reader::read(html));
}

TEST(ReportPage, SimulatedAndTestDataAreNamedFirst) {
  auto json = made();
  json["study"]["protocols"][1]["test_data"] = true;
  const std::string html = study::report::results_page(json);
  EXPECT_LT(html.find("Simulated participants"), html.find("<h2"));
  EXPECT_LT(html.find("Test data."), html.find("<h2"));
}

TEST(ReportPage, OnlyWhatABundleHoldsIsCalledPreregistered) {
  auto json = example();
  EXPECT_FALSE(holds(study::report::results_page(json), ">Preregistered<"));
  json["preregistration"] = {{"sha256", "ab"},
                             {"tasks", {{"task1", true}, {"task2", false}}},
                             {"summary", "differs"},
                             {"differences", {"protocol task2 was not preregistered"}}};
  const std::string html = study::report::results_page(json);
  EXPECT_TRUE(holds(html, "protocol task2 was not preregistered"));
  std::size_t n = 0;
  for (auto at = html.find(">Preregistered<"); at != std::string::npos;
       at = html.find(">Preregistered<", at + 1))
    ++n;
  EXPECT_EQ(n, 7u) << "H1 to H3 in the table and in their sections, and the list of parts";
}

TEST(ReportPage, EveryParticipantIsInOneBoxOfTheFlow) {
  auto task = made_study::task1(6);
  for (std::size_t person : {0u, 1u, 2u}) {
    task.sessions[person].state = "dropped out";
    for (auto& trial : task.sessions[person].trials)
      if (person < 2 || trial.position > 3)
        for (auto& answer : trial.answers) answer.score.reset();
  }
  task.sessions[3].catches = {{"attention", 2, 5}};
  const auto json = made_study::results_of({{task}, 0});
  const auto& flow = json.at("flow").at("task1");
  EXPECT_EQ(flow.at("participants"), 6);
  EXPECT_EQ(flow.at("no_answer"), 2);
  EXPECT_EQ(flow.at("excluded_participants"), 1);
  EXPECT_EQ(flow.at("analysed"), 3) << "one of them did not come back";
  const auto html = study::report::results_page(json);
  for (const char* box : {"participants in them", "people without an answer to analyse",
                          "people left out by rule or hand", "participants analysed"})
    EXPECT_TRUE(holds(html, box)) << box;
}

TEST(ReportPage, TheBannerCountsSimulatedPeopleThatAreLeftOutToo) {
  auto task = made_study::task1(5);
  for (auto& session : task.sessions) session.observer = "random";
  task.sessions[0].catches = task.sessions[1].catches = {{"attention", 2, 5}};
  const auto json = made_study::results_of({{task}, 0});
  EXPECT_EQ(json.at("flow").at("task1").at("analysed"), 3);
  EXPECT_EQ(json.at("study").at("simulated_people"), 5);
  EXPECT_EQ(json.at("study").at("protocols").at(0).at("simulated"), 5);
}

TEST(ReportPage, RefusesAnotherSchema) {
  EXPECT_THROW(study::report::results_page({{"schema", "vip-results/2"}}), base::Error);
  EXPECT_THROW(study::report::results_page(OrderedJson::array()), base::Error);
}

}  // namespace
}  // namespace apps
