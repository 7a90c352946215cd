#include "apps/study/withdrawal.hpp"

#include <cstdio>

#include "apps/study/clean_up.hpp"
#include "libstudy/store/withdraw.hpp"
#include "stats/base/error.hpp"

namespace apps {

void withdraw_and_tell(const std::filesystem::path& database, const std::string& participant) {
  const study::Withdrawal done = study::withdraw(database, participant);
  std::printf("%s: %lld sessions, %lld answers and %lld frames of %s deleted\n", database.c_str(),
              static_cast<long long>(done.deleted.sessions), static_cast<long long>(done.deleted.answers),
              static_cast<long long>(done.deleted.frames), participant.c_str());
  print_clean_up(done.beside);
  print_list("Recorded at these stations: withdraw in their own databases, or merge this one into them:",
             done.deleted.stations);
  study::check_nothing_left(database, done.beside.left);
}

void check_no_withdrawal_is_due(const study::StudyFile& study) {
  for (const std::string& participant : study::requested_withdrawals(study)) {
    throw base::Error(study.path.string(), "participant " + participant + " asked that all data be deleted",
                      "run vip-study withdraw " + participant + " --db " + study.path.string());
  }
}

}  // namespace apps
