#include <sstream>

#include "libstudy/protocol/readers.hpp"

namespace study {

namespace {

/// Reads one step of the list `steps`; see TrialStep.
class StepReader {
 public:
  StepReader(const base::TomlTable& table, std::size_t index, const std::string& text, bool pairs)
      : table_(table), index_(index), text_(text), words_(text), pairs_(pairs) {}

  TrialStep read() {
    std::string word;
    words_ >> word;
    TrialStep out;
    if (word == "black" || word == "rest") {
      out.kind = word == "black" ? StepKind::Black : StepKind::Rest;
      out.seconds = seconds();
    } else if (word == "stimulus") {
      out.interval = interval();
    } else if (word == "ask") {
      out.kind = StepKind::Ask;
      out.asks = ids();
    } else {
      fail("is no step", "write \"black SECONDS\", \"rest SECONDS\", \"stimulus\" or \"ask ID ID ...\"");
    }
    if (words_ >> word) fail("has the extra word '" + word + "'", "remove it, or make it a step of its own");
    return out;
  }

 private:
  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    table_.fail_at("steps", index_, "= " + base::toml_quoted(text_) + " " + problem, mend);
  }

  double seconds() {
    double out = -1;
    if (!(words_ >> out) || !(out >= pause_range.min && out <= pause_range.max))
      fail("lacks seconds from 0 to 3600", "write \"black 3\" or \"rest 30\"");
    return out;
  }

  int interval() {
    std::string which;
    if (!pairs_) return 0;  // the caller refuses the rest of the line
    words_ >> which;
    if (which != "first" && which != "second") {
      fail("does not say which of the pair",
           "write \"stimulus first\" and \"stimulus second\", as the design shows pairs");
    }
    return which == "second" ? 1 : 0;
  }

  std::vector<std::string> ids() {
    std::vector<std::string> out;
    for (std::string id; words_ >> id;) out.push_back(id);
    words_.clear();
    if (out.empty()) fail("asks no question", "write \"ask ID\"");
    return out;
  }

  const base::TomlTable& table_;
  std::size_t index_;
  const std::string& text_;
  std::istringstream words_;
  bool pairs_;
};

/// Checks that the steps show all stimuli, first before second, and then ask a question.
void check_steps(const base::TomlTable& table, const std::vector<TrialStep>& steps, bool pairs) {
  int seen = 0;
  bool asked = false;
  const int wanted = pairs ? 2 : 1;
  for (std::size_t i = 0; i < steps.size(); ++i) {
    asked = asked || steps[i].kind == StepKind::Ask;
    if (steps[i].kind != StepKind::Stimulus) continue;
    if (asked) table.fail_at("steps", i, "comes after a question", "ask after all stimuli");
    if (seen == wanted || steps[i].interval != seen) {
      table.fail_at("steps", i, "shows a stimulus out of order",
                    pairs ? "show first, then second, each once" : "show the stimulus once");
    }
    ++seen;
  }
  if (seen != wanted)
    table.fail("steps", "show too few stimuli",
               pairs ? "add \"stimulus first\" and \"stimulus second\"" : "add \"stimulus\"");
  if (!asked) table.fail("steps", "ask nothing", "add \"ask ID\"");
}

}  // namespace

std::vector<TrialStep> read_steps(const base::TomlTable& block, bool pairs) {
  const auto texts = block.strings("steps");
  std::vector<TrialStep> out;
  for (std::size_t i = 0; i < texts.size(); ++i) out.push_back(StepReader(block, i, texts[i], pairs).read());
  check_steps(block, out, pairs);
  return out;
}

}  // namespace study
