/// vip-study central: makes the central database of a lab and lets stations and readers in.
#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/store/central/central_admin.hpp"

namespace apps {

namespace {

using study::central::Admission;

struct CentralCommand {
  std::string service, role;
  bool shared_only = false;
};

void admit_and_tell(const CentralCommand& command, Admission admission) {
  study::central::admit(command.service, command.role, admission);
  const char* may = admission == Admission::Station ? "push its own rows, and reads no others"
                    : admission == Admission::LabReader
                        ? "read everything but withdrawn people and refused gaze"
                        : "read what people agree to share";
  std::printf("%s: the role %s may %s\n", command.service.c_str(), command.role.c_str(), may);
}

void upgrade_and_tell(const CentralCommand& command) {
  const auto done = study::central::upgrade(command.service);
  std::printf("%s: schema %lld, before it was %lld\n", command.service.c_str(),
              static_cast<long long>(done.now), static_cast<long long>(done.before));
  print_list("Added:", done.added);
}

CLI::App& add_part(CLI::App& central, const char* name, const char* what, CentralCommand& command) {
  CLI::App& sub = *central.add_subcommand(name, what);
  add_service(sub, "--service", command.service, "Service of the owner of the central database");
  return sub;
}

}  // namespace

CLI::Option* add_service(CLI::App& command, const char* name, std::string& service, const char* what) {
  return command.add_option(name, service, std::string(what) + ": a section of libpq's service file")
      ->required()
      ->type_name("SERVICE");
}

void add_central_command(CLI::App& app) {
  auto command = std::make_shared<CentralCommand>();
  CLI::App& sub =
      *app.add_subcommand("central", "Make the central database of a lab (PostgreSQL), as its owner");
  sub.require_subcommand(1);
  add_part(sub, "init", "Make the tables in an empty database", *command).callback([command] {
    study::central::init(command->service);
    std::printf("%s: made\n", command->service.c_str());
  });
  add_part(sub, "upgrade", "Bring the tables to the schema of this program", *command).callback([command] {
    upgrade_and_tell(*command);
  });
  CLI::App& station = add_part(sub, "add-station", "Let a role push its own rows", *command);
  station.add_option("role", command->role, "Login role that the server has")->required();
  station.callback([command] { admit_and_tell(*command, Admission::Station); });
  CLI::App& reader = add_part(sub, "add-reader", "Let a role read", *command);
  reader.add_option("role", command->role, "Login role that the server has")->required();
  reader.add_flag("--shared-only", command->shared_only, "Only what people agree to share");
  reader.callback([command] {
    admit_and_tell(*command, command->shared_only ? Admission::SharedReader : Admission::LabReader);
  });
}

}  // namespace apps
