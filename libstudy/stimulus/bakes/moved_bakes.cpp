#include "libstudy/stimulus/bakes/moved_bakes.hpp"

#include <algorithm>
#include <filesystem>
#include <set>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/pattern.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

using Hashes = std::set<std::string>;

Hashes hashes_in(const std::string& shown) {
  static const base::Pattern pattern("bake ([0-9a-f]{16})");
  Hashes all;
  for (const base::Groups& found : pattern.all(shown)) all.insert(found[1]);
  return all;
}

Hashes hashes_at(const fs::path& path) {
  if (!fs::is_directory(path)) return {sim::BakeReader(path).content_hash()};
  Hashes all;
  for (const auto& entry : fs::directory_iterator(path)) {
    if (entry.path().extension() == ".bake") all.insert(sim::BakeReader(entry.path()).content_hash());
  }
  return all;
}

std::string in_words(const Hashes& hashes) {
  if (hashes.empty()) return "no bake";
  return "bake " + base::joined({hashes.begin(), hashes.end()});
}

struct Given {
  std::string option;
  fs::path path;
  Hashes hashes;
  bool used = false;
};

}  // namespace

std::vector<std::string> find_bakes(const std::vector<RecordedBake>& recorded,
                                    const std::vector<std::string>& given, const std::string& database) {
  std::vector<Given> candidates;
  for (const std::string& option : given) {
    const fs::path path = fs::absolute(base::find_input(option));
    candidates.push_back({option, path, hashes_at(path)});
  }
  std::vector<std::string> out;
  Hashes all;
  for (const RecordedBake& one : recorded) {
    const Hashes wanted = hashes_in(one.shown);
    all.insert(wanted.begin(), wanted.end());
    const auto found = std::find_if(candidates.begin(), candidates.end(), [&](const Given& candidate) {
      return !one.path.empty() && !wanted.empty() &&
             std::includes(candidate.hashes.begin(), candidate.hashes.end(), wanted.begin(), wanted.end());
    });
    if (found != candidates.end()) found->used = true;
    out.push_back(found != candidates.end() ? found->path.string() : one.path);
  }
  for (const Given& candidate : candidates) {
    if (candidate.used) continue;
    throw base::Error("--stimulus " + candidate.option,
                      "holds " + in_words(candidate.hashes) + "; the sessions of " + database +
                          " that are not done began with " + in_words(all),
                      all.empty() ? "leave it out" : "name the bake with that hash");
  }
  for (const std::string& path : out) {
    if (path.empty() || fs::exists(path)) continue;
    throw base::Error(
        path, "is not there any more; the sessions of " + database + " began with " + in_words(all),
        "put it back, or name where it is now: vip-study resume --db " + database + " --stimulus PATH");
  }
  return out;
}

}  // namespace study
