#include "apps/study/bake_protocol.hpp"

#include <fmt/core.h>
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <map>

#include "libstudy/stimulus/bakes/write_bake.hpp"
#include "stats/base/duration.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/progress.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace fs = std::filesystem;

namespace {

/// Largest size of a particle in a frame of a bake, bytes: three coordinates of 16 bits, if compression does
/// not help.
constexpr std::uint64_t bytes_of_particle = 6;
constexpr std::uint64_t bytes_of_temperature = 2;
/// Largest size of a foam particle in a frame of a bake, bytes: three coordinates and a radius, 16 bits each.
constexpr std::uint64_t bytes_of_foam = 8;
/// Upper bound for pictures, bytes per pixel; pictures of the installed scenes take about 0.6.
constexpr std::uint64_t bytes_of_pixel = 1;

struct Task {
  study::BakeOrder order;
  sim::BakeHeader header;
  fs::path out;

  /// Cost of making this bake relative to other bakes: frames x particles.
  double weight() const {
    return static_cast<double>(header.frame_count) *
           static_cast<double>(sim::particle_count(sim::parse_method(header.method), header.n_star));
  }
};

std::vector<Task> tasks_of(const study::Protocol& protocol, const ProtocolBakes& request,
                           const std::vector<study::PlannedStimulus>& plan) {
  std::vector<Task> out;
  for (const study::PlannedStimulus& one : plan) {
    if (!one.live.empty()) continue;
    study::BakeOrder order = study::order_of(protocol, one, request.look);
    order.pictures = request.pictures;
    const sim::BakeHeader header = study::header_of(order);
    out.push_back({std::move(order), header, request.folder / one.file});
  }
  return out;
}

void print_live(const std::vector<study::PlannedStimulus>& plan) {
  std::map<std::string, int> live;
  for (const study::PlannedStimulus& one : plan) {
    if (!one.live.empty()) ++live[one.live];
  }
  for (const auto& [why, count] : live) std::printf("%d stimuli run live: %s\n", count, why.c_str());
}

std::vector<std::string> all_departures(const sim::BakeHeader& found, const sim::BakeHeader& wanted) {
  std::vector<std::string> out = study::fluid_departures(found, wanted);
  const auto add = [&](const std::string& had, const std::string& request) {
    if (had != request) out.push_back(had + " instead of " + request);
  };
  for (const std::string& one : study::view_departures(found, wanted)) out.push_back(one);
  const auto kept = [](const auto& one) { return one.has_pictures() ? "pictures" : "particles alone"; };
  add(kept(found), kept(wanted));
  add("version " + found.program_version, "version " + wanted.program_version);
  if (found.view.drawn() && wanted.view.drawn())
    add("drawn by " + found.view.renderer, "drawn by " + wanted.view.renderer);
  return out;
}

/// The first line of the error: the problem without the remedy, because the program itself makes the bake
/// again.
std::string problem_of(const base::Error& error) {
  const std::string text = error.what();
  return text.substr(0, text.find('\n'));
}

/// The reason why an existing bake must be made again; empty if the bake is valid.
std::string fault_of(const Task& task, const std::function<void()>& stop) {
  try {
    const sim::BakeReader bake(task.out);
    const std::string departures = base::joined(all_departures(bake.header(), task.header));
    if (!departures.empty()) return task.out.string() + ": " + departures;
    study::read_whole(bake, stop);
    return "";
  } catch (const base::Error& error) {
    stop();  // throws if the user stopped the reading, which is no fault of the bake
    return problem_of(error);
  }
}

/// The tasks whose bake is missing or invalid. Prints on stdout which bakes are kept and which are made
/// again.
std::vector<Task> left_to_make(std::vector<Task> tasks, const std::function<void()>& stop) {
  std::vector<Task> out;
  for (Task& task : tasks) {
    if (fs::exists(task.out)) {
      const std::string fault = fault_of(task, stop);
      if (fault.empty()) {
        std::printf("%s: whole, kept\n", task.out.c_str());
        continue;
      }
      std::printf("%s; is made again\n", fault.c_str());
    }
    out.push_back(std::move(task));
  }
  std::fflush(stdout);
  return out;
}

double free_bytes(fs::path folder) {
  folder = fs::absolute(folder);
  while (!fs::exists(folder) && folder.has_relative_path()) folder = folder.parent_path();
  return static_cast<double>(fs::space(folder).available);
}

void check_room(const std::vector<Task>& tasks, const fs::path& folder) {
  double needed = 0;
  for (const Task& task : tasks) needed += static_cast<double>(most_bytes(task.header));
  const double room = free_bytes(folder);
  const std::string text =
      fmt::format("take up to {:.1f} GB, and {:.1f} GB are free", 1e-9 * needed, 1e-9 * room);
  if (needed > room)
    throw base::Error(folder.string(), std::to_string(tasks.size()) + " bakes " + text,
                      "name a folder on another disk with --out, or free space on this one");
  std::printf("%zu bakes to make %s\n", tasks.size(), text.c_str());
  std::fflush(stdout);
}

void make(const Task& task, const std::string& label, const std::function<void()>& stop) {
  std::optional<base::Progress> settling, frames;
  study::BakeHooks hooks;
  hooks.stop = stop;
  hooks.settling = [&](int done, int total) {
    if (!settling) settling.emplace(label + " settles", static_cast<std::size_t>(total));
    settling->update(static_cast<std::size_t>(done));
  };
  hooks.frames = [&](std::int64_t done) {
    settling.reset();
    if (!frames) frames.emplace(label, static_cast<std::size_t>(task.header.frame_count));
    frames->update(static_cast<std::size_t>(done));
  };
  const sim::BakeSizes sizes = study::write_bake(task.order, task.header, task.out, true, hooks);
  frames.reset();
  std::printf("%s: %lld frames, %.1f MB\n", task.out.c_str(), static_cast<long long>(task.header.frame_count),
              1e-6 * static_cast<double>(sizes.file_bytes));
}

void make_all(const std::vector<Task>& tasks, const std::function<void()>& stop) {
  double all = 0, done = 0;
  for (const Task& task : tasks) all += task.weight();
  const auto start = std::chrono::steady_clock::now();
  for (std::size_t i = 0; i < tasks.size(); ++i) {
    const std::string count = std::to_string(i + 1) + " of " + std::to_string(tasks.size());
    make(tasks[i], count + ", " + tasks[i].out.stem().string(), stop);
    done += tasks[i].weight();
    const double spent_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    if (i + 1 < tasks.size())
      std::printf("%s made; about %s left\n", count.c_str(),
                  base::duration_words(spent_s * (all - done) / done).c_str());
    std::fflush(stdout);
  }
}

}  // namespace

