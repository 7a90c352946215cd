#pragma once
/// Data sets and answers of tests/stats/r/rival_models.R.

#include <fstream>
#include <string>
#include <vector>

#include "stats/base/json.hpp"
#include "stats/ordinal/rival_fit.hpp"

namespace rival_oracle {

inline base::Json all() {
  std::ifstream in(std::string(VIP_TEST_DIR) + "/stats/r/rival_models.json");
  return base::Json::parse(in);
}

struct Data {
  std::string name;
  stats::RivalAnswers answers;
  std::vector<std::vector<double>> x;

  stats::RivalModel model(const std::vector<std::size_t>& columns) const {
    stats::RivalModel out{name, {}, false};
    for (const std::size_t c : columns) out.predictors.push_back({"x" + std::to_string(c), x.at(c)});
    return out;
  }
};

inline Data data_of(const base::Json& json) {
  Data out{json.at("name"), {}, {}};
  out.answers.choices = json.at("choices");
  for (const auto& s : json.at("score")) out.answers.score.push_back(s);
  for (const auto& p : json.at("person")) {
    out.answers.person.push_back(p);
    out.answers.people = std::max(out.answers.people, out.answers.person.back() + 1);
  }
  for (const auto& column : json.at("x")) {
    out.x.emplace_back();
    for (const auto& v : column) out.x.back().push_back(v);
  }
  return out;
}

}  // namespace rival_oracle
