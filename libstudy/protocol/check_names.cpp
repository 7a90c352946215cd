/// Checks names of methods and numbers of particles, which libsim must know, and ids of questions, which the
/// analyses look for. Without the check, a misspelling could stay unnoticed until after the study.
#include <algorithm>
#include <charconv>

#include "libstudy/protocol/names.hpp"
#include "libstudy/protocol/readers.hpp"
#include "stats/base/nearest.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace {

bool among(const std::vector<std::string>& known, const std::string& word) {
  return std::find(known.begin(), known.end(), word) != known.end();
}

void check_methods(const base::TomlTable& design) {
  const auto methods = design.strings("method");
  for (std::size_t i = 0; i < methods.size(); ++i) {
    // Skips blank names, because the readers of the design refuse them.
    if (base::is_blank(methods[i]) || among(method_names(), methods[i])) continue;
    design.fail_at("method", i, "= " + base::toml_quoted(methods[i]) + " is no method",
                   base::use_one_of(methods[i], method_names()));
  }
}

}  // namespace

bool is_method(const std::string& word) { return among(method_names(), word); }

bool is_particle_count(const std::string& word) {
  long long value = 0;
  const char* end = word.data() + word.size();
  const auto [rest, error] = std::from_chars(word.data(), end, value);
  return error == std::errc() && value > 0 &&
         (rest == end || (rest + 1 == end && (*rest == 'k' || *rest == 'K')));
}

namespace {

void check_particle_counts(const base::TomlTable& design) {
  const auto sizes = design.strings("n_star");
  for (std::size_t i = 0; i < sizes.size(); ++i) {
    if (base::is_blank(sizes[i]) || is_particle_count(sizes[i])) continue;
    design.fail_at("n_star", i, "= " + base::toml_quoted(sizes[i]) + " is no number of particles",
                   "write a whole number, or one with k for 1,024, for example \"32k\"");
  }
}

}  // namespace

const std::vector<std::string>& method_names() {
  static const std::vector<std::string> names{"LoRes", "HiRes", "FovFluid", "Ours", "Ours-TSp"};
  return names;
}

const std::vector<std::string>& surface_names() {
  static const std::vector<std::string> names{"ellipsoids", "spheres"};
  return names;
}

const std::vector<std::string>& known_question_ids() {
  static const std::vector<std::string> ids{"realism",   "disorientation", "unrealism",     "dizziness",
                                            "confusion", gaze_question,    sharing_question};
  return ids;
}

void check_design_names(const base::TomlTable& design) {
  check_methods(design);
  check_particle_counts(design);
}

void check_question_ids(const std::vector<base::TomlTable>& tables, const std::vector<Block>& blocks) {
  std::vector<std::string> missing = known_question_ids();
  for (const Block& block : blocks) {
    for (const Question& question : block.questions) std::erase(missing, question.id);
  }
  for (std::size_t i = 0; i < blocks.size(); ++i) {
    for (std::size_t q = 0; q < blocks[i].questions.size(); ++q) {
      const std::string& id = blocks[i].questions[q].id;
      if (among(known_question_ids(), id)) continue;
      const std::string meant = base::nearest_word(id, missing);
      if (meant.empty()) continue;
      tables[i].fail_at("question", q,
                        "has the id \"" + id + "\", close to \"" + meant +
                            "\", an id that the programs and the analyses look for",
                        "write \"" + meant + "\" if you mean it, or choose an id that is less similar");
    }
  }
}

}  // namespace study
