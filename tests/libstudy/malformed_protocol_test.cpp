/// Every mistake in a protocol is reported at its own place, with a remedy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "tests/common/protocols.hpp"

namespace {

using test::replaced;
using test::shipped_text;
using testing::HasSubstr;

/// Line and column of the '|' in `marked`, which without the '|' is a part of `text`.
std::string place_of(const std::string& text, std::string marked) {
  const auto mark = marked.find('|');
  const auto found = text.find(marked.erase(mark, 1));
  if (found == std::string::npos) return "(no '" + marked + "' in the text)";
  const auto at = found + mark;
  const auto line_start = at == 0 ? 0 : text.rfind('\n', at - 1) + 1;
  const auto line = 1 + std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  return "p.toml:" + std::to_string(line) + ":" + std::to_string(at - line_start + 1);
}

std::string error_of(const std::string& text) {
  try {
    study::parse_protocol(text, "p.toml");
  } catch (const base::Error& error) {
    return error.what();
  }
  return "(no error)";
}

constexpr const char* answers = "answers";  // the protocol of answers_text()

struct Malformed {
  const char* protocol;  // name of a shipped protocol, or `answers`
  const char* from;
  const char* to;
  const char* place;    // part of the changed text, with '|' where the error must point
  const char* problem;  // part of the message
  const char* mend;
};

class MalformedProtocol : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedProtocol, IsRefusedWithPlaceAndMend) {
  const auto& param = GetParam();
  const std::string whole =
      param.protocol == std::string(answers) ? test::answers_text() : shipped_text(param.protocol);
  ASSERT_EQ(error_of(whole), "(no error)");
  const std::string text = replaced(whole, param.from, param.to);
  const std::string error = error_of(text);
  EXPECT_THAT(error, HasSubstr(place_of(text, param.place) + ": "));
  EXPECT_THAT(error, HasSubstr(param.problem));
  EXPECT_THAT(error, HasSubstr("\n  mend: "));
  EXPECT_THAT(error.substr(std::min(error.find("\n  mend: "), error.size())), HasSubstr(param.mend));
}

constexpr const char* pilot = "ptpe_pilot";
constexpr const char* task1 = "task1";
constexpr const char* task2 = "task2";
constexpr const char* foam = "foam";
constexpr const char* demo = "demo";

const Malformed heads[] = {
    {pilot, "participants = 16", "people = 3\nparticipants = 16", "people = |3", "is not a known key",
     "participants"},
    {pilot, "participants = 16", "participants = 1.5", "= |1.5", "must be a whole number", "fraction"},
    {pilot, "participants = 16", "participants = 0", "= |0", "out of range", "[1, 100000]"},
    {pilot, "format = 2", "format = 1", "format = |1", "neither of the formats", "use the program"},
    {pilot, "format = 2", "format = 4", "format = |4", "neither of the formats", "use the program"},
    {pilot, "name = \"ptpe_pilot\"", "name = \" \"", "name = |\" \"", "is empty", "write a text"},
    {pilot, "language = \"en\"", "", "|# The PTPE", "'language' is missing", "add"},
    {task1, "needs_gaze = true", "needs_gaze = \"yes\"", "= |\"yes", "must be true or false",
     "without quotes"}};
INSTANTIATE_TEST_SUITE_P(Heads, MalformedProtocol, testing::ValuesIn(heads));

