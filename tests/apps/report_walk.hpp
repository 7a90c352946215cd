#pragma once
/// Compares the report's page with its JSON: every printed number must be in it.

#include <algorithm>
#include <cctype>
#include <cmath>
#include <iterator>
#include <set>
#include <sstream>
#include <string>
#include <vector>

#include "stats/base/file.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"

namespace report_walk {

using Json = base::Json;

/// The results of a simulated study; scripts/results_example.sh makes it.
inline const Json& example() {
  static const auto json = Json::parse(base::read_file(VIP_TEST_DIR "/apps/results_example.json", 1 << 24));
  return json;
}

/// Number of decimals.
inline int decimals(const std::string& text) {
  const auto point = text.find('.');
  if (point == std::string::npos) return 0;
  int n = 0;
  for (auto i = point + 1; i < text.size() && std::isdigit(static_cast<unsigned char>(text[i]));) ++i, ++n;
  return n;
}

/// Replaces the written symbols in the results' texts (n_*, mu, delta, +-) by the signs that the page prints.
inline std::string as_set(std::string text) {
  const auto letter = [&](std::size_t at) {
    return at < text.size() && std::isalpha(static_cast<unsigned char>(text[at]));
  };
  const std::pair<std::string, std::string> signs[] = {
      {"n_*", "n*"}, {"mu", "\u03bc"}, {"delta", "\u03b4"}, {"+-", "\u00b1"}};
  for (const auto& [written, sign] : signs) {
    for (auto at = text.find(written); at != std::string::npos; at = text.find(written, at + 1)) {
      const bool name = letter(at);
      if (name && ((at > 0 && letter(at - 1)) || letter(at + written.size()))) continue;
      text.replace(at, written.size(), sign);
    }
  }
  return text;
}

/// True if the printed text is the value, rounded to the printed digits.
inline bool says(std::string text, const Json& value, bool percent) {
  if (value.is_boolean()) return text == (value.get<bool>() ? "yes" : "no");
  if (value.is_string()) {
    const auto word = value.get<std::string>();
    return text == word || text == as_set(word) || (word == "Inf" && text == "\u221e") ||
           (word == "-Inf" && text == "\u2212\u221e");
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

/// The page's texts; parts of one value that italics separate are joined.
inline std::vector<html_reader::Text> texts_of(const html_reader::Page& page, const Json& json) {
  std::vector<html_reader::Text> out;
  for (const auto& text : page.texts) {
    const auto field = text.attribute("data-field");
    bool goes_on = !field.empty() && !out.empty() && out.back().attribute("data-field") == field;
    if (goes_on) {
      const Json value = json.value(Json::json_pointer(field), Json());
      const auto whole = value.is_string() ? as_set(value.get<std::string>()) : std::string();
      goes_on = whole.size() > out.back().words.size() && whole.starts_with(out.back().words);
    }
    if (goes_on) {
      out.back().words += text.words;
    } else {
      out.push_back(text);
    }
  }
  return out;
}

/// Fields of the page that differ from the JSON.
inline std::vector<std::string> wrong_fields(const html_reader::Page& page, const Json& json) {
  std::vector<std::string> wrong;
  for (const auto& text : texts_of(page, json)) {
    const auto field = text.attribute("data-field");
    if (field.empty()) continue;
    const Json::json_pointer pointer(field);
    if (!json.contains(pointer) || !says(text.words, json.at(pointer), !text.attribute("data-unit").empty()))
      wrong.push_back(field + ": " + text.words);
  }
  return wrong;
}

/// Ids that occur twice, and references without a target.
inline std::vector<std::string> wrong_references(const html_reader::Page& page) {
  std::set<std::string> ids, wanted;
  std::vector<std::string> wrong;
  for (const auto& element : page.elements) {
    for (const auto& [name, value] : element.attributes) {
      if (name == "id" && !ids.insert(value).second) wrong.push_back(value);
      if (name == "href") wanted.insert(value.substr(1));
      if (const auto at = value.find("url(#"); at != std::string::npos)
        wanted.insert(value.substr(at + 5, value.find(')', at) - at - 5));
      std::istringstream several(name == "aria-labelledby" ? value : "");
      for (std::string id; several >> id;) wanted.insert(id);
    }
  }
  std::set_difference(wanted.begin(), wanted.end(), ids.begin(), ids.end(), std::back_inserter(wrong));
  return wrong;
}

/// The document itself, then those in its list `apart`.
inline std::vector<const Json*> documents(const Json& json) {
  std::vector<const Json*> out{&json};
  if (json.contains("apart"))
    for (const auto& one : json.at("apart")) out.push_back(&one);
  return out;
}

/// Adds the reasons in the results, formatted as on the page; the JSON has their words.
inline void add_reasons(const Json& json, std::vector<std::string>& out) {
  for (const auto& [key, value] : json.items()) {
    const bool reason = json.is_object() && (key == "refused" || key.ends_with("reason"));
    if (value.is_structured()) add_reasons(value, out);
    if (reason && value.is_string() && !value.get<std::string>().empty())
      out.push_back(as_set(value.get<std::string>()));
  }
}

/// Texts with a digit that has no path into the JSON and is not part of a name or definition.
inline std::vector<std::string> unmarked_numbers(const html_reader::Page& page, const Json& json) {
  std::vector<std::string> known{"Task 1", "Task 2",  "Fig. 6",  "Fig. 9",    "Fig. 10",
                                 "(1993)", "< .05",   "< .01",   "below .05", ".05 after Holm",
                                 "< .001", "SHA-256", "p95, ms", "at most 1"};
  for (const Json* document : documents(json)) {
    for (const auto& protocol : document->at("study").at("protocols")) {
      // Sessions are counted under these texts, which come from the results.
      for (const char* by : {"displays", "angles", "mixed_pictures"})
        for (const auto& [words, sessions] : protocol.at(by).items()) known.push_back(words);
    }
  }
  add_reasons(json, known);
  // Longer texts first, since they may contain shorter ones.
  std::sort(known.begin(), known.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  std::vector<std::string> out;
  for (const auto& text : page.texts) {
    if (!text.attribute("data-field").empty() || text.within("style") || text.within("svg")) continue;
    if (text.within("title") || text.attribute("class") == "ordinal") continue;
    if (const auto counted = text.attribute("data-count"); !counted.empty()) {
      if (text.words != std::to_string(json.at(Json::json_pointer(counted)).size()))
        out.push_back(counted + ": " + text.words);
      continue;
    }
    std::string rest = text.words;
    for (const auto& words : known)
      for (auto at = rest.find(words); at != std::string::npos; at = rest.find(words))
        rest.erase(at, words.size());
    if (rest.find_first_of("0123456789") != std::string::npos) out.push_back(text.words);
  }
  return out;
}

/// Number of sessions in the page's flows, including those set aside.
inline int sessions_in_flows(const Json& json) {
  int out = 0;
  std::vector<std::string> counted;  // a protocol with several questions has a flow for each
  for (const Json* document : documents(json)) {
    for (const auto& protocol : document->at("study").at("protocols")) {
      const std::string sha256 = protocol.at("sha256");
      if (std::find(counted.begin(), counted.end(), sha256) != counted.end()) continue;
      counted.push_back(sha256);
      const Json& flow = document->at("flow").at(protocol.at("task").get<std::string>());
      out += flow.at("started").get<int>() + flow.at("set_aside").at("test_data").get<int>() +
             flow.at("set_aside").at("simulated").get<int>() +
             flow.at("set_aside").at("protocols").get<int>();
    }
  }
  return out;
}

}  // namespace report_walk
