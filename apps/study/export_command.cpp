/// vip-study export: the database as tables of text.
#include <cstdio>
#include <memory>
#include <string>

#include "apps/study/commands.hpp"
#include "libstudy/store/export_csv.hpp"

namespace apps {

void add_export_command(CLI::App& app) {
  struct Options {
    std::string database, folder;
    bool words = false;
  };
  auto options = std::make_shared<Options>();
  CLI::App& sub = *app.add_subcommand("export", "Write a database as CSV files with a data dictionary");
  sub.add_option("--db", options->database, "Database of the study")->required();
  sub.add_option("--csv", options->folder, "Folder to make, or an earlier export to replace")->required();
  sub.add_flag("--words", options->words, "Also free words of participants and the experimenter's notes");
  sub.callback([options] {
    for (const study::ExportedFile& file :
         study::export_csv(options->database, options->folder, options->words)) {
      std::printf("%s: %lld rows\n", file.name.c_str(), static_cast<long long>(file.rows));
    }
  });
}

}  // namespace apps
