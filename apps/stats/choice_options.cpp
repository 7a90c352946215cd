#include "apps/stats/choice_options.hpp"

#include "apps/common/options.hpp"
#include "libstudy/preregistration/preregistration.hpp"

namespace apps {

CLI::Option* add_protocol_choice(CLI::App& command, ChoiceOptions& options) {
  return command.add_option(
      "--protocol", options.protocol,
      "Name of a protocol, 'NAME VERSION', or first digits of its SHA-256; without: every protocol "
      "by itself");
}

CLI::Option* add_level_choice(CLI::App& command, ChoiceOptions& options) {
  return command
      .add_option("--level", options.level,
                  "Pilot: score at which the curve is fitted; without: that of the plan, else of the "
                  "protocol, else the scale's middle")
      ->check(number_in(-1e6, 1e6));
}

study::FrozenFacts frozen_facts(const std::string& folder) {
  const auto bundle = study::report::read_bundle(folder);
  study::FrozenFacts out{bundle.sha256, bundle.about.at("frozen_utc").get<std::string>(), bundle.altered, {}};
  for (const auto& [sha256, text] : bundle.protocols) out.protocols.push_back(sha256);
  return out;
}

void add_choice(CLI::App& command, ChoiceOptions& options) {
  add_protocol_choice(command, options);
  command.add_option("--question", options.question, "Id of a question; without: every question by itself");
  add_level_choice(command, options);
}

}  // namespace apps
