#include <algorithm>
#include <cstdio>
#include <map>
#include <random>

#include "tests/common/temporary_folder.hpp"
#include "tests/faults/history.hpp"
#include "tests/faults/workers.hpp"

namespace faults {

namespace {

using Kind = Step::Kind;
using Fault = Step::Fault;
using Say = std::function<void(const std::string&)>;

/// Approximate number of calls that the command makes.
long calls_of(Kind kind) {
  switch (kind) {
    case Kind::Session:
      return 500;
    case Kind::Consent:
      return 250;
    case Kind::Status:
      return 15;
    default:
      return 450;
  }
}

/// The kind of a problem ("refused", "tombstone", ...) with its text up to the first path or quote, without
/// digits and names of stations.
std::string kind_of(const std::string& problem) {
  std::string kind;
  for (std::size_t i = 0; i < problem.size() && kind.size() < 90; ++i) {
    const auto c = static_cast<unsigned char>(problem[i]);
    if (c == '/' || c == '\'') break;
    if (!std::isdigit(c)) kind += problem[i];
  }
  for (const char* name : {"north", "south", "west", "@", "nQ", "sQ", "wQ", "P "})
    for (std::size_t at; (at = kind.find(name)) != std::string::npos;)
      kind.erase(at, std::string(name).size());
  return kind;
}

/// True if both first problems are of the same kind.
bool is_alike(const Problems& one, const Problems& other) {
  return !one.empty() && !other.empty() && kind_of(one.front()) == kind_of(other.front());
}

std::string in_words(const Step& step) {
  static constexpr const char* names[] = {"",
                                          "killed at call ",
                                          "torn at call ",
                                          "power cut (ext4) at call ",
                                          "power cut (posix) at call ",
                                          "EIO at call ",
                                          "full at call ",
                                          "full from call "};
  if (step.fault == Fault::None) return "";
  return std::string(", ") + names[static_cast<int>(step.fault)] + std::to_string(step.at);
}

}  // namespace

std::vector<Step> make_history(unsigned seed, long number) {
  std::seed_seq seeds{seed, static_cast<unsigned>(number)};
  std::mt19937 random(seeds);
  const auto below = [&](unsigned n) { return static_cast<unsigned>(random() % n); };
  constexpr Kind kinds[] = {Kind::Session, Kind::Session, Kind::Consent,  Kind::Consent, Kind::Consent,
                            Kind::Consent, Kind::Consent, Kind::Consent,  Kind::Merge,   Kind::Merge,
                            Kind::Merge,   Kind::Merge,   Kind::Withdraw, Kind::Export,  Kind::Export,
                            Kind::BackUp,  Kind::Restore, Kind::Salvage,  Kind::Resume,  Kind::Status};
  std::vector<Step> steps;
  const unsigned count = 6 + below(12);
  for (unsigned i = 0; i < count; ++i) {
    Step step;
    step.kind = i < 2 ? Kind::Session : kinds[below(std::size(kinds))];
    step.station = below(step.kind == Kind::Session ? 3 : 4);
    step.who = below(1000);
    step.choice = below(16);
    step.yes = below(2) == 0 || (step.kind == Kind::Session && below(2) == 0);
    step.other = below(2) == 0;
    if (below(3) == 0) step.fault = static_cast<Fault>(1 + below(7));
    // The first calls commit; cleaning up makes most of the calls, so early ones are preferred.
    step.at = 1 + below(1 + below(static_cast<unsigned>(calls_of(step.kind))));
    step.seed = static_cast<unsigned>(random());
    step.wait_s = 1 + below(below(2) == 0 ? 100'000 : 3);
    // Clocks jump, and are wrong by days.
    if (below(4) == 0) step.jump_s = static_cast<std::int64_t>(below(600'000)) - 300'000;
    steps.push_back(step);
  }
  return steps;
}

std::vector<Step> shrink(std::vector<Step> steps, const fs::path& folder, const Problems& problems) {
  const auto still_fails = [&](const std::vector<Step>& fewer) {
    std::vector<std::string> told;
    return is_alike(problems, run_history(fewer, folder, told));
  };
  for (std::size_t i = steps.size(); i-- > 0;) {
    std::vector<Step> fewer = steps;
    fewer.erase(fewer.begin() + static_cast<long>(i));
    if (still_fails(fewer)) steps = fewer;
  }
  for (Step& step : steps) {
    const Step whole = step;
    step.fault = Fault::None;
    if (!still_fails(steps)) step = whole;
    const Step before = step;
    step.jump_s = 0;
    if (!still_fails(steps)) step = before;
  }
  return steps;
}

long try_histories(const HistoryOptions& options) {
  const ::test::TemporaryFolder folder;
  std::map<std::string, long> kinds;
  long failed = 0, commands = 0, histories = 0;
  const auto take = [&](const std::string& line) {
    if (line.starts_with("RAN ")) {
      ++histories;
      commands += std::stol(line.substr(4));
    } else if (line.starts_with("KIND ")) {
      ++failed;
      ++kinds[line.substr(5)];
    } else {
      std::printf("%s\n", line.c_str());
      std::fflush(stdout);
    }
  };
  const auto work = [&](int worker, const Say& say) {
    const fs::path own = folder / std::to_string(worker);
    std::map<std::string, long> known;
    for (long i = worker; i < options.count; i += options.jobs) {
      if (options.only >= 0 && i != options.only) continue;
      const auto steps = make_history(options.seed, i);
      std::vector<std::string> told;
      const Problems problems = run_history(steps, own, told);
      say("RAN " + std::to_string(told.size()));
      if (problems.empty()) continue;
      const std::string kind = kind_of(problems.front());
      say("KIND " + kind);
      std::string text = "FAILED --seed " + std::to_string(options.seed) + " --history " + std::to_string(i) +
                         ": " + problems.front();
      if (known[kind]++ == 0) {
        const auto least = shrink(
            std::vector<Step>(steps.begin(), steps.begin() + static_cast<long>(told.size())), own, problems);
        told.clear();
        const Problems again = run_history(least, own, told);
        for (std::size_t k = 0; k < told.size(); ++k)
          text += " | " + std::to_string(k + 1) + ". " + told[k] + in_words(least[k]);
        if (!again.empty()) text += " | " + again.front();
      }
      say(text);
    }
    fs::remove_all(own);
  };
  const bool good = spread(options.jobs, work, take);
  for (const auto& [kind, times] : kinds) std::printf("%ld times %s\n", times, kind.c_str());
  std::printf("%ld histories of %ld commands, %ld failed\n", histories, commands, failed);
  return failed + (good ? 0 : 1);
}

}  // namespace faults
