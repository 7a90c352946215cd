/// Every mistake in a protocol is reported at its own place, with a remedy.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "libstudy/protocol/protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"

namespace {

using testing::HasSubstr;

std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const auto at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? text : text.replace(at, from.size(), to);
}

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

struct Malformed {
  const char* protocol;  // name of a shipped protocol
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
      base::read_file(base::resource("protocols/" + std::string(param.protocol) + ".toml"), 1 << 20);
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

INSTANTIATE_TEST_SUITE_P(
    Heads, MalformedProtocol,
    testing::Values(
        Malformed{pilot, "participants = 16", "people = 3\nparticipants = 16", "people = |3",
                  "is not a known key", "participants"},
        Malformed{pilot, "participants = 16", "participants = 1.5", "= |1.5", "must be a whole number",
                  "fraction"},
        Malformed{pilot, "participants = 16", "participants = 0", "= |0", "out of range", "[1, 100000]"},
        Malformed{pilot, "format = 2", "format = 1", "format = |1", "is not the format", "use the program"},
        Malformed{pilot, "format = 2", "format = 3", "format = |3", "is not the format", "use the program"},
        Malformed{pilot, "name = \"ptpe_pilot\"", "name = \" \"", "name = |\" \"", "is empty",
                  "write a text"},
        Malformed{pilot, "language = \"en\"", "", "|# The PTPE", "'language' is missing", "add"},
        Malformed{task1, "needs_gaze = true", "needs_gaze = \"yes\"", "= |\"yes", "must be true or false",
                  "without quotes"}));

INSTANTIATE_TEST_SUITE_P(
    Designs, MalformedProtocol,
    testing::Values(
        Malformed{pilot, "duration_s = 10", "duration_s = \"10\"", "duration_s = |\"10", "must be a number",
                  "without quotes"},
        Malformed{pilot, "duration_s = 10", "duration_s = -1", "duration_s = |-1", "out of range",
                  "use a value in"},
        Malformed{pilot, "mean_fps = [10, 20", "mean_fps = [20, 20", "= |[20, 20", "holds a value twice",
                  "once"},
        Malformed{pilot, "[0, 5, 10, 15, 20]", "[60]", "= |[60]", "has no value below any mean_fps",
                  "at least one"},
        Malformed{pilot, "[0, 5, 10, 15, 20]", "[0, 5000]", "[0, |5000]", "out of range", "[0, 1000]"},
        Malformed{pilot, "method = [\"HiRes\"]", "method = []", "method = |[]", "is empty", "at least one"},
        Malformed{pilot, "method = [\"HiRes\"]", "method = [\"HiRes\", \" \"]", "|\" \"]", "is an empty word",
                  "remove"},
        Malformed{pilot, "timing = \"settings\"", "timing = \"live\"", "= |\"live", "not a known choice",
                  "\"native\""},
        Malformed{pilot, "timing = \"settings\"", "timing = \"equal\"", "= |[10, 20", "more than one setting",
                  "one value"},
        Malformed{pilot, "timing = \"settings\"", "timing = \"native\"", "= |[10, 20", "has no effect",
                  "remove"},
        Malformed{pilot, "timing = \"settings\"", "timing = \"table2\"", "= |[10, 20", "has no effect",
                  "remove"},
        Malformed{pilot, "mean_fps = [10, 20, 30, 40, 50]\nsd_fps = [0, 5, 10, 15, 20]\n", "", "|[design]",
                  "'design.mean_fps' is missing", "add"},
        Malformed{task1, "timing = \"table2\"", "timing = \"settings\"\nmean_fps = [30]\nsd_fps = [0]\n#",
                  "moments = |[", "have no effect", "table2"},
        Malformed{task1, "n_star = \"16k\", method = \"LoRes\", mean_fps = 55.25",
                  "n_star = \"16k\", method = \"Low\", mean_fps = 55.25", "method = |\"Low\"",
                  "names no cell", "design.method"},
        Malformed{task1, "n_star = \"16k\", method = \"LoRes\", mean_fps = 55.25",
                  "n_star = \"64k\", method = \"LoRes\", mean_fps = 55.25", "n_star = |\"64k\"",
                  "names no cell", "remove this row"},
        Malformed{task1, "n_star = \"16k\", method = \"FovFluid\", mean_fps = 32.68",
                  "n_star = \"16k\", method = \"LoRes\", mean_fps = 32.68",
                  "method = |\"LoRes\", mean_fps = 32.68", "for the second time", "once"},
        Malformed{task1, "mean_fps = 55.25, sd_fps = 6.4", "mean_fps = 55.25, sd_fps = 55.25",
                  "sd_fps = |55.25", "is not below mean_fps", "smaller"},
        Malformed{
            task1,
            "  {scene = \"data/scenes/single_dam.toml\", n_star = \"16k\", method = \"LoRes\", mean_fps = "
            "55.25, sd_fps = 6.4},\n",
            "", "timing = |\"table2\"", "needs the moments of LoRes", "[[design.moments]]"},
        Malformed{task1, "groups = 2 ", "groups = 4 ", "groups = |4", "more than the 3 scenes",
                  "one group for each scene"},
        Malformed{task1, "assignment = \"balanced\"", "assignment = \"random\"", "= |\"random", "not a known",
                  "paper_random"}));

INSTANTIATE_TEST_SUITE_P(
    Orders, MalformedProtocol,
    testing::Values(Malformed{pilot, "order = \"shuffle\"", "order = \"random\"", "= |\"random",
                              "not a known choice", "williams"},
                    Malformed{pilot, "order = \"shuffle\"",
                              "never_adjacent = [\"method\"]\norder = \"shuffle\"", "= |[\"method\"]",
                              "needs order", "remove never_adjacent"},
                    Malformed{pilot, "order = \"shuffle\"", "order = \"constrained\"", "|[design]",
                              "'design.never_adjacent' is missing", "add"},
                    Malformed{pilot, "order = \"shuffle\"",
                              "order = \"constrained\"\nnever_adjacent = [\"sd_fps\", \"scene\"]",
                              "|\"scene\"]", "is no factor", "mean_fps"},
                    Malformed{pilot, "order = \"shuffle\"",
                              "order = \"constrained\"\nnever_adjacent = [\"sd_fps\", \"method\"]",
                              "|\"method\"]", "21 of 21 trials have HiRes", "remove this factor"},
                    Malformed{task2, "order = \"shuffle\"",
                              "order = \"constrained\"\nnever_adjacent = [\"method\"]",
                              "order = |\"constrained", "is not supported for pairs", "remove pairs"},
                    Malformed{pilot, "order = \"shuffle\"", "pairs = true\norder = \"shuffle\"",
                              "\"black 3\", |\"stim", "does not say which of the pair", "stimulus first"},
                    Malformed{pilot, "mean_fps = [10, 20, 30, 40, 50]\nsd_fps = [0, 5, 10, 15, 20]",
                              "pairs = true\nmean_fps = [10]\nsd_fps = [0]", "pairs = |true",
                              "need two cells of one scene", "remove pairs"}));

INSTANTIATE_TEST_SUITE_P(
    Effects, MalformedProtocol,
    testing::Values(
        Malformed{foam, "\"none\", \"foam\"", "\"none\", \"spray\", \"foam\"", "\"none\", |\"spray",
                  "has no table", "[[design.effect_set]]"},
        Malformed{foam, "\"none\", \"foam\"", "\"none\", \"none\", \"foam\"", "effects = |[", "a value twice",
                  "once"},
        Malformed{foam, "\"none\", \"foam\"", "\"none\", \"much foam\"", ", |\"much foam", "is no id",
                  "a letter"},
        Malformed{foam, "name = \"foam\"\nkeep", "name = \"none\"\nkeep", "name = |\"none\"",
                  "needs no table", "remove the table"},
        Malformed{foam, "name = \"foam\"\nkeep", "name = \"spray\"\nkeep", "name = |\"spray\"", "is no level",
                  "design.effects"},
        Malformed{foam, "keep = [\"foam\"] ", "keep = [] ", "keep = |[]", "is empty", "at least one"},
        Malformed{foam, "keep = [\"foam\"] ", "", "no table\nname = |\"foam\"", "holds no effect",
                  "level \"none\""},
        Malformed{foam, "keep = [\"foam\"] ",
                  "keep = [\"foam\"]\neffect = [{kind = \"foam\", emission_per_s = 1}] ",
                  "kind = |\"foam\", emi", "is in this set twice", "name the kind once"},
        Malformed{foam, "keep = [\"foam\"] ", "effect = [{kind = \"foam\", emission_per_s = -1}] ",
                  "emission_per_s = |-1", "out of range", "[0, inf]"},
        Malformed{foam, "keep = [\"foam\"] ", "effect = [{kind = \"foam\", emission_per_s = \"much\"}] ",
                  "emission_per_s = |\"much", "number", "write"},
        Malformed{foam, "effects = [\"none\", \"foam\"]\n", "", "|[[design.effect_set]]",
                  "has no effect without the key effects", "effects = [...]"},
        Malformed{pilot, "order = \"shuffle\"", "order = \"constrained\"\nnever_adjacent = [\"effects\"]",
                  "|\"effects\"]", "is no factor of this design", "effects = [...]"}));

INSTANTIATE_TEST_SUITE_P(
    Pacing, MalformedProtocol,
    testing::Values(
        Malformed{pilot, "at_end = \"loop\"", "", "|[content]", "'content.at_end' is missing", "add 'at_end"},
        Malformed{pilot, "start_frame = 0", "", "|[content]", "'content.start_frame' is missing", "add"},
        Malformed{pilot, "order = \"white\"", "order = \"pink\"", "= |\"pink", "is not a known choice",
                  "\"ar1\""},
        Malformed{pilot, "order = \"white\"", "order = \"ar1\"", "|[pacing]", "'pacing.ar1' is missing",
                  "add"},
        Malformed{pilot, "order = \"white\"", "ar1 = 0.5", "ar1 = |0.5", "needs order", "remove ar1"},
        Malformed{pilot, "order = \"white\"", "order = \"trace\"\ntrace_fps = [30]", "= |[30]",
                  "is too short", "two rates"},
        Malformed{pilot, "max_interval_ms = 250", "max_interval_ms = 200", "ms = |200",
                  "contradicts fps_min = 4", "raise max_interval_ms to 250 or fps_min to 5"},
        Malformed{pilot, "fps_min = 4 ", "fps_min = 10", "fps_min = |10", "leaves no room for (10, 5)",
                  "lower fps_min"},
        Malformed{pilot, "fps_max = \"none\"", "fps_max = 45.5", "= |45.5", "leaves no room for (50, 0)",
                  "raise"},
        Malformed{pilot, "fps_max = \"none\"", "fps_max = 3", "= |3", "is below fps_min", "raise"},
        Malformed{pilot, "fps_max = \"none\"", "fps_max = \"high\"", "= |\"high", "is not a known choice",
                  "refresh"},
        Malformed{pilot, "fail_sd_relative = 0.2", "overrun_s = -1", "overrun_s = |-1", "is out of range",
                  "[0, 3600]"},
        Malformed{pilot, "fail_sd_relative = 0.2", "fail_sd_relative = 0.01", "fail_sd_relative = |0.01",
                  "is tighter than sd_relative", "at least as wide"}));

constexpr const char* pilot_steps = "[\"black 3\", \"stimulus\", \"ask satisfaction\"]";
constexpr const char* task2_steps =
    "[\"stimulus first\", \"black 5\", \"stimulus second\", \"black 5\", \"ask preference\", \"rest 60\"]";

INSTANTIATE_TEST_SUITE_P(
    Steps, MalformedProtocol,
    testing::Values(
        Malformed{pilot, pilot_steps, "[\"dark 3\"]", "[|\"dark 3", "is no step", "black SECONDS"},
        Malformed{pilot, pilot_steps, "[\"\"]", "[|\"\"]", "is no step", "black SECONDS"},
        Malformed{pilot, pilot_steps, "[\"black\"]", "[|\"black", "lacks seconds", "black 3"},
        Malformed{pilot, pilot_steps, "[\"black -1\"]", "[|\"black", "lacks seconds", "black 3"},
        Malformed{pilot, pilot_steps, "[\"rest nan\"]", "[|\"rest", "lacks seconds", "rest 30"},
        Malformed{pilot, pilot_steps, "[\"rest 4000\"]", "[|\"rest", "lacks seconds", "rest 30"},
        Malformed{pilot, pilot_steps, "[\"black 3 s\"]", "[|\"black", "has the extra word 's'", "remove"},
        Malformed{pilot, pilot_steps, "[\"black 3s\"]", "[|\"black", "has the extra word 's'", "remove"},
        Malformed{pilot, pilot_steps, "[\"stimulus first\"]", "[|\"stimulus", "has the extra word 'first'",
                  "remove"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"ask\"]", ", |\"ask", "asks no question", "ask ID"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"ask joy\"]", ", |\"ask joy",
                  "not the id of any question", "[[block.question]]"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"ask satisfaction satisfaction\"]", ", |\"ask",
                  "for the second time", "once"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"ask satisfaction\", \"ask take_part\"]",
                  ", |\"ask take_part", "of a block of kind consent", "ssq or fms"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"ask fms\"]", ", |\"ask fms",
                  "not the id of any question", "block of kind fms"},
        Malformed{pilot, pilot_steps, "[\"ask satisfaction\", \"stimulus\"]", ", |\"stimulus",
                  "comes after a question", "after all stimuli"},
        Malformed{pilot, pilot_steps, "[\"stimulus\", \"stimulus\", \"ask satisfaction\"]", ", |\"stimulus",
                  "out of order", "once"},
        Malformed{pilot, pilot_steps, "[\"stimulus\"]", "steps = |[", "ask nothing", "ask ID"},
        Malformed{pilot, pilot_steps, "[\"ask satisfaction\"]", "steps = |[", "too few stimuli",
                  "add \"stimulus\""},
        Malformed{pilot, pilot_steps, "\"stimulus\"", "steps = |\"", "must be a list of texts", "write ["},
        Malformed{pilot, pilot_steps, "[\"stimulus\", 3]", ", |3]", "must hold texts", "quotes"},
        Malformed{task2, task2_steps, "[\"stimulus\"]", "[|\"stimulus", "does not say which", "first"},
        Malformed{task2, task2_steps, "[\"stimulus second\"]", "[|\"stimulus", "out of order",
                  "first, then second"},
        Malformed{task2, task2_steps, "[\"stimulus first\", \"ask preference\"]", "steps = |[",
                  "too few stimuli", "stimulus second"},
        Malformed{task1, "realism disorientation unrealism", "realism disorientation",
                  "|[[block.question]]\nid = \"unrealism\"", "is asked by no step", "or remove it"}));

INSTANTIATE_TEST_SUITE_P(
    Blocks, MalformedProtocol,
    testing::Values(
        Malformed{pilot, "kind = \"debrief\"", "kind = \"goodbye\"", "= |\"goodbye", "not a known choice",
                  "\"debrief\""},
        Malformed{pilot, "id = \"thanks\"", "id = \"welcome\"", "id = |\"welcome\"\ntitle = \"Thank",
                  "is the id of another block", "another id"},
        Malformed{pilot, "id = \"thanks\"", "id = \"thank you\"", "id = |\"thank you", "is no id",
                  "letters, digits"},
        Malformed{pilot, "kind = \"stimulus\"", "kind = \"question\"", "|[[block]]\nkind = \"instructions\"",
                  "has 0 blocks of kind stimulus", "exactly one"},
        Malformed{pilot, "seconds = 5 ", "seconds = 5000 ", "= |5000", "out of range", "[0, 3600]"},
        Malformed{pilot, "seconds = 5 ", "second = 5 ", "= |5", "is not a known key", "seconds"},
        Malformed{pilot, "accept = [1, 1]", "", "|[[block.question]]\nid = \"take_part",
                  "lets everybody continue", "accept = [1, 1]"},
        Malformed{demo, "like = \"ratings\"", "like = \"rating\"", "like = |\"rating\"\n",
                  "is no block of kind stimulus", "write the id"},
        Malformed{demo, "like = \"ratings\"", "like = \"welcome\"", "like = |\"welcome\"",
                  "is no block of kind stimulus", "write the id"},
        Malformed{demo, "like = \"ratings\"\ncount = 2", "like = \"ratings\"\ncount = 9", "count = |9",
                  "more than the number of trials", "at most 8"},
        Malformed{demo, "id = \"attention\"\nlike = \"ratings\"\ncount = 1",
                  "id = \"attention\"\nlike = \"ratings\"\ncount = 9", "count = |9",
                  "more than the number of trials", "at most 8"},
        Malformed{demo, "kind = \"practice\"", "kind = \"repeat\"", "id = \"warm_up\"\nlike = |\"ratings\"",
                  "names a later block", "after what they repeat"},
        Malformed{demo, "kind = \"repeat\"", "kind = \"practice\"", "id = \"again\"\nlike = |\"ratings\"",
                  "names an earlier block", "before what it prepares"},
        Malformed{demo, "count = 1", "count = 0", "count = |0", "out of range", "[1, 1000]"},
        Malformed{demo, "stop_at = 12",
                  "stop_at = 12\n\n[[block]]\nkind = \"fms\"\nid = \"late\"\nstop_at = 15", "stop_at = |15",
                  "differs from that of block \"sickness\"", "same stop_at"},
        Malformed{demo, "language = \"en\"", "language = \"de\"", "kind = |\"fms\"",
                  "is available in English only", "[[block.question]]"},
        Malformed{task1, "groups = 2 ", "groups = 1 ", "between_groups_s = |120", "has no effect",
                  "remove it"}));

INSTANTIATE_TEST_SUITE_P(
    Questions, MalformedProtocol,
    testing::Values(
        Malformed{pilot, "id = \"satisfaction\"", "id = \"take_part\"",
                  "|[[block.question]]\nid = \"take_part\"\nkind = \"scale\"", "of another question",
                  "another id"},
        Malformed{pilot, "id = \"satisfaction\"", "id = \"fms\"", "id = |\"fms", "is reserved for",
                  "another id"},
        Malformed{pilot, "id = \"satisfaction\"", "id = \"ssq_1\"", "id = |\"ssq_1", "is reserved for",
                  "another id"},
        Malformed{pilot, "7 = \"very satisfied\"", "3 = \"very satisfied\"", "3 = |\"very", "does not ascend",
                  "ascending"},
        Malformed{pilot, "7 = \"very satisfied\"", "8 = \"very satisfied\"", "8 = |\"very", "is not a score",
                  "from 1 to 7"},
        Malformed{pilot, "7 = \"very satisfied\"", "\"\" = \"very satisfied\"", "anchors = |{1 = \"very",
                  "is not a score", "from 1 to 7"},
        Malformed{pilot, "7 = \"very satisfied\"", "\"7x\" = \"very satisfied\"", "= |\"very sat",
                  "is not a score", "from 1 to 7"},
        Malformed{pilot, "7 = \"very satisfied\"", "99999999999999999999 = \"very satisfied\"",
                  "= |\"very sat", "is not a score", "from 1 to 7"},
        Malformed{pilot, "scale = [1, 7]", "scale = [7, 1]", "scale = |[7", "does not ascend", "[low, high]"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 7.5]", "scale = |[1", "must hold whole numbers",
                  "fraction"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 700]", "scale = |[1", "more than 101 scores",
                  "number"},
        Malformed{pilot, "{0 = \"no\", 1 = \"yes\"}", "{1 = \"yes\"}", "= |{1", "fewer than two answers",
                  "anchors"},
        Malformed{pilot, "{0 = \"no\", 1 = \"yes\"}", "{0 = \"no\", 2 = \"yes\"}", "accept = |[1, 1]",
                  "includes none of the answers", "anchors"},
        Malformed{pilot, "accept = [1, 1]", "accept = [1, 0]", "accept = |[1, 0]", "does not ascend",
                  "[low, high]"},
        Malformed{pilot, "accept = [1, 1]", "accept = [1, 2]", "accept = [1, |2]", "out of range", "[0, 1]"},
        Malformed{pilot, "accept = [1, 1]", "required = false\naccept = [1, 1]", "accept = |[1, 1]",
                  "contradicts required", "remove"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 7]\naccept = [1, 7]", "accept = |[1, 7]",
                  "not allowed in a block of kind stimulus", "consent"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 7]\nexpect = 3", "expect = |3",
                  "not allowed in a block of kind stimulus", "kind catch"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 7]\npersonal = true", "personal = |true",
                  "not allowed in a block of kind stimulus", "demographics"},
        Malformed{pilot, "scale = [1, 7]", "scale = [1, 7]\nstop_at = 8", "stop_at = |8", "out of range",
                  "[1, 7]"},
        Malformed{pilot, "kind = \"scale\"", "kind = \"text\"", "anchors = |{1 = \"very",
                  "is not a known key", "required"},
        Malformed{demo, "expect = 2", "", "|[[block.question]]\nid = \"attention_check\"",
                  "expect' is missing", "attentive participant"},
        Malformed{demo, "expect = 2", "expect = 2\nrequired = false", "required = |false",
                  "would let participants skip", "remove"},
        Malformed{demo, "id = \"attention_check\"\nkind = \"scale\"",
                  "id = \"attention_check\"\nkind = \"text\"", "kind = |\"text\"\ntext = \"Please",
                  "no score to expect", "scale, choice or number"}));