std::uint64_t most_bytes(const sim::BakeHeader& header) {
  const auto particles = sim::particle_count(sim::parse_method(header.method), header.n_star);
  const auto pixels = std::int64_t{header.picture_width_px} * header.picture_height_px;
  return static_cast<std::uint64_t>(header.frame_count) *
         ((bytes_of_particle + (header.reference_k ? bytes_of_temperature : 0)) *
              static_cast<std::uint64_t>(particles) +
          bytes_of_foam * static_cast<std::uint64_t>(header.max_foam) +
          bytes_of_pixel * static_cast<std::uint64_t>(pixels));
}

void bake_protocol(const study::Protocol& protocol, const ProtocolBakes& request,
                   const std::function<void()>& stop) {
  const std::vector<study::PlannedStimulus> plan = study::plan_bakes(protocol);
  std::vector<Task> tasks = tasks_of(protocol, request, plan);
  print_live(plan);
  if (tasks.empty())
    throw base::Error(request.file, "holds no stimulus that can be baked: " + plan.front().live,
                      "run the protocol without bakes; vip-study check says what each stimulus needs");
  std::optional<sim::GlContext> context;
  for (Task& task : tasks) {
    if (!study::draws(task.header)) continue;
    if (!context) context = sim::GlContext::make_headless();
    task.header.view.renderer = sim::gl_description();
  }
  const std::size_t wanted = tasks.size();
  tasks = left_to_make(std::move(tasks), stop);
  if (!tasks.empty()) check_room(tasks, request.folder);
  base::make_folder(request.folder);
  make_all(tasks, stop);
  std::printf("%s: all %zu bakes of %s are whole\n", request.folder.c_str(), wanted, protocol.name.c_str());
}

}  // namespace apps
