#include <algorithm>
#include <tuple>

#include "libstudy/protocol/readers.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

/// Reads the words of scores, such as {1 = "poor", 7 = "good"}.
std::vector<std::pair<int, std::string>> read_anchors(const base::TomlTable& question, int least, int most) {
  std::vector<std::pair<int, std::string>> out;
  if (!question.has("anchors")) return out;
  const auto table = question.table("anchors");
  for (const auto& key : table.keys()) {
    const auto score = base::parse_number<int>(key);
    if (!score || *score < least || *score > most) {
      table.fail(key, "is not a score of the scale",
                 "use whole numbers from " + std::to_string(least) + " to " + std::to_string(most));
    }
    if (!out.empty() && *score <= out.back().first)
      table.fail(key, "does not ascend", "list the anchors in ascending order, each score once");
    out.emplace_back(*score, text_of(table, key));
  }
  return out;
}

AnswerKind read_answer_kind(const base::TomlTable& table) {
  std::vector<std::string> words;
  for (const AnswerKindTraits& traits : answer_kinds()) words.emplace_back(traits.word);
  const std::string word = table.choice("kind", words);
  const auto found = std::find(words.begin(), words.end(), word);
  return answer_kinds()[static_cast<std::size_t>(found - words.begin())].kind;
}

std::pair<int, int> read_span(const base::TomlTable& table, std::string_view key, base::Range range) {
  const auto ends = table.numbers(key, 2, range);
  const auto low = static_cast<int>(ends[0]);
  const auto high = static_cast<int>(ends[1]);
  if (static_cast<double>(low) != ends[0] || static_cast<double>(high) != ends[1])
    table.fail(key, "must hold whole numbers", "write them without a fraction");
  return {low, high};
}

/// "no" and "yes" in the question's language; none if the program does not know them.
std::vector<std::pair<int, std::string>> words_of_no_and_yes(const std::string& language) {
  if (language.starts_with("en")) return {{0, "no"}, {1, "yes"}};
  if (language.starts_with("de")) return {{0, "nein"}, {1, "ja"}};
  return {};
}

void read_labels(const base::TomlTable& table, Question& question) {
  const bool yes_no = traits_of(question.kind).yes_no;
  question.anchors = read_anchors(table, 0, yes_no ? 1 : 100);
  if (yes_no && !table.has("anchors")) {
    question.anchors = words_of_no_and_yes(question.language);
    if (question.anchors.empty())
      table.fail("anchors", "is missing: the words for no and yes are known in English and German only",
                 "write the words of 0 and 1 in language \"" + question.language + "\"");
  }
  if (question.anchors.size() < 2)
    table.fail("anchors", "offer fewer than two answers", "write anchors = {0 = \"no\", 1 = \"yes\"}");
  question.scale_min = question.anchors.front().first;
  question.scale_max = question.anchors.back().first;
}

void read_reaction(const base::TomlTable& table, Question& question) {
  question.timeout_s = table.number_or("timeout_s", question.timeout_s, {0.1, 60});
  question.scale_min = 0;
  question.scale_max = 1;
  question.anchors = {{0, "too late"}, {1, "pressed"}};  // for exports; participants do not see these words
  if (question.personal)
    table.fail("personal", "= true keeps no response time", "remove it, or use another kind");
}

/// Checks scale and anchors of a Vas, of which a participant sees only the line and the words at its ends.
void check_line(const base::TomlTable& table, const Question& question) {
  if (question.scale_max > 1000) table.fail("scale", "ends above 1000", "use [0, 1000] at most");
  const auto& words = question.anchors;
  if (words.size() == 2 && words[0].first == question.scale_min && words[1].first == question.scale_max)
    return;
  table.fail("anchors", "are not the words at the two ends of the line",
             "write words for " + std::to_string(question.scale_min) + " and " +
                 std::to_string(question.scale_max) + ", and for no other score");
}

void read_scores(const base::TomlTable& table, Question& question) {
  const AnswerKindTraits& traits = traits_of(question.kind);
  if (traits.labelled) return read_labels(table, question);
  if (traits.timed) return read_reaction(table, question);
  std::tie(question.scale_min, question.scale_max) =
      traits.line && !table.has("scale") ? std::pair{0, 100} : read_span(table, "scale", {0, 10000});
  if (question.scale_max <= question.scale_min)
    table.fail("scale", "does not ascend", "write the scale as [low, high]");
  if (traits.rated() && !traits.line && question.scale_max - question.scale_min > 100)
    table.fail("scale", "has more than 101 scores", "use kind = \"number\" or \"vas\"");
  if (traits.rated()) question.anchors = read_anchors(table, question.scale_min, question.scale_max);
  if (traits.line) check_line(table, question);
  if (traits.rated() && table.has("level")) {
    question.level = table.number("level");
    if (!(*question.level > question.scale_min && *question.level < question.scale_max)) {
      table.fail("level",
                 "= " + shown(*question.level) + " does not lie between the ends of the scale, " +
                     std::to_string(question.scale_min) + " and " + std::to_string(question.scale_max),
                 "use a score above " + std::to_string(question.scale_min) + " and below " +
                     std::to_string(question.scale_max) + ", or remove it for the middle");
    }
  }
}