TEST(Protocol, BrokenSyntaxNamesThePlace) {
  const std::string whole = base::read_file(base::resource("protocols/ptpe_pilot.toml"), 1 << 20);
  const std::string error = error_of(replaced(whole, "duration_s = 10", "duration_s = = 10"));
  EXPECT_THAT(error, testing::MatchesRegex("p\\.toml:[0-9]+:[0-9]+: [^\n]+\n  mend: .+"));
}

constexpr const char* gaze_box =
    "id = \"gaze_kept\"\nkind = \"choice\"\ntext = \"Where I look may be recorded.\"\nanchors = {0 = \"no\", "
    "1 = \"yes\"}";

constexpr const char* at_gaze_box = "|[[block.question]]\nid = \"gaze_kept\"";
constexpr const char* as_obeyed = "kind = \"choice\" and anchors = {0 = \"no\", 1 = \"yes\"}";

/// Questions whose answers the program acts on.
INSTANTIATE_TEST_SUITE_P(
    Obeyed, MalformedProtocol,
    testing::Values(
        Malformed{task1, "id = \"take_part\"", "id = \"data_shared\"\npersonal = true",
                  "|[[block.question]]\nid = \"data_shared\"", "\"data_shared\" is personal",
                  "without personal"},
        Malformed{task1, gaze_box, "id = \"gaze_kept\"\nkind = \"scale\"\ntext = \"Look\"\nscale = [0, 1]",
                  at_gaze_box, "\"gaze_kept\" is not of kind choice", as_obeyed},
        Malformed{
            task1, gaze_box,
            "id = \"gaze_kept\"\nkind = \"choice\"\ntext = \"Look\"\nanchors = {1 = \"no\", 2 = \"yes\"}",
            at_gaze_box, "has other answers than 0 and 1", as_obeyed},
        Malformed{pilot, "id = \"satisfaction\"", "id = \"data_shared\"",
                  "|[[block.question]]\nid = \"data_shared\"", "is in a block of kind stimulus",
                  "in a block of kind consent"}));