const Malformed designs[] = {
    {pilot, "duration_s = 10", "duration_s = \"10\"", "duration_s = |\"10", "must be a number",
     "without quotes"},
    {pilot, "duration_s = 10", "duration_s = -1", "duration_s = |-1", "out of range", "use a value in"},
    {pilot, "mean_fps = [10, 20", "mean_fps = [20, 20", "= |[20, 20", "holds a value twice", "once"},
    {pilot, "[0, 5, 10, 15, 20]", "[60]", "= |[60]", "has no value below any mean_fps", "at least one"},
    {pilot, "[0, 5, 10, 15, 20]", "[0, 5000]", "[0, |5000]", "out of range", "[0, 1000]"},
    {pilot, "method = [\"HiRes\"]", "method = []", "method = |[]", "is empty", "at least one"},
    {pilot, "method = [\"HiRes\"]", "method = [\"HiRes\", \" \"]", "|\" \"]", "is an empty word", "remove"},
    {pilot, "timing = \"settings\"", "timing = \"live\"", "= |\"live", "not a known choice", "\"native\""},
    {pilot, "timing = \"settings\"", "timing = \"equal\"", "= |[10, 20", "more than one setting",
     "one value"},
    {pilot, "timing = \"settings\"", "timing = \"native\"", "= |[10, 20", "has no effect", "remove"},
    {pilot, "timing = \"settings\"", "timing = \"table2\"", "= |[10, 20", "has no effect", "remove"},
    {pilot, "mean_fps = [10, 20, 30, 40, 50]\nsd_fps = [0, 5, 10, 15, 20]\n", "", "|[design]",
     "'design.mean_fps' is missing", "add"},
    {task1, "timing = \"table2\"", "timing = \"settings\"\nmean_fps = [30]\nsd_fps = [0]\n#", "moments = |[",
     "have no effect", "table2"},
    {task1, "n_star = \"16k\", method = \"LoRes\", mean_fps = 55.25",
     "n_star = \"16k\", method = \"Low\", mean_fps = 55.25", "method = |\"Low\"", "names no cell",
     "design.method"},
    {task1, "n_star = \"16k\", method = \"LoRes\", mean_fps = 55.25",
     "n_star = \"64k\", method = \"LoRes\", mean_fps = 55.25", "n_star = |\"64k\"", "names no cell",
     "remove this row"},
    {task1, "n_star = \"16k\", method = \"FovFluid\", mean_fps = 32.68",
     "n_star = \"16k\", method = \"LoRes\", mean_fps = 32.68", "method = |\"LoRes\", mean_fps = 32.68",
     "for the second time", "once"},
    {task1, "mean_fps = 55.25, sd_fps = 6.4", "mean_fps = 55.25, sd_fps = 55.25", "sd_fps = |55.25",
     "is not below mean_fps", "smaller"},
    {task1,
     "  {scene = \"data/scenes/single_dam.toml\", n_star = \"16k\", method = \"LoRes\", mean_fps = "
     "55.25, sd_fps = 6.4},\n",
     "", "timing = |\"table2\"", "needs the moments of LoRes", "[[design.moments]]"},
    {task1, "groups = 2 ", "groups = 4 ", "groups = |4", "more than the 3 scenes",
     "one group for each scene"},
    {task1, "assignment = \"balanced\"", "assignment = \"random\"", "= |\"random", "not a known",
     "paper_random"}};
INSTANTIATE_TEST_SUITE_P(Designs, MalformedProtocol, testing::ValuesIn(designs));

const Malformed orders[] = {
    {pilot, "order = \"shuffle\"", "order = \"random\"", "= |\"random", "not a known choice", "williams"},
    {pilot, "order = \"shuffle\"", "never_adjacent = [\"method\"]\norder = \"shuffle\"", "= |[\"method\"]",
     "needs order", "remove never_adjacent"},
    {pilot, "order = \"shuffle\"", "order = \"constrained\"", "|[design]",
     "'design.never_adjacent' is missing", "add"},
    {pilot, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"sd_fps\", \"scene\"]",
     "|\"scene\"]", "is no factor", "mean_fps"},
    {pilot, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"sd_fps\", \"method\"]",
     "|\"method\"]", "21 of 21 trials have HiRes", "remove this factor"},
    {task2, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"method\"]",
     "order = |\"constrained", "is not supported for pairs", "remove pairs"},
    {pilot, "order = \"shuffle\"", "pairs = true\norder = \"shuffle\"", "\"black 3\", |\"stim",
     "does not say which stimulus of the pair", "stimulus first"},
    {pilot, "mean_fps = [10, 20, 30, 40, 50]\nsd_fps = [0, 5, 10, 15, 20]",
     "pairs = true\nmean_fps = [10]\nsd_fps = [0]", "pairs = |true", "need two cells of one scene",
     "remove pairs"}};
INSTANTIATE_TEST_SUITE_P(Orders, MalformedProtocol, testing::ValuesIn(orders));

