#include "libstudy/stimulus/bakes/session_bakes.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <set>

#include "libsim/bake/bake_file.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/pattern.hpp"
#include "stats/base/text.hpp"

namespace study {

namespace fs = std::filesystem;

namespace {

/// For advice: without this option the bakes that are made hold particles alone.
constexpr const char* keep_pictures = " --keep pictures";

std::shared_ptr<const FoundBake> open_bake(const fs::path& path) {
  const sim::BakeReader bake(path);
  return std::make_shared<FoundBake>(FoundBake{path, bake.header(), bake.content_hash()});
}

std::string short_words(const StimulusSpec& what) {
  return fs::path(what.scene).stem().string() + " " + what.n_star + " " + what.method +
         (what.effects.empty() ? "" : " " + what.effects) + (what.surface.empty() ? "" : " " + what.surface);
}

bool shows(const PlannedStimulus& planned, const Cell& cell) {
  if (planned.what != cell.stimulus) return false;
  return !planned.rate || (planned.rate->mean == cell.setting.mean && planned.rate->sd == cell.setting.sd);
}

/// The wanted content with which the bake `found` is compared. Pictures are wanted if the bake has pictures.
/// Without a frame rate for the tolerance tau in the protocol, the wanted rate is 0, which no bake has.
BakeOrder order_for(const Protocol& protocol, const PlannedStimulus& one, const SessionLook& look,
                    const sim::BakeHeader& found) {
  BakeOrder order = order_of(protocol, one, look);
  order.pictures = found.has_pictures();
  if (!one.rate) order.fluid.fixed_rate = sim::FrameRate{};
  return order;
}

void check_one_stimulus(const std::vector<PlannedStimulus>& plan, const fs::path& bake) {
  for (const PlannedStimulus& one : plan) {
    if (one.what == plan.front().what) continue;
    throw base::Error(
        "--stimulus " + bake.string(),
        "shows one scene, method, n_*, set of effects and surface, but the protocol names several",
        "bake them all: vip-study bake --protocol FILE --out FOLDER, then vip-study run "
        "--stimulus FOLDER; or "
        "run the protocol live, without --stimulus");
  }
}

/// Options of `vip-study bake` that match this session.
std::string bake_options(const SessionLook& look) {
  std::string out = "--size " + std::to_string(look.size.width) + "x" + std::to_string(look.size.height);
  if (look.common.viewing.visual_angle_deg) out += " --screen-width-mm and --viewing-distance-mm as here";
  return out;
}

std::string listed(const std::vector<std::string>& names) {
  constexpr std::size_t most = 6;
  const std::vector<std::string> first(
      names.begin(), names.begin() + static_cast<std::ptrdiff_t>(std::min(most, names.size())));
  return base::joined(first) +
         (names.size() > most ? ", and " + std::to_string(names.size() - most) + " more" : "");
}

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

SessionBakes::SessionBakes(const fs::path& path, const Protocol& protocol, const SessionLook& look)
    : path_(path), options_(bake_options(look)) {
  if (path.empty()) return;
  for (PlannedStimulus& one : plan_bakes(protocol)) sources_.push_back({std::move(one), {}});
  fs::is_directory(path) ? use_folder(protocol, look) : use_file(protocol, look);
}

void SessionBakes::use_file(const Protocol& protocol, const SessionLook& look) {
  check_one_stimulus(plan_bakes(protocol), path_);
  const auto bake = open_bake(path_);
  std::vector<std::string> departures;
  for (Source& source : sources_) {
    source.bake = bake;
    sim::BakeHeader wanted = header_of(order_for(protocol, source.planned, look, bake->header));
    // A shorter bake is no departure, because ContentRules::at_end applies after its last frame.
    wanted.frame_count = std::min(wanted.frame_count, bake->header.frame_count);
    wanted.frame_dt_s = bake->header.frame_dt_s;  // make_stimulus() checks the content step
    for (const std::string& one : fluid_departures(bake->header, wanted)) {
      if (std::find(departures.begin(), departures.end(), one) == departures.end()) departures.push_back(one);
    }
  }
  if (sim::traits_of(sim::parse_method(bake->header.method)).adaptive() && !protocol.fixation)
    departures.emplace_back("a gaze fixed before the session instead of the participant's");
  departure_ = base::joined(departures);
}

void SessionBakes::use_folder(const Protocol& protocol, const SessionLook& look) {
  bool any = false;
  for (Source& source : sources_) {
    if (source.planned.file.empty() || !fs::exists(path_ / source.planned.file)) continue;
    const auto bake = open_bake(path_ / source.planned.file);
    const sim::BakeHeader wanted = header_of(order_for(protocol, source.planned, look, bake->header));
    std::vector<std::string> departures = fluid_departures(bake->header, wanted);
    if (source.planned.adaptive) {
      for (std::string& one : view_departures(bake->header, wanted)) departures.push_back(std::move(one));
    }
    if (!departures.empty())
      throw base::Error(bake->path.string(), "holds " + base::joined(departures),
                        "make it again: vip-study bake --protocol FILE --out " + path_.string() + " " +
                            options_ + (bake->header.has_pictures() ? keep_pictures : ""));
    source.bake = bake;
    any = true;
  }
  if (!any)
    throw base::Error("--stimulus " + path_.string(), "holds no bake of this protocol",
                      "make them: vip-study bake --protocol FILE --out " + path_.string() + " " + options_ +
                          (varies_surface(protocol.design) ? keep_pictures : ""));
}

const FoundBake* SessionBakes::of(const Cell& cell) const {
  for (const Source& source : sources_) {
    if (shows(source.planned, cell)) return source.bake.get();
  }
  return nullptr;
}

bool SessionBakes::whole() const {
  return !sources_.empty() &&
         std::all_of(sources_.begin(), sources_.end(), [](const Source& one) { return one.bake != nullptr; });
}

std::vector<std::string> SessionBakes::notes(const std::string& protocol_file) const {
  if (!fs::is_directory(path_)) return {};
  std::vector<std::string> baked, missing;
  bool pictures = false;
  std::map<std::string, std::vector<std::string>> live;
  for (const Source& source : sources_) {
    const std::string name = short_words(source.planned.what);
    if (source.bake) {
      baked.push_back(name);
      pictures = pictures || source.bake->header.has_pictures();
    } else if (source.planned.live.empty()) {
      missing.push_back(name);
    } else {
      live[source.planned.live].push_back(name);
    }
  }
  std::vector<std::string> out{std::to_string(baked.size()) + " stimuli are baked: " + listed(baked)};
  for (const auto& [why, names] : live)
    out.push_back(std::to_string(names.size()) + " run live, " + why + ": " + listed(names));
  if (!missing.empty())
    out.push_back(std::to_string(missing.size()) + " have no bake and run live: " + listed(missing) +
                  "; to make them: vip-study bake --protocol " + protocol_file + " --out " + path_.string() +
                  " " + options_ + (pictures ? keep_pictures : ""));
  return out;
}

std::string SessionBakes::description() const {
  if (!fs::is_directory(path_)) return "";
  std::string out;
  for (const Source& source : sources_) {
    out += (out.empty() ? "" : "; ") + short_words(source.planned.what);
    if (source.planned.rate) out += " at " + setting_name(*source.planned.rate);
    out += source.bake ? " bake " + source.bake->hash + " on " + source.bake->header.backend : " live";
  }
  return out;
}

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
                      all.empty() ? "leave it out" : "name the bake with the recorded hash");
  }
  for (const std::string& path : out) {
    if (path.empty() || fs::exists(path)) continue;
    throw base::Error(
        path, "does not exist any more; the sessions of " + database + " began with " + in_words(all),
        "put it back, or give its new path: vip-study resume --db " + database + " --stimulus PATH");
  }
  return out;
}

}  // namespace study