/// A database may hold such protocols: resuming and reading it must still work.
TEST(StoredProtocol, MayAskThemAsEarlierVersionsDid) {
  const std::string whole = base::read_file(base::resource("protocols/task1.toml"), 1 << 20);
  const std::string text =
      replaced(whole, gaze_box, "id = \"gaze_kept\"\nkind = \"scale\"\ntext = \"Look\"\nscale = [0, 1]");
  EXPECT_EQ(study::parse_protocol(text, "p.toml", study::ProtocolUse::Stored).blocks.size(), 4u);
}

// Without these checks a wrong name would be noticed only after the study.
INSTANTIATE_TEST_SUITE_P(
    Names, MalformedProtocol,
    testing::Values(Malformed{task1, "\"Ours\", \"Ours-TSp\"", "\"ours\", \"Ours-TSp\"", "|\"ours\"",
                              "is no method", "the nearest is \"Ours\""},
                    Malformed{pilot, "method = [\"HiRes\"]", "method = [\"Bogus\"]", "|\"Bogus\"",
                              "is no method", "use one of \"LoRes\""},
                    Malformed{pilot, "n_star = [\"32k\"]", "n_star = [\"32K!\"]", "|\"32K!\"",
                              "is no number of particles", "\"32k\""},
                    Malformed{pilot, "order = \"shuffle\"", "order = \"shufle\"", "= |\"shufle\"",
                              "is not a known choice", "the nearest is \"shuffle\""},
                    Malformed{pilot, "participants = 16", "participants = 16\naccept_aproximate = true",
                              "accept_aproximate = |true", "is not a known key",
                              "the nearest is accept_approximate"},
                    Malformed{pilot, "\"ask satisfaction\"", "\"ask satisfacton\"", "|\"ask satisfacton\"",
                              "which is not the id of any question", "ask \"satisfaction\" if you mean it"},
                    Malformed{task1, "ask realism", "ask realsm", "|\"ask realsm",
                              "which is not the id of any question", "ask \"realism\" if you mean it"},
                    Malformed{pilot, "scale = [1, 7]", "scale = [1, 7]\nlevel = 7", "level = |7",
                              "does not lie between the ends of the scale, 1 and 7", "above 1 and below 7"}));

// An analysis looks for a question by its exact id.
TEST(ProtocolNames, AnIdThatIsNearlyOneThatAnalysesLookForIsRefused) {
  const auto of = [](const char* name) {
    return base::read_file(base::resource("protocols/" + std::string(name) + ".toml"), 1 << 20);
  };
  const auto renamed = [](std::string text, const std::string& from, const std::string& to) {
    for (auto at = text.find(from); at != std::string::npos; at = text.find(from, at + to.size()))
      text.replace(at, from.size(), to);
    return text;
  };
  EXPECT_THAT(error_of(renamed(of("task1"), "realism", "realsim")),
              HasSubstr("write \"realism\" if you mean it"));
  EXPECT_THAT(error_of(renamed(of("task1_lab"), "data_shared", "data_share")), HasSubstr("\"data_shared\""));
  // An id that resembles another one of the protocol is a separate question.
  EXPECT_EQ(error_of(renamed(of("task1"), "dizziness", "dizzy")), "(no error)");
  // Protocols stored before names were checked are still read.
  EXPECT_NO_THROW(study::parse_protocol(replaced(of("ptpe_pilot"), "[\"HiRes\"]", "[\"Bogus\"]"), "p.toml",
                                        study::ProtocolUse::Stored));
}

}  // namespace