const Malformed effects[] = {
    {foam, "\"none\", \"foam\"", "\"none\", \"spray\", \"foam\"", "\"none\", |\"spray", "has no table",
     "[[design.effect_set]]"},
    {foam, "\"none\", \"foam\"", "\"none\", \"none\", \"foam\"", "effects = |[", "a value twice", "once"},
    {foam, "\"none\", \"foam\"", "\"none\", \"much foam\"", ", |\"much foam", "is no id", "a letter"},
    {foam, "name = \"foam\"\nkeep", "name = \"none\"\nkeep", "name = |\"none\"", "needs no table",
     "remove the table"},
    {foam, "name = \"foam\"\nkeep", "name = \"spray\"\nkeep", "name = |\"spray\"", "is no level",
     "design.effects"},
    {foam, "keep = [\"foam\"] ", "keep = [] ", "keep = |[]", "is empty", "at least one"},
    {foam, "keep = [\"foam\"] ", "", "no table\nname = |\"foam\"", "holds no effect", "level \"none\""},
    {foam, "keep = [\"foam\"] ", "keep = [\"foam\"]\neffect = [{kind = \"foam\", emission_per_s = 1}] ",
     "kind = |\"foam\", emi", "is in this set twice", "name the kind once"},
    {foam, "keep = [\"foam\"] ", "effect = [{kind = \"foam\", emission_per_s = -1}] ", "emission_per_s = |-1",
     "out of range", "[0, inf]"},
    {foam, "keep = [\"foam\"] ", "effect = [{kind = \"foam\", emission_per_s = \"much\"}] ",
     "emission_per_s = |\"much", "number", "write"},
    {foam, "effects = [\"none\", \"foam\"]\n", "", "|[[design.effect_set]]",
     "is not used, because the key effects is missing", "effects = [...]"},
    {pilot, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"effects\"]", "|\"effects\"]",
     "is no factor of this design", "effects = [...]"}};
INSTANTIATE_TEST_SUITE_P(Effects, MalformedProtocol, testing::ValuesIn(effects));

const Malformed pacing[] = {
    {pilot, "at_end = \"loop\"", "", "|[content]", "'content.at_end' is missing", "add 'at_end"},
    {pilot, "start_frame = 0", "", "|[content]", "'content.start_frame' is missing", "add"},
    {pilot, "order = \"white\"", "order = \"pink\"", "= |\"pink", "is not a known choice", "\"ar1\""},
    {pilot, "order = \"white\"", "order = \"ar1\"", "|[pacing]", "'pacing.ar1' is missing", "add"},
    {pilot, "order = \"white\"", "ar1 = 0.5", "ar1 = |0.5", "needs order", "remove ar1"},
    {pilot, "order = \"white\"", "order = \"trace\"\ntrace_fps = [30]", "= |[30]", "has fewer than two rates",
     "two rates"},
    {pilot, "max_interval_ms = 250", "max_interval_ms = 200", "ms = |200", "contradicts fps_min = 4",
     "raise max_interval_ms to 250 or fps_min to 5"},
    {pilot, "fps_min = 4 ", "fps_min = 10", "fps_min = |10", "excludes the setting (10, 5)", "lower fps_min"},
    {pilot, "fps_max = \"none\"", "fps_max = 45.5", "= |45.5", "excludes the setting (50, 0)", "raise"},
    {pilot, "fps_max = \"none\"", "fps_max = 3", "= |3", "is below fps_min", "raise"},
    {pilot, "fps_max = \"none\"", "fps_max = \"high\"", "= |\"high", "is not a known choice", "refresh"},
    {pilot, "fail_sd_relative = 0.2", "overrun_s = -1", "overrun_s = |-1", "is out of range", "[0, 3600]"},
    {pilot, "fail_sd_relative = 0.2", "fail_sd_relative = 0.01", "fail_sd_relative = |0.01",
     "is tighter than sd_relative", "at least as wide"}};
INSTANTIATE_TEST_SUITE_P(Pacing, MalformedProtocol, testing::ValuesIn(pacing));

constexpr const char* pilot_steps = "[\"black 3\", \"stimulus\", \"ask satisfaction\"]";
constexpr const char* task2_steps =
    "[\"stimulus first\", \"black 5\", \"stimulus second\", \"black 5\", \"ask preference\", \"rest 60\"]";

