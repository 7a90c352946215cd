#include "tests/faults/tries.hpp"

#include <sys/mount.h>

#include <chrono>
#include <stdexcept>
#include <thread>

#include "stats/base/file.hpp"
#include "tests/apps/process.hpp"

namespace faults {

using apps::test::Ended;
using apps::test::Process;
using Kind = Fault::Kind;

namespace {

Lines lines_of(const std::string& out, const std::string& word) {
  Lines all;
  for (std::size_t at = 0; at < out.size();) {
    const std::size_t end = std::min(out.find('\n', at), out.size());
    char person[40];
    int position = 0;
    if (std::sscanf(out.substr(at, end - at).c_str(), (word + " %39s %d").c_str(), person, &position) == 2)
      all.push_back(person + (" " + std::to_string(position)));
    at = end + 1;
  }
  return all;
}

/// The command with the environment that injects the fault. Only calls on files in `folder` count; `count`
/// gets their number if there is no fault.
Arguments with_faults(const Arguments& command, const fs::path& folder, const Fault& fault,
                      const fs::path& count) {
  Arguments all{"/usr/bin/env", "OMP_WAIT_POLICY=passive", "OMP_NUM_THREADS=1",
                "VIP_CACHE_DIR=" + (folder / "cache").string(),
                "VIP_STATE_DIR=" + (folder / "state").string()};
  if (fault.kind != Kind::Instant && fault.kind != Kind::SmallDisk) {
    all.push_back("LD_PRELOAD=" + (program_folder() / "libfail_calls.so").string());
    all.push_back("ASAN_OPTIONS=verify_asan_link_order=0");
    all.push_back("VIP_FAULT_FOLDER=" + folder.string());
    if (fault.kind == Kind::None)
      all.push_back("VIP_FAULT_COUNT=" + count.string());
    else
      all.push_back(std::string("VIP_FAULT=") + name_of(fault.kind) + ":" + std::to_string(fault.at));
  }
  all.insert(all.end(), command.begin(), command.end());
  return all;
}

Ended run_with(const Arguments& arguments, const Fault& fault) {
  Process program(arguments, [] { ::close(STDIN_FILENO); });
  if (fault.kind == Kind::Instant) {
    std::this_thread::sleep_for(std::chrono::microseconds(fault.at));
    program.send(SIGKILL);
  }
  return program.wait();
}

std::string told(const Ended& ended) {
  return "exit " + std::to_string(ended.exit_code) + " signal " + std::to_string(ended.signal) + ": " +
         ended.err.substr(0, 400);
}

/// True for one error with a remedy.
bool is_clear(const Ended& ended) {
  return ended.exit_code == 1 && ended.err.find("error: ") != std::string::npos &&
         ended.err.find("mend: ") != std::string::npos;
}

void need(bool good, const std::string& problem) {
  if (!good) throw std::runtime_error(problem);
}

}  // namespace

const char* name_of(Kind kind) {
  switch (kind) {
    case Kind::None:
      return "none";
    case Kind::Kill:
      return "kill";
    case Kind::Tear:
      return "tear";
    case Kind::Instant:
      return "instant";
    case Kind::Error:
      return "eio";
    case Kind::ErrorsOn:
      return "eio+";
    case Kind::Full:
      return "enospc";
    case Kind::FullOn:
      return "enospc+";
    case Kind::Read:
      return "read";
    case Kind::ReadsOn:
      return "read+";
    case Kind::SmallDisk:
      return "small disk";
  }
  return "";
}

bool kills(Kind kind) { return kind == Kind::Kill || kind == Kind::Tear || kind == Kind::Instant; }

bool small_disks_can_be_made(const fs::path& folder) {
  fs::create_directories(folder);
  if (::mount("none", folder.c_str(), "tmpfs", 0, "size=64k") != 0) return false;
  return ::umount(folder.c_str()) == 0;
}

Bench::Bench(const Flow& flow, const fs::path& folder)
    : flow_(flow), start_(folder / "start"), now_(folder / "now"), peek_(folder / "peek") {
  fs::remove_all(folder);
  for (const fs::path& made : {start_, now_, peek_}) fs::create_directories(made);
  // The flow is prepared in the folder in which it runs, because exports are registered by their full path.
  flow.prepare(now_);
  fs::copy(now_, start_, fs::copy_options::recursive);
  const auto begun = std::chrono::steady_clock::now();
  const Ended ended = run_with(with_faults(flow.command(now_), now_, {}, folder / "count"), {});
  const auto took = std::chrono::steady_clock::now() - begun;
  need(ended.exit_code == 0, flow.name + " without a fault: " + told(ended));
  microseconds_ = std::chrono::duration_cast<std::chrono::microseconds>(took).count();
  const std::string counts = base::read_file(folder / "count", 100);
  need(std::sscanf(counts.c_str(), "%ld %ld", &calls_, &reads_) == 2, "no counts: " + counts);
  wanted_ = flow.content(now_);
}

Bench::~Bench() { clear(); }

void Bench::clear() {
  if (mounted_) ::umount2(now_.c_str(), MNT_DETACH);
  mounted_ = false;
  std::error_code ignored;
  fs::remove_all(now_, ignored);
}

void Bench::restore(const Fault& fault) {
  clear();
  fs::create_directories(now_);
  if (fault.kind == Kind::SmallDisk) {
    std::uintmax_t bytes = static_cast<std::uintmax_t>(fault.at);
    for (const auto& entry : fs::recursive_directory_iterator(start_))
      bytes += 4096 + (entry.is_regular_file() ? entry.file_size() : 0);
    need(::mount("none", now_.c_str(), "tmpfs", 0, ("size=" + std::to_string(bytes)).c_str()) == 0,
         "no tmpfs");
    mounted_ = true;
  }
  fs::copy(start_, now_, fs::copy_options::recursive | fs::copy_options::overwrite_existing);
}

Outcome Bench::attempt(const Fault& fault) {
  Outcome outcome;
  ++tries_;
  // Looks at a copy, so that the next command finds the files as they were left.
  const auto peek = [&](auto look) {
    if (flow_.played.empty()) return Lines{};
    fs::remove_all(peek_);
    fs::create_directories(peek_);
    for (const auto& entry : fs::directory_iterator(now_)) {
      if (entry.path().filename().string().starts_with(flow_.played))
        fs::copy(entry.path(), peek_ / entry.path().filename());
    }
    return look(peek_ / flow_.played);
  };
  const auto check_open = [&](const char* when) {
    for (const auto& name : flow_.healthy) {
      const Ended status = apps::test::run_program(vip_study({"status", "--db", now_ / name}));
      need(status.exit_code == 0, std::string(when) + " status of " + name + ": " + told(status));
    }
  };
  try {
    restore(fault);
    Lines said, before = peek(answer_rows);
    Ended ended;
    Fault next = fault;
    for (int round = 0;; ++round) {
      ended =
          run_with(with_faults(round == 0 ? flow_.command(now_) : flow_.again(now_), now_, next, {}), next);
      if (!flow_.played.empty()) said = said + lines_of(ended.out, "done");
      if (ended.signal == SIGKILL) ++outcome.kills;
      const Lines done = peek(done_units), rows = peek(answer_rows);
      need(missing(said, done).empty(), "acknowledged and lost:" + missing(said, done));
      need(missing(before, rows).empty(), "answers lost or changed:" + missing(before, rows));
      before = rows;
      if (round == fault.again || ended.signal != SIGKILL) break;
      next.at =
          1 + (fault.at * 7919 + round * 104729) % (fault.kind == Kind::Instant ? microseconds_ : calls_);
    }
    const auto done_before = peek(done_units);
    if (ended.signal == SIGKILL) {
      outcome.how = Outcome::How::Stopped;
    } else if (ended.exit_code == 0) {
      const std::string differs = difference(wanted_, flow_.content(now_));
      need(differs.empty(), "ended well, but" + differs);
      return outcome;
    } else {
      need(is_clear(ended), "no clear error: " + told(ended));
      outcome.how = Outcome::How::Refused;
    }
    if (mounted_)
      need(::mount("none", now_.c_str(), "tmpfs", MS_REMOUNT, "size=256m") == 0, "tmpfs stays small");
    if (tries_ % 2 == 0) check_open("afterwards,");
    const auto give_again = [&] { return run_with(with_faults(flow_.again(now_), now_, {}, {}), {}); };
    Ended last = give_again();
    // If a plan was stored although an error came, resumes as the error says.
    if (last.err.find("continue with vip-study resume") != std::string::npos) last = give_again();
    need(last.exit_code == 0, "the command given again: " + told(last));
    for (const std::string& unit : lines_of(last.out, "begins"))
      need(missing({unit}, done_before) != "", "asked again: " + unit);
    check_open("in the end,");
    const std::string differs = difference(wanted_, flow_.content(now_));
    need(differs.empty(), "in the end" + differs);
    need(missing(before, peek(answer_rows)).empty(),
         "in the end answers lost or changed:" + missing(before, peek(answer_rows)));
  } catch (const std::exception& error) {
    outcome.how = Outcome::How::Failed;
    outcome.problem =
        flow_.name + ", " + name_of(fault.kind) + " " + std::to_string(fault.at) + ": " + error.what();
  }
  return outcome;
}

}  // namespace faults
