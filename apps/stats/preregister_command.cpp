/// vip-stats preregister: freezes protocol, hypotheses, rules and seed in a folder with one hash, before the
/// data are collected.

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "apps/common/options.hpp"
#include "apps/stats/commands.hpp"
#include "libstudy/preregistration/preregistration.hpp"
#include "libstudy/protocol/find_protocol.hpp"
#include "stats/base/error.hpp"

namespace apps {

namespace {

struct PreregisterCommand {
  std::vector<std::string> protocols;
  std::string plan, power, out;
  std::optional<std::uint64_t> seed;
};

/// Reads the plan. A plan that declares hypotheses or a comparison of models needs exactly one protocol,
/// against whose factors and questions they are checked.
stats::AnalysisPlan read_checked_plan(const PreregisterCommand& command) {
  auto plan = study::read_plan(command.plan).plan;
  if (plan.hypotheses.empty() && !plan.comparison) return plan;
  if (command.protocols.size() != 1)
    throw base::Error(command.plan,
                      "declares hypotheses or a comparison of models of one study, but " +
                          std::to_string(command.protocols.size()) + " protocols are given",
                      "freeze the protocol of the declared analyses by itself");
  const auto protocol = study::read_protocol(study::find_protocol(command.protocols.front()));
  return study::read_plan(command.plan, &protocol).plan;
}

void preregister(const PreregisterCommand& command) {
  study::report::BundleRequest request;
  request.protocols.assign(command.protocols.begin(), command.protocols.end());
  if (!command.plan.empty()) request.plan = read_checked_plan(command);
  if (command.seed) request.plan.seed = *command.seed;
  if (!command.power.empty()) request.power = command.power;
  const std::string hash = study::report::freeze_bundle(request, command.out);
  for (const auto& one : study::report::untested_claims(request))
    std::printf("not tested: %s\n", one.c_str());
  std::printf("%s  %s\nDeposit this hash where its date can be proved, before the first participant.\n",
              hash.c_str(), command.out.c_str());
}

}  // namespace

void add_preregister_command(CLI::App& app) {
  auto command = std::make_shared<PreregisterCommand>();
  auto* sub =
      app.add_subcommand("preregister", "Freeze protocol, hypotheses, rules and seed into one hashed folder");
  sub->add_option("protocols", command->protocols,
                  "Protocols of the study: files, or names of those that come with the program")
      ->required();
  sub->add_option("--out", command->out, "Folder to be made")->required()->check(output_folder());
  sub->add_option("--plan", command->plan,
                  "Analysis plan (TOML): decision rule, tests, margins, level, exclusion rules, hypotheses; "
                  "without: the defaults");
  sub->add_option("--seed", command->seed, "Seed of the resamples, instead of the plan's")
      ->check(CLI::NonNegativeNumber);
  sub->add_option("--power", command->power, "Result of vip-stats power --json, to be frozen as well");
  sub->callback([command] { preregister(*command); });
}

}  // namespace apps