const Malformed steps[] = {
    {pilot, pilot_steps, "[\"dark 3\"]", "[|\"dark 3", "is no step", "black SECONDS"},
    {pilot, pilot_steps, "[\"\"]", "[|\"\"]", "is no step", "black SECONDS"},
    {pilot, pilot_steps, "[\"black\"]", "[|\"black", "lacks seconds", "black 3"},
    {pilot, pilot_steps, "[\"black -1\"]", "[|\"black", "lacks seconds", "black 3"},
    {pilot, pilot_steps, "[\"rest nan\"]", "[|\"rest", "lacks seconds", "rest 30"},
    {pilot, pilot_steps, "[\"rest 4000\"]", "[|\"rest", "lacks seconds", "rest 30"},
    {pilot, pilot_steps, "[\"black 3 s\"]", "[|\"black", "has the extra word 's'", "remove"},
    {pilot, pilot_steps, "[\"black 3s\"]", "[|\"black", "has the extra word 's'", "remove"},
    {pilot, pilot_steps, "[\"stimulus first\"]", "[|\"stimulus", "has the extra word 'first'", "remove"},
    {pilot, pilot_steps, "[\"stimulus\", \"ask\"]", ", |\"ask", "asks no question", "ask ID"},
    {pilot, pilot_steps, "[\"stimulus\", \"ask joy\"]", ", |\"ask joy", "not the id of any question",
     "[[block.question]]"},
    {pilot, pilot_steps, "[\"stimulus\", \"ask satisfaction satisfaction\"]", ", |\"ask",
     "for the second time", "once"},
    {pilot, pilot_steps, "[\"stimulus\", \"ask satisfaction\", \"ask take_part\"]", ", |\"ask take_part",
     "of a block of kind consent", "ssq or fms"},
    {pilot, pilot_steps, "[\"stimulus\", \"ask fms\"]", ", |\"ask fms", "not the id of any question",
     "block of kind fms"},
    {pilot, pilot_steps, "[\"ask satisfaction\", \"stimulus\"]", ", |\"stimulus", "comes after a question",
     "after all stimuli"},
    {pilot, pilot_steps, "[\"stimulus\", \"stimulus\", \"ask satisfaction\"]", ", |\"stimulus",
     "out of order", "once"},
    {pilot, pilot_steps, "[\"stimulus\"]", "steps = |[", "ask no question", "ask ID"},
    {pilot, pilot_steps, "[\"ask satisfaction\"]", "steps = |[", "too few stimuli", "add \"stimulus\""},
    {pilot, pilot_steps, "\"stimulus\"", "steps = |\"", "must be a list of texts", "write ["},
    {pilot, pilot_steps, "[\"stimulus\", 3]", ", |3]", "must hold texts", "quotes"},
    {task2, task2_steps, "[\"stimulus\"]", "[|\"stimulus", "does not say which", "first"},
    {task2, task2_steps, "[\"stimulus second\"]", "[|\"stimulus", "out of order", "first, then second"},
    {task2, task2_steps, "[\"stimulus first\", \"ask preference\"]", "steps = |[", "too few stimuli",
     "stimulus second"},
    {task1, "realism disorientation unrealism", "realism disorientation",
     "|[[block.question]]\nid = \"unrealism\"", "is asked by no step", "or remove it"}};
INSTANTIATE_TEST_SUITE_P(Steps, MalformedProtocol, testing::ValuesIn(steps));

