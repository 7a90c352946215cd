#include "libstudy/analysis/tasks/people_json.hpp"

#include <algorithm>
#include <cmath>
#include <map>

#include "stats/base/text.hpp"
#include "stats/inference/describe.hpp"

namespace study {

namespace {

using Counts = std::vector<std::pair<std::string, int>>;

/// The ends of a range are rounded outwards to multiples of this step, since an exact end would be one
/// person's answer.
constexpr double range_step = 5;

/// Answers of the analysed participants to one question, without empty answers.
std::vector<std::string> answers_to(const Question& question, const TaskData& data,
                                    const std::vector<PersonalEntry>& answers) {
  std::map<std::string, std::string> by_person;
  for (const auto& entry : answers) {
    if (entry.question == question.id && entry.wording == question.text && !entry.answer.empty())
      by_person[entry.participant] = entry.answer;
  }
  std::vector<std::string> out;
  for (const std::string& person : data.participants) {
    if (const auto found = by_person.find(person); found != by_person.end()) out.push_back(found->second);
  }
  return out;
}

/// The score as text if the answer is the text of an anchor of the scale; otherwise the answer itself.
std::string score_of(const Question& question, const std::string& answer) {
  for (const auto& [score, words] : question.anchors)
    if (words == answer) return std::to_string(score);
  return answer;
}

/// Adds mean, SD and range of the answers; if they are fewer than fewest_numbers, adds the refusal instead.
/// The range is added only for typed numbers.
void add_numbers(Json& json, const Question& question, std::vector<std::string> answers) {
  for (std::string& answer : answers) answer = score_of(question, answer);
  std::vector<double> values;
  for (const std::string& answer : answers)
    if (const auto value = base::parse_number<int>(answer)) values.push_back(*value);
  if (static_cast<int>(values.size()) < fewest_numbers) {
    json["refused"] = "fewer than " + std::to_string(fewest_numbers) +
                      " answers: their summary would nearly give the answers themselves";
    return;
  }
  const auto all = stats::describe(values);
  json["mean"] = all->mean;
  json["sd"] = json_number(all->sd);
  if (traits_of(question.kind).listed) return;
  json["range"] = {range_step * std::floor(all->min / range_step),
                   range_step * std::ceil(all->max / range_step)};
}

void add_groups(Json& json, const Question& question, const std::vector<std::string>& answers) {
  Counts counts;
  for (const auto& [score, words] : question.anchors)
    counts.emplace_back(words, static_cast<int>(std::count(answers.begin(), answers.end(), words)));
  const GroupCounts groups = pool_small_groups(counts);
  json["groups"] = Json::array();
  for (const auto& [answer, n] : groups.shown) json["groups"].push_back({{"answer", answer}, {"n", n}});
  json["pooled"] = groups.pooled.empty() ? Json()
                   : groups.pooled_people < smallest_group
                       ? json_refused("fewer than " + std::to_string(smallest_group) + " people in all")
                       : Json{{"answers", groups.pooled}, {"n", groups.pooled_people}};
}

Json question_json(const Question& question, const TaskData& data,
                   const std::vector<PersonalEntry>& entries) {
  const auto answers = answers_to(question, data, entries);
  Json json{{"question", question.id},
            {"text", question.text},
            {"kind", traits_of(question.kind).word},
            {"n", answers.size()},
            {"missing", data.participants.size() - answers.size()}};
  if (traits_of(question.kind).labelled) {
    add_groups(json, question, answers);
  } else {
    add_numbers(json, question, answers);
  }
  return json;
}

}  // namespace

GroupCounts pool_small_groups(Counts counts) {
  std::erase_if(counts, [](const auto& one) { return one.second == 0; });
  Counts by_size = counts;
  std::stable_sort(by_size.begin(), by_size.end(),
                   [](const auto& a, const auto& b) { return a.second < b.second; });
  GroupCounts out;
  for (const auto& [answer, n] : by_size) {
    const bool enough = out.pooled.empty() || out.pooled_people >= smallest_group;
    if (n >= smallest_group && enough) break;
    out.pooled.push_back(answer);
    out.pooled_people += n;
  }
  for (const auto& one : counts) {
    if (std::find(out.pooled.begin(), out.pooled.end(), one.first) == out.pooled.end())
      out.shown.push_back(one);
  }
  return out;
}

Json people_json(const std::vector<const TaskData*>& parts, const std::vector<PersonalEntry>& answers) {
  Json list = Json::array();
  for (const TaskData* data : parts) {
    if (data->protocol.about_people.empty() || data->participants.empty()) continue;
    Json questions = Json::array();
    for (const auto& question : data->protocol.about_people)
      questions.push_back(question_json(question, *data, answers));
    list.push_back({{"task", task_name(data->task)},
                    {"participants", data->participants.size()},
                    {"smallest_group", smallest_group},
                    {"fewest_numbers", fewest_numbers},
                    {"questions", questions}});
  }
  return list;
}

}  // namespace study
