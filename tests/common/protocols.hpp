#pragma once
/// Reads the protocols of tests/protocols and those that are shipped, and edits them. An edit throws if the
/// text that it looks for is gone.

#include <filesystem>
#include <initializer_list>
#include <stdexcept>
#include <string>
#include <utility>

#include "stats/base/file.hpp"

namespace test {

/// The text of tests/protocols/NAME.toml.
inline std::string protocol_text(const std::string& name) {
  return base::read_file(base::resource("tests/protocols/" + name + ".toml"), 1 << 20);
}

/// A protocol with questions of every kind.
inline std::string answers_text() { return protocol_text("../fuzz/corpus/protocol/answers"); }

/// The text of protocols/NAME.toml.
inline std::string shipped_text(const std::string& name) {
  return base::read_file(base::resource("protocols/" + name + ".toml"), 1 << 20);
}

inline std::size_t found_in(const std::string& text, const std::string& what) {
  const auto at = text.find(what);
  if (at == std::string::npos)
    throw std::runtime_error("the text no longer holds: " + what + "; mend: adapt the edit in the test");
  return at;
}

/// `text` with `to` in place of the first `from`.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  return text.replace(found_in(text, from), from.size(), to);
}

/// Replaces the first `from` by `to` in a file.
inline void replace_in(const std::filesystem::path& path, const std::string& from, const std::string& to) {
  base::write_file_atomically(path, replaced(base::read_file(path, 1 << 20), from, to));
}

/// `text` with `more` in front of the first `place`.
inline std::string with_before(std::string text, const std::string& place, const std::string& more) {
  return text.insert(found_in(text, place), more);
}

/// Sets keys: replaces the first line that begins with each key, including the line's comment.
inline std::string with_keys(std::string text,
                             std::initializer_list<std::pair<std::string, std::string>> keys) {
  for (const auto& [key, value] : keys) {
    const auto at = found_in(text, "\n" + key + " = ") + 1;
    text.replace(at, text.find('\n', at) - at, key + " = " + value);
  }
  return text;
}

/// Removes blocks and questions by their ids. Removed questions also leave the first "ask" step.
inline std::string without(std::string text, std::initializer_list<std::string> ids) {
  for (const auto& id : ids) {
    const auto begin = text.rfind("[[block", found_in(text, "\nid = \"" + id + "\"\n"));
    const bool question = text.compare(begin, 8, "[[block.") == 0;
    text.erase(begin, text.find(question ? "[[block" : "[[block]]", begin + 1) - begin);
    const auto steps = text.find("\"ask "), asked = text.find(" " + id, steps);
    if (question && asked < text.find('\n', steps)) text.erase(asked, 1 + id.size());
  }
  return text;
}

/// The shipped pilot with trials of `duration_s` at six settings (two means by three deviations of the frame
/// rate), and without the black screen of 3 s before each trial.
inline std::string short_protocol(const std::string& duration_s) {
  return replaced(with_keys(shipped_text("ptpe_pilot"), {{"name", "\"short\""},
                                                         {"mean_fps", "[20, 50]"},
                                                         {"sd_fps", "[0, 5, 10]"},
                                                         {"duration_s", duration_s}}),
                  "\"black 3\", ", "");
}

/// short_protocol() with these mean frame rates, no spread, trials of 10 s and a first page that can be left
/// after 1 s instead of 5 s. It is played although a display meets some means only approximately.
inline std::string short_protocol_at(const std::string& means) {
  return with_keys(
      short_protocol("10"),
      {{"mean_fps", means}, {"sd_fps", "[0]"}, {"accept_approximate", "true"}, {"seconds", "1"}});
}

/// The shipped foam.toml. `effects` replaces its line of that name; `sets` replaces its sets of effects.
inline std::string foam_text(const std::string& effects, const std::string& sets) {
  std::string text = replaced(shipped_text("foam"), "effects = [\"none\", \"foam\"]", effects);
  const auto begin = found_in(text, "[[design.effect_set]]");
  return text.replace(begin, found_in(text, "[pacing]") - begin, sets);
}

/// `text` of foam.toml with one coarse method and trials of half a second.
inline std::string coarse(const std::string& text) {
  return with_keys(text, {{"method", "[\"LoRes\"]"}, {"n_star", "[\"256\"]"}, {"duration_s", "0.5"}});
}

/// Two settings, each shown and rated, after a consent page that asks gaze_kept, data_shared, both or
/// neither.
inline std::string asking_text(bool gaze = true, bool sharing = true) {
  std::string text = without(protocol_text("ratings"), {"about", "warm_up", "smoothness", "end"}),
              name = "asking";
  if (!gaze) text = without(text, {"gaze_kept"}), name += "_no_gaze";
  if (!sharing) text = without(text, {"data_shared"}), name += "_no_sharing";
  return with_keys(text, {{"name", '"' + name + '"'}});
}

/// asking_text() for a bake of 60 frames/s in a headset. It is played although the headset meets its frame
/// rates only approximately.
inline std::string asking_at_60(bool gaze = true) {
  return with_keys(asking_text(gaze), {{"mean_fps", "[10, 30]"},
                                       {"content_step_s", "0.016666666666666666"},
                                       {"language", "\"en\"\naccept_approximate = true"}});
}

/// A protocol of pairs with questions about the person and a practice trial before them, and free words at
/// the end.
inline std::string pairs_text() { return without(protocol_text("pairs"), {"consent"}); }

}  // namespace test