const Malformed blocks[] = {
    {pilot, "kind = \"debrief\"", "kind = \"goodbye\"", "= |\"goodbye", "not a known choice", "\"debrief\""},
    {pilot, "id = \"thanks\"", "id = \"welcome\"", "id = |\"welcome\"\ntitle = \"Thank",
     "is the id of another block", "another id"},
    {pilot, "id = \"thanks\"", "id = \"thank you\"", "id = |\"thank you", "is no id", "letters, digits"},
    {pilot, "kind = \"stimulus\"", "kind = \"question\"", "|[[block]]\nkind = \"instructions\"",
     "has 0 blocks of kind stimulus", "exactly one"},
    {pilot, "seconds = 5 ", "seconds = 5000 ", "= |5000", "out of range", "[0, 3600]"},
    {pilot, "seconds = 5 ", "second = 5 ", "= |5", "is not a known key", "seconds"},
    {pilot, "accept = [1, 1]", "", "|[[block.question]]\nid = \"take_part", "lets everybody continue",
     "accept = [1, 1]"},
    {demo, "like = \"ratings\"", "like = \"rating\"", "like = |\"rating\"\n", "is no block of kind stimulus",
     "write the id"},
    {demo, "like = \"ratings\"", "like = \"welcome\"", "like = |\"welcome\"", "is no block of kind stimulus",
     "write the id"},
    {demo, "like = \"ratings\"\ncount = 2", "like = \"ratings\"\ncount = 9", "count = |9",
     "more than the number of trials", "at most 8"},
    {demo, "id = \"attention\"\nlike = \"ratings\"\ncount = 1",
     "id = \"attention\"\nlike = \"ratings\"\ncount = 9", "count = |9", "more than the number of trials",
     "at most 8"},
    {demo, "kind = \"practice\"", "kind = \"repeat\"", "id = \"warm_up\"\nlike = |\"ratings\"",
     "names a later block", "after what they repeat"},
    {demo, "kind = \"repeat\"", "kind = \"practice\"", "id = \"again\"\nlike = |\"ratings\"",
     "names an earlier block", "before what it prepares"},
    {demo, "count = 1", "count = 0", "count = |0", "out of range", "[1, 1000]"},
    {demo, "stop_at = 12", "stop_at = 12\n\n[[block]]\nkind = \"fms\"\nid = \"late\"\nstop_at = 15",
     "stop_at = |15", "differs from that of block \"sickness\"", "same stop_at"},
    {demo, "language = \"en\"", "language = \"de\"", "kind = |\"fms\"", "is available in English only",
     "[[block.question]]"},
    {task1, "groups = 2 ", "groups = 1 ", "between_groups_s = |120", "has no effect", "remove it"}};
INSTANTIATE_TEST_SUITE_P(Blocks, MalformedProtocol, testing::ValuesIn(blocks));

