/// vip-study headset: shows what the headset and its OpenXR runtime offer, and which frame rates of a
/// protocol the headset shows exactly.

#include <fmt/format.h>

#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/common/program.hpp"
#include "apps/study/commands.hpp"
#include "apps/study/headset_show.hpp"
#include "libstudy/check/refresh_check.hpp"
#include "libstudy/headset/offer.hpp"
#include "libstudy/headset/picture_copy.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "stats/base/json.hpp"

namespace apps {

namespace {

struct HeadsetOptions {
  std::string protocol, json;
  ShowChoice show;
};

/// The texts of all values, joined by commas: "72, 80, 90".
template <class Values, class Text>
std::string listed(const Values& values, Text text) {
  std::string out;
  for (const auto& value : values) out += (out.empty() ? "" : ", ") + text(value);
  return out;
}

std::string hertz(double rate) { return fmt::format("{:g}", rate); }

std::string refresh_text(const study::HeadsetOffer& offer) {
  if (!offer.session) return "not known: " + offer.no_session;
  const study::HeadsetOffer::InSession& session = *offer.session;
  if (session.refresh_hz.empty()) return "not reported; it is measured when a session runs";
  std::string out = listed(session.refresh_hz, hertz) + " Hz";
  if (session.refresh_now) out += ", now " + hertz(*session.refresh_now) + " Hz";
  return out;
}

void print_offer(const study::HeadsetOffer& offer) {
  const auto row = [](const char* name, const std::string& text) { fmt::print("{:<12}{}\n", name, text); };
  row("runtime", offer.runtime + " " + offer.runtime_version);
  row("headset", offer.headset);
  row("pictures", listed(offer.eyes, [](const study::EyePicture& eye) {
        return fmt::format("{} x {} px", eye.width, eye.height);
      }));
  row("refresh", refresh_text(offer));
  row("blend", offer.opaque ? "opaque" : "the world shows through the picture");
  row("head", offer.position ? "rotation and position are tracked" : "only rotation is tracked");
  row("gaze", offer.eye_gaze ? "eye tracker" : "none");
  row("worn", offer.user_presence ? "reported by the runtime" : "not reported, except by its states");
  row("times", offer.time_converts ? "on the system's clock: evidence grade C"
                                   : "not on the system's clock: evidence grade D");
  if (offer.session) row("formats", listed(offer.session->formats, study::gl_format_name));
  row("extensions", listed(offer.extensions, [](const std::string& name) { return name; }));
}

/// Prints one line per setting of the frame rate, with the refresh rates at which its mean and SD are reached
/// exactly: "mean 40, SD 5 frames/s exact at 90, 120 Hz".
void print_exact_settings(const std::vector<study::CheckedSetting>& settings,
                          const std::vector<study::RefreshCheck>& checks) {
  for (std::size_t i = 0; i < settings.size(); ++i) {
    std::string exact;
    for (const study::RefreshCheck& check : checks) {
      if (check.verdicts[i].feasibility != study::Feasibility::Exact) continue;
      exact += (exact.empty() ? "" : ", ") + hertz(check.refresh_hz);
    }
    fmt::print("  mean {:>3g}, SD {:>3g} frames/s  {}\n", settings[i].setting.mean, settings[i].setting.sd,
               exact.empty() ? "exact at none" : "exact at " + exact + " Hz");
  }
}

base::Json offer_json(const study::HeadsetOffer& offer) {
  base::Json out{{"runtime", offer.runtime},
                 {"runtime_version", offer.runtime_version},
                 {"headset", offer.headset},
                 {"eyes", base::Json::array()},
                 {"opaque", offer.opaque},
                 {"position", offer.position},
                 {"eye_gaze", offer.eye_gaze},
                 {"user_presence", offer.user_presence},
                 {"time_converts", offer.time_converts},
                 {"extensions", offer.extensions}};
  for (const study::EyePicture& eye : offer.eyes)
    out["eyes"].push_back({{"width_px", eye.width}, {"height_px", eye.height}});
  if (offer.session) {
    out["refresh_hz"] = offer.session->refresh_hz;
    if (offer.session->refresh_now) out["refresh_now_hz"] = *offer.session->refresh_now;
    out["formats"] = base::Json::array();
    for (const std::int64_t format : offer.session->formats)
      out["formats"].push_back(study::gl_format_name(format));
  }
  return out;
}

void print_headset(const HeadsetOptions& options) {
  std::optional<study::Protocol> protocol;
  if (!options.protocol.empty()) protocol = study::read_protocol(study::find_protocol(options.protocol));
  const study::HeadsetOffer offer = study::read_headset_offer();
  print_offer(offer);
  base::Json json = offer_json(offer);
  if (protocol) {
    const std::vector<study::CheckedSetting> settings = study::checked_settings(*protocol);
    std::vector<study::RefreshCheck> checks;
    if (offer.session) {
      for (const double rate : offer.session->refresh_hz)
        checks.push_back(study::check_refresh(*protocol, rate));
    }
    fmt::print("\n{}, {} settings\n", protocol->name, settings.size());
    if (checks.empty())
      fmt::print("  which of them are exact follows from the refresh: vip-study check --refresh HZ\n");
    for (const study::RefreshCheck& check : checks) {
      fmt::print("  at {} Hz: {} exact, {} approximate, {} unreachable\n", hertz(check.refresh_hz),
                 check.exact, check.approximate, check.unreachable);
      json["protocol"].push_back({{"refresh_hz", check.refresh_hz},
                                  {"exact", check.exact},
                                  {"approximate", check.approximate},
                                  {"unreachable", check.unreachable}});
    }
    if (!checks.empty()) print_exact_settings(settings, checks);
  }
  if (!options.json.empty()) base::write_file_atomically(options.json, json.dump(2) + "\n");
}

}  // namespace

void add_headset_command(CLI::App& app) {
  auto options = std::make_shared<HeadsetOptions>();
  auto* command = app.add_subcommand("headset", "Say what the OpenXR headset on this machine offers");
  command->add_option("protocol", options->protocol,
                      "Protocol file or name: which of its settings are exact on it");
  command->add_option("--json", options->json, "File for the same as JSON")->check(output_file());
  auto* show = command->add_option("--show", options->show.seconds,
                                   "Show a test scene for this many seconds, and report what happened");
  show->check(CLI::Range(0.1, 3600.0));
  command->add_option("--refresh", options->show.refresh_hz, "Refresh rate to request with --show, Hz")
      ->check(CLI::Range(1.0, 1000.0))
      ->needs(show);
  command
      ->add_option("--patience", options->show.patience_s,
                   "Longest time that the runtime may hold a frame, s")
      ->check(CLI::Range(0.1, 600.0))
      ->needs(show);
  command->callback([options] {
    print_headset(*options);
    if (options->show.seconds > 0) show_in_headset(options->show);
  });
}

}  // namespace apps
