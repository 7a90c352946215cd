/// vip-faults: injects kills, failing calls and power cuts into every command that stores data, and checks
/// after each that no data are lost, doubled, changed or wrongly refused, and that people's decisions are
/// respected. Exit status 1 on any failure.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <atomic>
#include <cstdio>
#include <map>
#include <mutex>
#include <random>
#include <thread>

#include "tests/common/temporary_folder.hpp"
#include "tests/faults/crashes.hpp"
#include "tests/faults/history.hpp"
#include "tests/faults/starts.hpp"
#include "tests/faults/tries.hpp"

namespace faults {
namespace {

using Kind = Fault::Kind;
using How = Outcome::How;

struct Options {
  int every = 1, jobs = 1;
  long count = 1000;
  unsigned seed = 1;
  std::vector<std::string> flows;
};

bool chosen(const Options& options, const std::string& name) {
  return options.flows.empty() || std::count(options.flows.begin(), options.flows.end(), name) > 0;
}

/// Outcomes in one row of the table.
struct Row {
  long tries = 0, kills = 0;
  std::map<How, long> ended;
};

class Table {
 public:
  void add(const std::string& name, const Outcome& outcome) {
    const std::lock_guard lock(mutex_);
    Row& row = rows_[name];
    ++row.tries;
    row.kills += outcome.kills;
    kills_ += outcome.kills;
    ++row.ended[outcome.how];
    if (outcome.how == How::Failed) fail(outcome.problem);
  }
  void fail(const std::string& problem) {
    if (++failures_ <= 40) std::printf("FAILED  %s\n", problem.c_str());
    std::fflush(stdout);
  }
  long kills() const { return kills_; }
  long failures() const { return failures_; }
  void print() const {
    if (rows_.empty()) return;
    std::printf("%-34s %7s %9s %9s %9s %7s %7s\n", "command, fault", "tries", "went on", "refused", "stopped",
                "failed", "kills");
    Row all;
    for (const auto& [name, row] : rows_) {
      print(name, row);
      all.tries += row.tries;
      all.kills += row.kills;
      for (const auto& [how, n] : row.ended) all.ended[how] += n;
    }
    print("all", all);
    std::printf(
        "After each the command was given again: what counts was then as without a fault, but for the "
        "failed.\n");
  }

 private:
  static void print(const std::string& name, const Row& row) {
    const auto of = [&](How how) { return row.ended.contains(how) ? row.ended.at(how) : 0; };
    std::printf("%-34s %7ld %9ld %9ld %9ld %7ld %7ld\n", name.c_str(), row.tries, of(How::WentOn),
                of(How::Refused), of(How::Stopped), of(How::Failed), row.kills);
  }