base::Range range_of(const Question& question) {
  return {static_cast<double>(question.scale_min), static_cast<double>(question.scale_max)};
}

std::optional<int> read_score(const base::TomlTable& table, std::string_view key, const Question& question) {
  if (!table.has(key)) return {};
  const auto score = static_cast<int>(table.integer(key, range_of(question)));
  if (!can_be_given(question, score))
    table.fail(key, "= " + std::to_string(score) + " is not one of the answers",
               "use a score that anchors lists");
  return score;
}

/// Reads `accept`: the range of answers with which the session continues.
void read_accept(const base::TomlTable& table, BlockKind block, Question& question) {
  if (!table.has("accept")) return;
  if (block != BlockKind::Screening && block != BlockKind::Consent && block != BlockKind::Demographics) {
    table.fail("accept", "is not allowed in a block of kind " + block_kind_name(block),
               "put the question into a block of kind screening, consent or demographics");
  }
  if (!question.required) table.fail("accept", "contradicts required = false", "remove one of them");
  question.accept = read_span(table, "accept", range_of(question));
  const auto [low, high] = *question.accept;
  if (low > high) table.fail("accept", "does not ascend", "write the accepted scores as [low, high]");
  int score = low;
  while (score <= high && !can_be_given(question, score)) ++score;
  if (score > high) table.fail("accept", "includes none of the answers", "use scores that anchors lists");
}

/// Reads `expect` of catch pages: the answer of an attentive person.
void read_expect(const base::TomlTable& table, BlockKind block, Question& question) {
  question.expect = read_score(table, "expect", question);
  if (block != BlockKind::Catch && question.expect) {
    table.fail("expect", "is not allowed in a block of kind " + block_kind_name(block),
               "put the question into a block of kind catch");
  }
  if (block != BlockKind::Catch) return;
  if (!question.expect)
    table.fail("expect", "is missing", "add expect = the answer of an attentive participant");
  if (!question.required)
    table.fail("required", "= false would let participants skip this catch question", "remove it");
}

std::string read_question_id(const base::TomlTable& table) {
  const std::string id = id_of(table, "id");
  if (id == "fms" || id.starts_with("ssq_")) {
    table.fail("id", "= \"" + id + "\" is reserved for blocks of kind " + id.substr(0, 3),
               "use another id, or a block of that kind");
  }
  return id;
}

Question read_question(const base::TomlTable& table, BlockKind block, const std::string& language) {
  Question question;
  question.id = read_question_id(table);
  question.text = text_of(table, "text");
  question.language = table.has("language") ? text_of(table, "language") : language;
  question.kind = read_answer_kind(table);
  question.personal = table.boolean_or("personal", false);
  if (question.personal && (block == BlockKind::Stimulus || block == BlockKind::Catch)) {
    table.fail("personal", "= true is not allowed in a block of kind " + block_kind_name(block),
               block == BlockKind::Catch ? "remove it"
                                         : "remove it, or ask the question in a block of kind demographics");
  }
  question.required = table.boolean_or("required", traits_of(question.kind).required);
  if (!traits_of(question.kind).scored) {
    if (block == BlockKind::Catch)
      table.fail("kind",
                 std::string("= \"") + traits_of(question.kind).word +
                     "\" has no score, and a question in a block of kind catch needs one",
                 "use " + kind_words([](const AnswerKindTraits& one) { return one.scored; }, " or "));
    return question;
  }
  read_scores(table, question);
  read_accept(table, block, question);
  question.stop_at = read_score(table, "stop_at", question);
  read_expect(table, block, question);
  return question;
}

/// Why the program cannot act on the answers to gaze_question or sharing_question; empty if it can.
std::string why_not_obeyed(BlockKind block, const Question& question) {
  if (block != BlockKind::Consent) return "is in a block of kind " + block_kind_name(block);
  // The views of permissions in the database read only choices of 0 and 1.
  if (!traits_of(question.kind).labelled)
    return "is not of kind " + kind_words([](const AnswerKindTraits& one) { return one.labelled; }, " or ");
  if (question.anchors.size() != 2 || question.scale_min != 0 || question.scale_max != 1)
    return "has other answers than 0 and 1";
  return question.personal ? "is personal" : "";
}

}  // namespace

void check_obeyed_questions(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks) {
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t q = 0; q < blocks[i].questions.size(); ++q) {
      const Question& question = blocks[i].questions[q];
      if (question.id != gaze_question && question.id != sharing_question) continue;
      const std::string why = why_not_obeyed(blocks[i].kind, question);
      if (why.empty()) continue;
      tables[i].fail_at(
          "question", q, "\"" + question.id + "\" " + why + ", so the program cannot act on its answer",
          "ask it in a block of kind consent with kind = \"choice\" and anchors = {0 = \"no\", 1 = "
          "\"yes\"}, without personal; or use another id");
    }
  }
}

