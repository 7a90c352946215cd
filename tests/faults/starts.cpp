#include "tests/faults/starts.hpp"

#include <algorithm>
#include <atomic>
#include <memory>
#include <thread>
#include <vector>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"
#include "tests/faults/flows.hpp"

namespace faults {

using apps::test::Ended;
using apps::test::Process;
using apps::test::run_program;

namespace {

Arguments run_of(const fs::path& folder, const std::string& code) {
  return vip_study({"run", folder / "short.toml", "--db", folder / "s.db", "--observer", "random", "--seed",
                    "5", "--participant", code});
}

void prepare(const fs::path& folder) {
  fs::remove_all(folder);
  fs::create_directories(folder);
  base::write_file_atomically(folder / "short.toml", short_protocol());
}

/// The part of one participant's session that is missing; empty if complete.
std::string missing_of(const fs::path& folder, const std::string& code) {
  int answers = 0;
  for (const std::string& line : session_content(folder / "s.db")) {
    if (line.find("|" + code + "|") == std::string::npos) continue;
    if (line.starts_with("unit|") && line.ends_with("|planned"))
      return code + " ended well, and is open: " + line;
    if (line.starts_with("answer|")) ++answers;
  }
  for (const std::string& line : personal_content(folder / "s.db")) {
    if (line.find("|" + code + "|") != std::string::npos) ++answers;
  }
  // 13 answers: consent, age, two questions in each of five trials, a remark.
  return answers == 13 ? ""
                       : code + " ended well, and " + std::to_string(answers) + " of 13 answers are there";
}

}  // namespace

Together start_together(const fs::path& folder, int count) {
  Together all;
  prepare(folder);
  std::vector<std::string> codes;
  std::vector<std::unique_ptr<Process>> programs;
  for (int i = 0; i < count; ++i) {
    codes.push_back("P" + std::to_string(i + 1));
    programs.push_back(std::make_unique<Process>(run_of(folder, codes.back())));
  }
  std::vector<bool> good;
  for (auto& program : programs) {
    const Ended ended = program->wait();
    ++all.programs;
    good.push_back(ended.exit_code == 0);
    if (good.back()) continue;
    ++all.refused;
    if (ended.exit_code != 1 || ended.err.find("mend: ") == std::string::npos)
      all.problem = "no clear error: exit " + std::to_string(ended.exit_code) + ": " + ended.err;
  }
  const auto check = [&] {
    for (std::size_t i = 0; i < codes.size() && all.problem.empty(); ++i)
      if (good[i]) all.problem = missing_of(folder, codes[i]);
  };
  if (std::count(good.begin(), good.end(), true) == 0 && all.problem.empty())
    all.problem = "none went well, though one holds the lock";
  check();
  for (std::size_t i = 0; i < codes.size() && all.problem.empty(); ++i) {
    if (good[i]) continue;
    const Ended again = run_program(run_of(folder, codes[i]));
    good[i] = again.exit_code == 0;
    if (!good[i]) all.problem = codes[i] + " is refused when alone: " + again.err;
  }
  check();
  return all;
}

Together look_beside(const fs::path& folder) {
  Together all;
  prepare(folder);
  Arguments arguments = run_of(folder, "P1");
  // Enough sessions that SQLite copies its log back into the database while they run.
  for (int i = 2; i <= 24; ++i) arguments.insert(arguments.end(), {"--participant", "P" + std::to_string(i)});
  arguments.push_back("--events");
  Process session(arguments);
  session.read_line();  // the plan is stored
  std::atomic<bool> running{true};
  Ended ended;
  std::thread waiting([&] {
    ended = session.wait();
    running = false;
  });
  while (running && all.problem.empty()) {
    const Ended status = run_program(vip_study({"status", "--db", folder / "s.db"}));
    ++all.programs;
    if (status.exit_code != 0) all.problem = "status beside a session: " + status.err;
  }
  waiting.join();
  if (all.problem.empty() && ended.exit_code != 0) all.problem = "the session beside status: " + ended.err;
  for (const char* code : {"P1", "P24"})
    if (all.problem.empty()) all.problem = missing_of(folder, code);
  return all;
}

}  // namespace faults
