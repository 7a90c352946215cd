#include "apps/study/clean_up.hpp"

#include <cstdio>

#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"

namespace apps {

void print_list(const char* title, const std::vector<std::string>& lines) {
  if (lines.empty()) return;
  std::printf("%s\n", title);
  for (const std::string& line : lines) std::printf("  %s\n", line.c_str());
}

void print_lacking(const std::filesystem::path& database, const std::string& lacking) {
  if (!lacking.empty()) std::printf("%s is incomplete: %s\n", database.c_str(), lacking.c_str());
}

void print_clean_up(const study::CleanUp& done) {
  for (const auto& path : done.cleaned) {
    std::error_code ignored;
    const bool stands = std::filesystem::exists(path, ignored);
    std::printf(stands ? "cleaned as well: %s\n" : "deleted, make it again: %s\n", path.c_str());
  }
  print_list("Still left:", done.left);
}

void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant) {
  const study::Withdrawal done = study::withdraw(database, participant);
  std::printf("%s: %lld sessions, %lld answers and %lld frames of %s deleted\n", database.c_str(),
              static_cast<long long>(done.deleted.sessions), static_cast<long long>(done.deleted.answers),
              static_cast<long long>(done.deleted.frames), participant.c_str());
  print_clean_up(done.beside);
  print_list("Recorded at these stations: withdraw in their own databases, or merge this one into them:",
             done.deleted.stations);
  print_list("Imported from these files, which still hold the answers: delete them by hand:",
             done.deleted.sources);
  study::check_nothing_left(database, done.beside.left);
}

void check_no_withdrawal_is_due(const study::StudyFile& study) {
  for (const std::string& participant : study::requested_withdrawals(study)) {
    throw base::Error(study.path.string(), "participant " + participant + " asked that all data be deleted",
                      "run vip-study withdraw " + participant + " --db " + study.path.string());
  }
}

}  // namespace apps
