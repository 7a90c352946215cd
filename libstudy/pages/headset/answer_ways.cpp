#include "libstudy/pages/headset/answer_ways.hpp"

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace study {

const char* const usual_answer_ways = "ray,stick,keyboard";

AnswerWays parse_answer_ways(const std::string& words) {
  AnswerWays ways;
  const std::string known =
      "name one or more of ray, stick, dwell and keyboard, with commas between, but not both ray and dwell";
  for (const std::string& word : base::split(words)) {
    bool* const way = word == "ray"        ? &ways.ray
                      : word == "stick"    ? &ways.stick
                      : word == "dwell"    ? &ways.dwell
                      : word == "keyboard" ? &ways.keyboard
                                           : nullptr;
    if (!way) throw base::Error("--answer", "'" + word + "' is not known", known);
    *way = true;
  }
  if (!ways.ray && !ways.stick && !ways.dwell && !ways.keyboard)
    throw base::Error("--answer", "names nothing to answer with", known);
  if (ways.ray && ways.dwell)
    throw base::Error("--answer", "ray and dwell both point", "name one of them, such as dwell,keyboard");
  return ways;
}

void check_keys_are_free(const std::string& words, bool console) {
  if (!console) return;
  const AnswerWays ways = parse_answer_ways(words.empty() ? usual_answer_ways : words);
  if (!ways.ray && !ways.stick && !ways.dwell)
    throw base::Error("--answer keyboard", "the console uses the terminal's keys",
                      "add another way to answer, or leave --console out");
}

}  // namespace study
