/// The report's boxes and tables on wide and narrow screens and on paper.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <regex>
#include <set>

#include "libstudy/report/page.hpp"
#include "stats/base/error.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"
#include "tests/apps/report_walk.hpp"

namespace apps {
namespace {

using report_walk::example;
using OrderedJson = base::Json;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

html_reader::Page page_of(const OrderedJson& json) {
  return html_reader::read(study::report::results_page(json));
}

/// Declarations of the style sheet for a selector: in the @media block that starts with `media`, or outside
/// all blocks if it is empty.
std::string style_of(const std::string& html, const std::string& media, const std::string& selector) {
  const auto from = html.find("<style>") + 7;
  const std::string css = html.substr(from, html.find("</style>") - from);
  std::string out, block;
  for (std::size_t at = 0; at < css.size();) {
    const auto brace = css.find_first_of("{}", at);
    if (brace == std::string::npos) break;
    auto words = css.substr(at, brace - at);
    if (const auto comment = words.rfind("*/"); comment != std::string::npos) words.erase(0, comment + 2);
    words.erase(0, words.find_first_not_of(" \n"));
    at = brace + 1;
    if (css[brace] == '}' || words.starts_with("@media")) {
      block = css[brace] == '}' ? "" : words;
      continue;
    }
    const auto end = css.find('}', at);
    const bool here = media.empty() ? block.empty() : block.starts_with(media);
    if (here && (", " + words.substr(0, words.find_last_not_of(' ') + 1) + ",").find(", " + selector + ",") !=
                    std::string::npos)
      out += css.substr(at, end - at);
    at = end + 1;
  }
  return out;
}

TEST(ReportLayout, AWideTableScrollsInABoxOfItsOwnAndAShadeShowsWhere) {
  std::map<std::string, std::size_t> n;
  const std::string html = study::report::results_page(example());
  const auto page = html_reader::read(html);
  for (const auto& element : page.elements)
    if (element.name == "table" || (element.name == "div" && element.attributes.contains("tabindex")))
      ++n[element.name];
  EXPECT_EQ(n["div"], n["table"]) << "a box for each, which the keyboard reaches";
  for (const auto& text : page.texts) {
    const auto table = std::find_if(text.around.begin(), text.around.end(),
                                    [](const auto& one) { return one.name == "table"; });
    if (table == text.around.end()) continue;
    ASSERT_EQ((table - 1)->attributes.at("class"), "wide") << text.words;
  }
  for (const char* box : {".wide", "figure"}) {
    EXPECT_THAT(style_of(html, "", box), HasSubstr("overflow-x: auto;")) << box;
    const std::string narrow = style_of(html, "@media screen and (max-width", box);
    for (const char* side : {"right", "left"}) {
      // A white cover scrolls with the table; the shade below it stays at the box's edge.
      EXPECT_THAT(narrow,
                  ContainsRegex("to " + std::string(side) + ", #fff [^,]*, transparent\\) [^,]*local"))
          << box;
      EXPECT_THAT(narrow, ContainsRegex("to " + std::string(side) + ", #999, transparent\\) [^,]*scroll"))
          << box;
    }
  }
  for (auto at = html.find("<svg"); at != std::string::npos; at = html.find("<svg", at + 1)) {
    const auto desc = html.find("</desc>", at);
    EXPECT_FALSE(html.substr(desc + 7, 80).starts_with("\n<rect")) << "a background that covers the shade";
  }
  EXPECT_THAT(style_of(html, "@media screen and (max-width", ".wide table"), HasSubstr("width: max-content"));
  EXPECT_THAT(style_of(html, "@media print", ".wide"), HasSubstr("overflow: visible"));
}

/// Width of the picture whose id starts with `id`.
double picture_width(const std::string& html, const std::string& id) {
  const auto at = html.find("aria-labelledby=\"" + id);
  if (at == std::string::npos)
    throw base::Error(id, "no picture of the page has an id that starts so",
                      "use the start of a picture's id");
  return std::stod(html.substr(html.rfind("viewBox=\"0 0 ", at) + 13));
}

TEST(ReportLayout, MethodsStandSideBySideHoweverLongTheirNames) {
  const std::string name = "LoRes, rather_long_name_of_foam_and_spray";
  OrderedJson json = example();
  for (const char* list : {"cells", "by_scene", "participant_means"})
    for (OrderedJson& one : json.at("task1").at(list))
      if (one["method"] == "Ours") one["method"] = name;
  for (OrderedJson& one : json.at("task1").at("methods"))
    if (one == "Ours") one = name;
  for (OrderedJson& one : json.at("task1").at("scenes")) one = name;
  const auto html = study::report::results_page(json);
  const double needed = 6.5 * static_cast<double>(name.size());
  for (const char* id : {"box-plot-realism", "person-lines-realism", "scene-lines-realism"})
    EXPECT_GT(picture_width(html, id), needed * 5 * 2) << id << ": five methods at two n_*";
  EXPECT_GT(picture_width(html, "scene-lines-realism"), (needed + 40) * 3) << "three scenes in the legend";
}

// In an earlier version stars touched the end of a bracket above them.
TEST(ReportLayout, NoBracketRunsThroughTheStarsOfAnother) {
  const std::string html = study::report::results_page(example());
  const auto from = html.find("aria-labelledby=\"box-plot-realism");
  const std::string plot = html.substr(from, html.find("</svg>", from) - from);
  const std::regex bracket(R"re(d="M([0-9.]+),([0-9.]+)L\1,([0-9.]+)L([0-9.]+),\3L\4,\2")re");
  const std::regex stars(R"re(<text x="([0-9.]+)" y="([0-9.]+)"[^>]*>(\*+)</text>)re");
  int brackets = 0, compared = 0;
  for (std::sregex_iterator one(plot.begin(), plot.end(), bracket), end; one != end; ++one, ++brackets) {
    const double foot = std::stod((*one)[2]), head = std::stod((*one)[3]);
    for (std::sregex_iterator mark(plot.begin(), plot.end(), stars); mark != end; ++mark, ++compared) {
      const double x = std::stod((*mark)[1]), y = std::stod((*mark)[2]);
      for (const int side : {1, 4})
        EXPECT_FALSE(std::abs(x - std::stod((*one)[side])) < 15 && foot > y - 15 && head < y)
            << x << " " << y;
    }
  }
  EXPECT_GT(brackets, 2);
  EXPECT_EQ(compared, brackets * brackets) << "stars over each";
}

TEST(ReportLayout, PicturesOfShortNamesFitANarrowScreen) {
  const std::string html = study::report::results_page(example());
  for (const char* id : {"ratings-realism", "flow-pilot"})
    EXPECT_LE(picture_width(html, id), 500 - 2 * 11) << id;
}

TEST(ReportLayout, ScoresThatWereNotGivenAreNotListed) {
  const std::string html = study::report::results_page(example());
  int listed = 0, left_out = 0;
  const OrderedJson& questions = example().at("descriptives");
  for (std::size_t i = 0; i < questions.size(); ++i) {
    const OrderedJson& cells = questions[i].at("cells");
    for (std::size_t j = 0; j < cells.size(); ++j) {
      const OrderedJson& scores = cells[j].at("distribution");
      for (std::size_t k = 0; k < scores.size(); ++k) {
        const std::string place = "/descriptives/" + std::to_string(i) + "/cells/" + std::to_string(j) +
                                  "/distribution/" + std::to_string(k) + "/count";
        const bool there = html.find("data-field=\"" + place + "\"") != std::string::npos;
        EXPECT_EQ(there, scores[k].at("count") != 0 || !scores[k].at("answer").is_number()) << place;
        ++(there ? listed : left_out);
      }
    }
  }
  EXPECT_GT(listed, 0);
  EXPECT_GT(left_out, 0);
}

/// Number of columns in each row of each table; the first row is the head.
std::vector<std::vector<int>> columns_of(const html_reader::Page& page) {
  std::vector<std::vector<int>> out;
  for (const auto& element : page.elements) {
    if (element.name == "table") out.emplace_back();
    if (element.name == "tr") out.back().push_back(0);
    if (element.name != "th" && element.name != "td") continue;
    const auto span = element.attributes.find("colspan");
    out.back().back() += span == element.attributes.end() ? 1 : std::stoi(span->second);
  }
  return out;
}

TEST(ReportLayout, RowsHaveTheColumnsOfTheirHeadAndTimingOnlyThoseThatWereMeasured) {
  auto json = example();
  const auto heads = [](const html_reader::Page& page) {
    std::multiset<std::string> out;
    for (const auto& text : page.texts)
      if (text.around.back().name == "th" && text.attribute("scope") == "col") out.insert(text.words);
    return out;
  };
  const auto without = heads(page_of(json));
  for (auto& cell : json["timing"]) {
    if (cell["task"] != "task1") continue;
    cell["active_fraction"] = 0.5;
    cell["tau_fps"] = 12;
  }
  const auto page = page_of(json);
  EXPECT_EQ(without.count("Solved") + without.count("Tau (frames/s)"), 0u);
  EXPECT_EQ(heads(page).count("Solved"), 1u) << "of Task 1 alone";
  EXPECT_EQ(heads(page).count("Tau (frames/s)"), 1u);
  for (const auto& table : columns_of(page))
    for (const int columns : table) EXPECT_EQ(columns, table.front());
}

}  // namespace
}  // namespace apps