std::vector<Question> read_questions(const base::TomlTable& block, BlockKind kind,
                                     const std::string& language) {
  std::vector<Question> out;
  for (const auto& table : block.tables("question")) out.push_back(read_question(table, kind, language));
  return out;
}

const std::array<AnswerKindTraits, 7>& answer_kinds() {
  using enum AnswerKind;
  static constexpr std::array<AnswerKindTraits, 7> all{{
      {.kind = Scale, .word = "scale", .meaning = "a row of scores", .listed = true},
      {.kind = Choice, .word = "choice", .meaning = "one of `anchors`", .listed = true, .labelled = true},
      {.kind = Number, .word = "number", .meaning = "typed", .answering_s = 10},
      {.kind = Text,
       .word = "text",
       .meaning = "free words",
       .scored = false,
       .required = false,
       .answering_s = 30},
      {.kind = Vas,
       .word = "vas",
       .meaning = "a point of a line without numbers",
       .listed = true,
       .line = true},
      {.kind = YesNo,
       .word = "yes_no",
       .meaning = "a choice of 0 and 1, stored and analysed as one",
       .listed = true,
       .labelled = true,
       .yes_no = true,
       .stored = "choice"},
      {.kind = Reaction,
       .word = "reaction",
       .meaning = "a press as soon as the page appears, alone on its page; 1, or 0 if it came too late",
       .timed = true,
       .answering_s = 2},
  }};
  return all;
}

const AnswerKindTraits& traits_of(AnswerKind kind) { return answer_kinds()[static_cast<std::size_t>(kind)]; }

std::string kind_words(bool (*is)(const AnswerKindTraits&), const char* last) {
  std::vector<std::string> words;
  for (const AnswerKindTraits& traits : answer_kinds())
    if (is(traits)) words.emplace_back(traits.word);
  if (words.size() < 2) return base::joined(words);
  const std::string end = last + words.back();
  words.pop_back();
  return base::joined(words) + end;
}

std::vector<int> scores_of(const Question& question) {
  const AnswerKindTraits& traits = traits_of(question.kind);
  std::vector<int> out;
  if (traits.labelled) {
    for (const auto& [score, words] : question.anchors) out.push_back(score);
  } else if (traits.scored) {
    for (int score = question.scale_min; score <= question.scale_max; ++score) out.push_back(score);
  }
  return out;
}

bool can_be_given(const Question& question, int score) {
  const auto scores = scores_of(question);
  return std::binary_search(scores.begin(), scores.end(), score);
}

std::string letter_of(const Question& question, int score) {
  if (!traits_of(question.kind).yes_no || question.anchors.size() != 2) return "";
  const auto first = [](const std::string& words) {
    const char letter = words.empty() ? ' ' : words.front();
    const char lower = letter >= 'A' && letter <= 'Z' ? static_cast<char>(letter - 'A' + 'a') : letter;
    return lower >= 'a' && lower <= 'z' ? std::string(1, lower) : "";
  };
  const std::string no = first(question.anchors[0].second), yes = first(question.anchors[1].second);
  if (no == yes) return "";
  return score == question.anchors[0].first ? no : yes;
}

double fitted_level(const Question& question) {
  return question.level.value_or((question.scale_min + question.scale_max) / 2.0);
}

std::vector<Question> ssq_questions(const std::string& language) {
  static const char* const symptoms[] = {"General discomfort",
                                         "Fatigue",
                                         "Headache",
                                         "Eye strain",
                                         "Difficulty focusing",
                                         "Increased salivation",
                                         "Sweating",
                                         "Nausea",
                                         "Difficulty concentrating",
                                         "Fullness of the head",
                                         "Blurred vision",
                                         "Dizziness with eyes open",
                                         "Dizziness with eyes closed",
                                         "Vertigo",
                                         "Stomach awareness",
                                         "Burping"};
  std::vector<Question> out;
  for (const char* symptom : symptoms) {
    Question question;
    question.id = "ssq_" + std::to_string(out.size() + 1);
    question.text = symptom;
    question.language = language;
    question.scale_min = 0;
    question.scale_max = 3;
    question.anchors = {{0, "none"}, {1, "slight"}, {2, "moderate"}, {3, "severe"}};
    out.push_back(question);
  }
  return out;
}

Question fms_question(const std::string& language, std::optional<int> stop_at) {
  Question question;
  question.id = "fms";
  question.text = "How sick do you feel right now?";
  question.language = language;
  question.scale_min = 0;
  question.scale_max = 20;
  question.anchors = {{0, "not at all"}, {20, "severely"}};
  question.stop_at = stop_at;
  return question;
}

}  // namespace study
