#include <algorithm>
#include <cstdio>
#include <map>
#include <random>

#include "tests/common/temporary_folder.hpp"
#include "tests/faults/crashes.hpp"
#include "tests/faults/workers.hpp"

namespace faults {

namespace {

using Say = std::function<void(const std::string&)>;

/// Tries every state; each worker takes its share.
void try_each(const CrashOptions& options, int worker, Crashes& crashes, const Say& tried) {
  long states = 0;
  const auto attempt = [&](const CrashTry& one) {
    if (!crashes.make(one) || states++ % options.jobs != worker) return;
    Problems problems = crashes.go_on();
    tried(std::string("TRIED ") + name_of(one.model));
    for (const std::string& problem : problems)
      tried("FAILED " + one.text() + " of " + std::to_string(crashes.calls()) + " (" +
            crashes.last_call(one) + "): " + problem);
  };
  const auto step = static_cast<std::size_t>(options.every);
  for (std::size_t count = options.seed % step; count <= crashes.calls(); count += step) {
    attempt({count, Model::Ext4, Kept::Most});
    for (const Model model : {Model::Ext4, Model::Posix}) {
      attempt({count, model, Kept::Least});
      for (int i = 0; i < options.seeds; ++i)
        attempt({count, model, Kept::Some, static_cast<unsigned>(count * 100 + static_cast<unsigned>(i))});
    }
  }
}

/// Cuts the power at random calls, each under both models.
void try_kills(const CrashOptions& options, int worker, Crashes& crashes, const Say& tried) {
  for (long i = worker; i < options.kills; i += options.jobs) {
    std::mt19937 random(options.seed * 100'003 + static_cast<unsigned>(i));
    const std::size_t count = random() % (crashes.calls() + 1);
    const auto seed = static_cast<unsigned>(random());
    for (const Model model : {Model::Ext4, Model::Posix}) {
      const CrashTry one{count, model, i % 4 == 0 ? Kept::Least : Kept::Some, seed};
      crashes.make(one);
      Problems problems = crashes.go_on();
      tried(std::string("TRIED ") + name_of(model));
      for (const std::string& problem : problems)
        tried("FAILED kill " + std::to_string(i) + ", " + one.text() + " of " +
              std::to_string(crashes.calls()) + " (" + crashes.last_call(one) + "): " + problem);
    }
  }
}

struct Row {
  long calls = 0, ext4 = 0, posix = 0, failed = 0;
};

/// The message of a failure without numbers and without the path of the test's folder, so that equal causes
/// are counted together.
std::string cause_of(const std::string& line) {
  std::string cause;
  std::string said = line.substr(std::min(line.size(), line.find("): ") + 3), 160);
  if (const std::size_t at = said.find("/now/"), from = said.find('/'); at != std::string::npos && from < at)
    said.erase(from, at - from);
  for (const char c : said)
    if (!std::isdigit(static_cast<unsigned char>(c))) cause += c;
  return cause;
}

}  // namespace

long try_crashes(const CrashOptions& options) {
  const ::test::TemporaryFolder folder;
  const auto& all = all_commands();
  std::map<std::string, Row> rows;
  std::map<std::string, std::pair<long, std::string>> causes;
  long failed = 0;
  std::printf("%-24s %7s %12s %12s %7s\n", "command", "calls", "ext4 states", "posix states", "failed");
  for (const Command& command : all) {
    const auto& names = options.commands;
    if (!names.empty() && std::find(names.begin(), names.end(), command.name) == names.end()) continue;
    Row row;
    const auto take = [&](const std::string& line) {
      if (line == "TRIED ext4") ++row.ext4;
      if (line == "TRIED posix") ++row.posix;
      if (line.starts_with("CALLS ")) row.calls = std::max(row.calls, std::stol(line.substr(6)));
      if (!line.starts_with("FAILED ")) return;
      ++row.failed;
      auto& cause = causes[command.name + ": " + cause_of(line)];
      if (cause.first++ == 0) cause.second = line;
    };
    const bool good = spread(
        options.jobs,
        [&](int worker, const Say& say) {
          const fs::path own = folder / (std::to_string(worker) + command.name);
          Crashes crashes(command, own);
          say("CALLS " + std::to_string(crashes.calls()));
          for (const std::string& problem : worker == 0 ? crashes.at_first() : Problems())
            say("FAILED without a fault (): " + problem);
          options.kills > 0 ? try_kills(options, worker, crashes, say)
                            : try_each(options, worker, crashes, say);
          fs::remove_all(own);
        },
        take);
    if (!good && row.failed == 0) ++row.failed;
    failed += row.failed;
    std::printf("%-24s %7ld %12ld %12ld %7ld\n", command.name.c_str(), row.calls, row.ext4, row.posix,
                row.failed);
    std::fflush(stdout);
  }
  for (const auto& [cause, times] : causes)
    std::printf("%ld times %s\n    first: %s\n", times.first, cause.c_str(), times.second.c_str());
  std::printf("%ld failures\n", failed);
  return failed;
}

}  // namespace faults