const Malformed questions[] = {
    {pilot, "id = \"satisfaction\"", "id = \"take_part\"",
     "|[[block.question]]\nid = \"take_part\"\nkind = \"scale\"", "of another question", "another id"},
    {pilot, "id = \"satisfaction\"", "id = \"fms\"", "id = |\"fms", "is reserved for", "another id"},
    {pilot, "id = \"satisfaction\"", "id = \"ssq_1\"", "id = |\"ssq_1", "is reserved for", "another id"},
    {pilot, "7 = \"very satisfied\"", "3 = \"very satisfied\"", "3 = |\"very", "does not ascend",
     "ascending"},
    {pilot, "7 = \"very satisfied\"", "8 = \"very satisfied\"", "8 = |\"very", "is not a score",
     "from 1 to 7"},
    {pilot, "7 = \"very satisfied\"", "\"\" = \"very satisfied\"", "anchors = |{1 = \"very", "is not a score",
     "from 1 to 7"},
    {pilot, "7 = \"very satisfied\"", "\"7x\" = \"very satisfied\"", "= |\"very sat", "is not a score",
     "from 1 to 7"},
    {pilot, "7 = \"very satisfied\"", "99999999999999999999 = \"very satisfied\"", "= |\"very sat",
     "is not a score", "from 1 to 7"},
    {pilot, "scale = [1, 7]", "scale = [7, 1]", "scale = |[7", "does not ascend", "[low, high]"},
    {pilot, "scale = [1, 7]", "scale = [1, 7.5]", "scale = |[1", "must hold whole numbers", "fraction"},
    {pilot, "scale = [1, 7]", "scale = [1, 700]", "scale = |[1", "more than 101 scores", "number"},
    {pilot, "{0 = \"no\", 1 = \"yes\"}", "{1 = \"yes\"}", "= |{1", "fewer than two answers", "anchors"},
    {pilot, "{0 = \"no\", 1 = \"yes\"}", "{0 = \"no\", 2 = \"yes\"}", "accept = |[1, 1]",
     "includes none of the answers", "anchors"},
    {pilot, "accept = [1, 1]", "accept = [1, 0]", "accept = |[1, 0]", "does not ascend", "[low, high]"},
    {pilot, "accept = [1, 1]", "accept = [1, 2]", "accept = [1, |2]", "out of range", "[0, 1]"},
    {pilot, "accept = [1, 1]", "required = false\naccept = [1, 1]", "accept = |[1, 1]",
     "contradicts required", "remove"},
    {pilot, "scale = [1, 7]", "scale = [1, 7]\naccept = [1, 7]", "accept = |[1, 7]",
     "not allowed in a block of kind stimulus", "consent"},
    {pilot, "scale = [1, 7]", "scale = [1, 7]\nexpect = 3", "expect = |3",
     "not allowed in a block of kind stimulus", "kind catch"},
    {pilot, "scale = [1, 7]", "scale = [1, 7]\npersonal = true", "personal = |true",
     "not allowed in a block of kind stimulus", "demographics"},
    {pilot, "scale = [1, 7]", "scale = [1, 7]\nstop_at = 8", "stop_at = |8", "out of range", "[1, 7]"},
    {pilot, "kind = \"scale\"", "kind = \"text\"", "anchors = |{1 = \"very", "is not a known key",
     "required"},
    {demo, "expect = 2", "", "|[[block.question]]\nid = \"attention_check\"", "expect' is missing",
     "attentive participant"},
    {demo, "expect = 2", "expect = 2\nrequired = false", "required = |false", "would let participants skip",
     "remove"},
    {demo, "id = \"attention_check\"\nkind = \"scale\"", "id = \"attention_check\"\nkind = \"text\"",
     "kind = |\"text\"\ntext = \"Please", "has no score, and a question in a block of kind catch",
     "scale, choice, number, vas"},
    {answers, "level = 60", "scale = [0, 1001]", "scale = |[0, 1001]", "ends above 1000", "at most"},
    {answers, "100 = \"entirely\"", "50 = \"half\", 100 = \"entirely\"", "anchors = |{0 = \"not at all\"",
     "two ends of the line", "for 0 and 100"},
    {answers, "anchors = {0 = \"not at all\", 100 = \"entirely\"}", "",
     "|[[block.question]]\nid = \"satisfaction\"", "two ends of the line", "for 0 and 100"},
    {answers, "text = \"Did the motion stall?\"", "text = \"Halte?\"\nlanguage = \"fr\"",
     "|[[block.question]]\nid = \"stalled\"", "known in English and German only", "language \"fr\""},
    {answers, "text = \"Did the motion stall?\"", "text = \"Did it?\"\nanchors = {1 = \"yes\", 2 = \"no\"}",
     "2 = |\"no\"", "not a score", "0 to 1"},
    {answers, "timeout_s = 2", "timeout_s = 0", "timeout_s = |0", "out of range", "[0.1, 60]"},
    {answers, "kind = \"yes_no\"\ntext = \"Did", "kind = \"yes_no\"\ntimeout_s = 2\ntext = \"Did",
     "timeout_s = |2\ntext", "is not a known key", ""},
    {answers, "\"ask fast\", \"ask satisfaction", "\"ask fast satisfaction", "|\"ask fast satisfaction",
     "a reaction, together with others", "page of its own"},
    {answers, "kind = \"number\"\ntext = \"How old are you?\"\nscale = [10, 110]",
     "kind = \"reaction\"\ntext = \"Now!\"", "|[[block.question]]\nid = \"age\"", "shares its page",
     "page of its own"}};
INSTANTIATE_TEST_SUITE_P(Questions, MalformedProtocol, testing::ValuesIn(questions));

TEST(Protocol, BrokenSyntaxNamesThePlace) {
  const std::string error = error_of(replaced(shipped_text(pilot), "duration_s = 10", "duration_s = = 10"));
  EXPECT_THAT(error, testing::MatchesRegex("p\\.toml:[0-9]+:[0-9]+: [^\n]+\n  mend: .+"));
}

constexpr const char* gaze_box =
    "id = \"gaze_kept\"\nkind = \"choice\"\ntext = \"Where I look may be recorded.\"\nanchors = {0 = \"no\", "
    "1 = \"yes\"}";

constexpr const char* at_gaze_box = "|[[block.question]]\nid = \"gaze_kept\"";
constexpr const char* as_obeyed = "kind = \"choice\" and anchors = {0 = \"no\", 1 = \"yes\"}";