  std::map<std::string, Row> rows_;
  std::mutex mutex_;
  std::atomic<long> kills_{0}, failures_{0};
};

/// Calls work(worker) in as many threads as there are jobs.
template <class Work>
void side_by_side(int jobs, Table& table, Work work) {
  std::vector<std::thread> threads;
  for (int worker = 0; worker < jobs; ++worker) {
    threads.emplace_back([&, worker] {
      try {
        work(worker);
      } catch (const std::exception& error) {
        table.fail(error.what());
      }
    });
  }
  for (auto& thread : threads) thread.join();
}

/// Faults of each kind at every n-th call, at least one of each kind. Different kinds begin at different
/// calls. `number` is the flow's index, which decides the kinds if Flow::share is not 1.
std::vector<Fault> faults_of_each(const Flow& flow, std::size_t number, const Bench& bench, long every) {
  constexpr Kind kinds[] = {Kind::Kill, Kind::Tear,   Kind::Error, Kind::ErrorsOn,
                            Kind::Full, Kind::FullOn, Kind::Read,  Kind::ReadsOn};
  std::vector<Fault> all;
  for (std::size_t i = 0; i < std::size(kinds); ++i) {
    if (every > 1 && (i + number) % static_cast<std::size_t>(flow.share) != 0) continue;
    const bool reads = kinds[i] == Kind::Read || kinds[i] == Kind::ReadsOn;
    const long calls = reads ? bench.reads() : bench.calls(), step = std::min(every, calls);
    const long first = 1 + (2 * static_cast<long>(i) + 1) * step / (2 * std::ssize(kinds));
    for (long k = first; k <= calls; k += step) all.push_back({kinds[i], k, 0});
  }
  return all;
}

/// Tries every n-th call of each command, with each kind of fault.
void try_each(const Options& options, const fs::path& folder, Table& table) {
  for (std::size_t number = 0; number < all_flows().size(); ++number) {
    const Flow& flow = all_flows()[number];
    if (!chosen(options, flow.name)) continue;
    std::atomic<std::size_t> next{0};
    side_by_side(options.jobs, table, [&](int worker) {
      Bench bench(flow, folder / std::to_string(worker));
      const std::vector<Fault> faults = faults_of_each(flow, number, bench, options.every);
      for (std::size_t i; (i = next++) < faults.size();)
        table.add(flow.name + ", " + name_of(faults[i].kind), bench.attempt(faults[i]));
    });
  }
}

/// Tries kills at random calls and instants, and some full disks, until the number of kills is reached.
void try_kills(const Options& options, const fs::path& folder, Table& table) {
  const bool disks = small_disks_can_be_made(folder / "disk");
  if (!disks) std::printf("no small file systems here (not root): full disks are injected calls alone\n");
  side_by_side(options.jobs, table, [&](int worker) {
    std::vector<const Flow*> flows;
    for (const Flow& flow : all_flows())
      if (chosen(options, flow.name)) flows.push_back(&flow);
    std::vector<std::unique_ptr<Bench>> benches(flows.size());  // prepared when first needed
    std::mt19937 random(options.seed * 1000 + static_cast<unsigned>(worker));
    const auto below = [&](long n) {
      return 1 + static_cast<long>(random() % static_cast<unsigned long>(n));
    };
    for (std::size_t i = 0; table.kills() < options.count && table.failures() < 40; ++i) {
      const Flow& flow = *flows[i % flows.size()];
      auto& prepared = benches[i % flows.size()];
      if (!prepared) prepared = std::make_unique<Bench>(flow, folder / std::to_string(worker) / flow.name);
      Bench& bench = *prepared;
      Fault fault;
      switch (random() % 8) {
        case 0:
          fault = {disks ? Kind::SmallDisk : Kind::FullOn, below(disks ? 60 : bench.calls()), 0};
          break;
        case 1:
          fault = {Kind::Tear, below(bench.calls()), 0};
          break;
        case 2:
        case 3:
          fault = {Kind::Instant, below(bench.microseconds()), static_cast<int>(random() % 3)};
          break;
        default:
          fault = {Kind::Kill, below(bench.calls()), static_cast<int>(random() % 3)};
          break;
      }
      if (fault.kind == Kind::SmallDisk) fault.at *= 4096;
      table.add(flow.name + ", " + name_of(fault.kind), bench.attempt(fault));
    }
  });
}

/// Tries first starts on new databases, two to four in parallel, and reads beside running sessions.
void try_together(const Options& options, const fs::path& folder, Table& table) {
  std::atomic<long> starts{0}, refused{0}, looks{0};
  side_by_side(options.jobs, table, [&](int worker) {
    const fs::path own = folder / ("together" + std::to_string(worker));
    for (int round = 0; starts < options.count && table.failures() < 40; ++round) {
      const Together started = start_together(own, 2 + round % 3);
      starts += started.programs;
      refused += started.refused;
      if (!started.problem.empty())
        table.fail(std::to_string(2 + round % 3) + " first starts: " + started.problem);
    }
    for (int round = 0; looks < options.count && table.failures() < 40; ++round) {
      const Together looked = look_beside(own);
      looks += looked.programs;
      if (!looked.problem.empty()) table.fail(looked.problem);
    }
  });
  std::printf(
      "%ld first starts beside each other on new databases (%ld refused, and done again); %ld looks beside a "
      "running session\n",
      starts.load(), refused.load(), looks.load());
}

/// Adds the subcommands `crashes` and `histories`, which run commands of the library in child processes.
void add_library_commands(CLI::App& app, std::function<long()>& run) {
  auto crashes = std::make_shared<CrashOptions>();
  CLI::App& cuts = *app.add_subcommand("crashes", "What a power cut may leave of each command, call by call");
  cuts.add_option("--command", crashes->commands, "This command only; may be repeated");
  cuts.add_option("--every", crashes->every, "Cut after every n-th call only")->check(CLI::PositiveNumber);
  cuts.add_option("--states", crashes->seeds, "States by chance after each call, under each model");
  cuts.add_option("--kills", crashes->kills, "So many kills at random calls instead, each under both models");
  cuts.add_option("--seed", crashes->seed, "Of the random numbers");
  cuts.add_option("--jobs", crashes->jobs, "Workers side by side")->check(CLI::Range(1, 256));
  cuts.callback([&run, crashes] { run = [crashes] { return try_crashes(*crashes); }; });
  auto histories = std::make_shared<HistoryOptions>();
  CLI::App& many =
      *app.add_subcommand("histories", "Random histories of three stations, with faults in between");
  many.add_option("count", histories->count, "Of histories");
  many.add_option("--seed", histories->seed, "Of the random numbers");
  many.add_option("--history", histories->only, "This one alone, counted from 0");
  many.add_option("--jobs", histories->jobs, "Workers side by side")->check(CLI::Range(1, 256));
  many.callback([&run, histories] { run = [histories] { return try_histories(*histories); }; });
}

int main(int argc, char** argv) {
  ::setenv("OMP_WAIT_POLICY", "passive", 1);
  CLI::App app("Faults in every command that keeps data.");
  app.require_subcommand(1);
  std::function<long()> in_library;
  add_library_commands(app, in_library);
  Options options;
  std::function<void(const Options&, const fs::path&, Table&)> work;
  const auto command = [&](const char* name, const char* says, auto function) {
    CLI::App& sub = *app.add_subcommand(name, says);
    sub.add_option("--jobs", options.jobs, "Workers side by side")->check(CLI::Range(1, 256));
    sub.callback([&work, function] { work = function; });
    return &sub;
  };
  CLI::App* each = command("each", "Fail at, or stop before, each call of each command", try_each);
  each->add_option("--every", options.every, "Try every n-th call only")->check(CLI::PositiveNumber);
  CLI::App* killed =
      command("kills", "Kill at random calls and instants, with full disks among them", try_kills);
  CLI::App* starts =
      command("starts", "First starts beside each other, and looks beside a session", try_together);
  for (CLI::App* sub : {killed, starts})
    sub->add_option("count", options.count, "Of kills, or of starts and of looks");
  killed->add_option("--seed", options.seed, "Of the random numbers");
  for (CLI::App* sub : {each, killed})
    sub->add_option("--flow", options.flows, "This command only; may be repeated");
  CLI11_PARSE(app, argc, argv);
  if (in_library) return in_library() == 0 ? 0 : 1;
  const ::test::TemporaryFolder folder;
  Table table;
  work(options, folder.path(), table);
  table.print();
  if (table.kills() > 0) std::printf("%ld kills, ", table.kills());
  std::printf("%ld failures\n", table.failures());
  return table.failures() == 0 ? 0 : 1;
}

}  // namespace
}  // namespace faults

int main(int argc, char** argv) { return faults::main(argc, argv); }
