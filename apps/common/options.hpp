#pragma once
/// Options that several commands share, and checks of options: values that a file or a screen cannot hold are
/// errors and are never clamped, cut or passed on.

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "stats/base/picture_size.hpp"

namespace apps {

/// Adds the required --db DATABASE of vip-study.
CLI::Option* add_database(CLI::App& command, std::string& database);

/// Adds the database of vip-stats, as a positional argument or as --db; the command must call check_given().
void add_database_argument(CLI::App& command, std::string& database);
/// Adds --incomplete, which all commands that read a study have (study::StudyFile).
void add_incomplete(CLI::App& command, bool& incomplete);
/// Throws CLI::RequiredError if add_database_argument() got no database.
void check_given(const std::string& database);

/// Adds --plan FILE of vip-stats; its help lists the content of a plan.
CLI::Option* add_plan(CLI::App& command, std::string& plan);

/// --method NAME, --n-star NUMBER and --backend NAME of commands that run one fluid, each with its default.
CLI::Option* add_method(CLI::App& command, std::string& method);
CLI::Option* add_n_star(CLI::App& command, std::string& n_star);
CLI::Option* add_backend(CLI::App& command, std::string& backend);
/// --backend of vip-study, which checks the name.
CLI::Option* add_backend(CLI::App& command, std::string& backend, const char* what);

/// --size WIDTHxHEIGHT (parse_picture_size) with its default, or empty by default.
CLI::Option* add_size(CLI::App& command, base::PictureSize& size, const char* what);
CLI::Option* add_size(CLI::App& command, std::optional<base::PictureSize>& size, const char* what);

/// --screen-width-mm and --viewing-distance-mm.
std::array<CLI::Option*, 2> add_viewing(CLI::App& command, std::optional<double>& screen_width_mm,
                                        std::optional<double>& viewing_distance_mm,
                                        const char* width_of_what);

/// Adds a CLI::Range check and the default to the help of a whole number.
CLI::Option* add_count(CLI::App& command, const char* name, int& value, int low, int high, const char* what);

/// Accepts finite numbers from low to high (CLI::Range lets NaN through).
CLI::Validator number_in(double low, double high);

/// Accepts texts of at most this many bytes.
CLI::Validator text_up_to(std::size_t most_bytes);

/// Throws base::Error if the file cannot be written (base::check_output): before an hour of work, not after
/// it.
CLI::Validator output_file();

/// The same for files in a folder (base::check_output_folder).
CLI::Validator output_folder();

/// `outputs`: path by option; an empty path is skipped. base::Error if one would overwrite the database or
/// another output.
void check_apart(const std::filesystem::path& database, const std::map<std::string, std::string>& outputs);

/// Throws CLI::ValidationError naming the first argument that is not one plain line of UTF-8
/// (base::is_plain_line), because arguments are copied into databases, JSON and messages.
void check_arguments(int argc, const char* const* argv);

/// Adds a check, before all others, to each numeric option of `app` and its commands: a whole number must be
/// digits that fit in 64 bits, any other number must be finite. CLI11 itself clamps to the nearest number and
/// reads 010 as eight.
void check_numbers(CLI::App& app);

}  // namespace apps