/// Questions whose answers the program acts on.
const Malformed obeyed[] = {
    {task1, "id = \"take_part\"", "id = \"data_shared\"\npersonal = true",
     "|[[block.question]]\nid = \"data_shared\"", "\"data_shared\" is personal", "without personal"},
    {task1, gaze_box, "id = \"gaze_kept\"\nkind = \"scale\"\ntext = \"Look\"\nscale = [0, 1]", at_gaze_box,
     "\"gaze_kept\" is not of kind choice", as_obeyed},
    {task1, gaze_box,
     "id = \"gaze_kept\"\nkind = \"choice\"\ntext = \"Look\"\nanchors = {1 = \"no\", 2 = \"yes\"}",
     at_gaze_box, "has other answers than 0 and 1", as_obeyed},
    {pilot, "id = \"satisfaction\"", "id = \"data_shared\"", "|[[block.question]]\nid = \"data_shared\"",
     "is in a block of kind stimulus", "in a block of kind consent"}};
INSTANTIATE_TEST_SUITE_P(Obeyed, MalformedProtocol, testing::ValuesIn(obeyed));

/// Earlier versions accepted these questions in other forms, here as a scale. A database may hold a protocol
/// with such a question, and resuming and reading it must still work.
TEST(StoredProtocol, MayAskThemAsEarlierVersionsDid) {
  const std::string text = replaced(shipped_text(task1), gaze_box,
                                    "id = \"gaze_kept\"\nkind = \"scale\"\ntext = \"Look\"\nscale = [0, 1]");
  EXPECT_EQ(study::parse_protocol(text, "p.toml", study::ProtocolUse::Stored).blocks.size(), 4u);
}

// Names that the program must know: without these checks a wrong name would be noticed only after the study.
const Malformed names[] = {
    {task1, "\"Ours\", \"Ours-TSp\"", "\"ours\", \"Ours-TSp\"", "|\"ours\"", "is no method",
     "the nearest is \"Ours\""},
    {pilot, "method = [\"HiRes\"]", "method = [\"Bogus\"]", "|\"Bogus\"", "is no method",
     "use one of \"LoRes\""},
    {pilot, "n_star = [\"32k\"]", "n_star = [\"32K!\"]", "|\"32K!\"", "is no number of particles", "\"32k\""},
    {pilot, "order = \"shuffle\"", "order = \"shufle\"", "= |\"shufle\"", "is not a known choice",
     "the nearest is \"shuffle\""},
    {pilot, "participants = 16", "participants = 16\naccept_aproximate = true", "accept_aproximate = |true",
     "is not a known key", "the nearest is accept_approximate"},
    {pilot, "\"ask satisfaction\"", "\"ask satisfacton\"", "|\"ask satisfacton\"",
     "which is not the id of any question", "ask \"satisfaction\" if you mean it"},
    {task1, "ask realism", "ask realsm", "|\"ask realsm", "which is not the id of any question",
     "ask \"realism\" if you mean it"},
    {pilot, "scale = [1, 7]", "scale = [1, 7]\nlevel = 7", "level = |7",
     "does not lie between the ends of the scale, 1 and 7", "above 1 and below 7"}};
INSTANTIATE_TEST_SUITE_P(Names, MalformedProtocol, testing::ValuesIn(names));

// An analysis looks for a question by its exact id.
TEST(ProtocolNames, AnIdThatIsNearlyOneThatAnalysesLookForIsRefused) {
  const auto renamed = [](std::string text, const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  EXPECT_THAT(error_of(renamed(shipped_text("task1"), "realism", "realsim")),
              HasSubstr("write \"realism\" if you mean it"));
  EXPECT_THAT(error_of(renamed(shipped_text("task1_lab"), "data_shared", "data_share")),
              HasSubstr("\"data_shared\""));
  // An id that resembles another one of the protocol is a separate question.
  EXPECT_EQ(error_of(renamed(shipped_text("task1"), "dizziness", "dizzy")), "(no error)");
  // Protocols stored before names were checked are still read.
  EXPECT_NO_THROW(study::parse_protocol(replaced(shipped_text(pilot), "[\"HiRes\"]", "[\"Bogus\"]"), "p.toml",
                                        study::ProtocolUse::Stored));
}

}  // namespace
