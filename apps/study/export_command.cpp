/// vip-study export: writes the database as CSV tables, as a BIDS data set or as a Psych-DS data set.
#include <cstdio>
#include <memory>
#include <string>

#include "apps/common/options.hpp"
#include "apps/study/clean_up.hpp"
#include "apps/study/commands.hpp"
#include "libstudy/store/export/export_bids.hpp"
#include "libstudy/store/export/export_csv.hpp"
#include "libstudy/store/export/export_psych_ds.hpp"
#include "libstudy/store/open_study.hpp"
#include "libstudy/store/own_exports.hpp"
#include "stats/base/streams.hpp"

namespace apps {

namespace {

void print_files(const std::vector<study::ExportedFile>& files) {
  for (const study::ExportedFile& file : files)
    std::printf("%s: %lld rows\n", file.name.c_str(), static_cast<long long>(file.rows));
}

void print_people(const study::SharingCount& people, const std::string& folder) {
  const auto number = [](std::int64_t count) { return static_cast<long long>(count); };
  std::printf(
      "%s: %lld people are in it; %lld left out: %lld refused that their data be shared, %lld were asked and "
      "have not answered\n",
      folder.c_str(), number(people.allowed + people.not_asked), number(people.refused + people.not_answered),
      number(people.refused), number(people.not_answered));
  if (people.not_asked > 0) {
    std::printf("%s: %lld of those in it were never asked whether their data may be shared\n", folder.c_str(),
                number(people.not_asked));
  }
}

void print_public(const study::PublicExport& done, const std::string& folder) {
  print_files(done.files);
  print_people(done.people, folder);
}

}  // namespace

void add_export_command(CLI::App& app) {
  struct Options {
    std::string database, csv, bids, psych_ds;
    bool words = false, gaze = false, incomplete = false, excel = false, presentmon = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App& sub = *app.add_subcommand("export", "Write a database as files for others");
  add_database(sub, options->database);
  auto* formats = sub.add_option_group("formats");
  auto* csv = formats->add_option("--csv", options->csv, "Folder of CSV files with a data dictionary")
                  ->check(output_folder());
  formats->add_option("--bids", options->bids, "Folder of a BIDS data set (behaviour)")
      ->check(output_folder());
  formats->add_option("--psych-ds", options->psych_ds, "Folder of a Psych-DS data set")
      ->check(output_folder());
  formats->require_option(1, 3);
  sub.add_flag("--words", options->words,
               "CSV: also free words of participants and the experimenter's notes");
  sub.add_flag("--excel", options->excel,
               "CSV: for spreadsheets that open a file at a double click: a byte-order mark, and where the "
               "locale's decimal mark is a comma, semicolons and decimal commas")
      ->needs(csv);
  sub.add_flag("--presentmon", options->presentmon,
               "CSV: also the frame times of each showing in the format of PresentMon")
      ->needs(csv);
  sub.add_flag("--gaze", options->gaze,
               "CSV, BIDS: also gaze, of those who allowed it; mouse positions are marked as such");
  add_incomplete(sub, options->incomplete);
  sub.footer(
      "BIDS and Psych-DS leave out whoever refused that data be shared; CSV is the lab's own copy and holds "
      "everybody. \n"
      "The folder is created, or replaced when it is an unchanged earlier export. It is registered in the "
      "database,\n"
      "which must be writable for that, and in your own register (~/.local/state/vip-lab/exports.jsonl): "
      "when "
      "one of\n"
      "the people in it withdraws, the folder is deleted, to be exported again. A folder that the register "
      "lacks, or that was\nchanged, is listed and not deleted.\n"
      "Only the owner can read CSV (folder 0700, files 0600), since it holds all that is known of people;\n"
      "BIDS and Psych-DS can be read by others, as the umask allows.\n"
      "A text that a spreadsheet would take for a formula has an apostrophe before it (dictionary.csv says "
      "how\n"
      "to take it away).");
  sub.callback([options] {
    const study::StudyFile file(options->database, options->incomplete);
    check_no_withdrawal_is_due(file);
    if (file.incomplete) print_lacking(file.path, study::lacking_of(file.path));
    if (!options->csv.empty()) {
      const study::CsvDialect dialect = options->excel ? study::excel_dialect() : study::CsvDialect{};
      print_files(study::export_csv(file, options->csv,
                                    {options->words, options->gaze, options->presentmon, dialect}));
      if (options->excel)
        std::printf("%s: '%c' between fields, '%c' as the decimal mark, as the locale has it\n",
                    options->csv.c_str(), dialect.separator, dialect.decimal);
    }
    if (!options->bids.empty()) {
      print_public(study::export_bids(file, options->bids, options->gaze), options->bids);
    }
    if (!options->psych_ds.empty()) {
      print_public(study::export_psych_ds(file, options->psych_ds), options->psych_ds);
    }
    if (const auto why = study::why_not_registered())
      std::fprintf(stderr,
                   "exports cannot be registered, so a withdrawal lists them and does not delete them: %s\n",
                   base::for_terminal(*why).c_str());
  });
}

}  // namespace apps
