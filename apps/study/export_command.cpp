/// vip-study export: the database as tables of text.
#include <cstdio>
#include <memory>
#include <string>

#include "apps/study/commands.hpp"
#include "libstudy/store/export_bids.hpp"
#include "libstudy/store/export_csv.hpp"
#include "libstudy/store/export_psych_ds.hpp"

namespace apps {

namespace {

void print_files(const std::vector<study::ExportedFile>& files) {
  for (const study::ExportedFile& file : files)
    std::printf("%s: %lld rows\n", file.name.c_str(), static_cast<long long>(file.rows));
}

}  // namespace

void add_export_command(CLI::App& app) {
  struct Options {
    std::string database, csv, bids, psych_ds;
    bool words = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App& sub = *app.add_subcommand("export", "Write a database as files for others");
  sub.add_option("--db", options->database, "Database of the study")->required();
  auto* formats = sub.add_option_group("formats");
  formats->add_option("--csv", options->csv, "Folder of CSV files with a data dictionary");
  formats->add_option("--bids", options->bids, "Folder of a BIDS data set (behaviour)");
  formats->add_option("--psych-ds", options->psych_ds, "Folder of a Psych-DS data set");
  formats->require_option(1, 3);
  sub.add_flag("--words", options->words,
               "CSV: also free words of participants and the experimenter's notes");
  sub.footer(
      "A folder is made, or replaced when it is an earlier export. It is registered in the database, which "
      "must be\n"
      "writable for that: when one of the people in it withdraws, the folder is deleted, to be exported "
      "again.");
  sub.callback([options] {
    if (!options->csv.empty())
      print_files(study::export_csv(options->database, options->csv, options->words));
    if (!options->bids.empty()) print_files(study::export_bids(options->database, options->bids));
    if (!options->psych_ds.empty()) print_files(study::export_psych_ds(options->database, options->psych_ds));
  });
}

}  // namespace apps
