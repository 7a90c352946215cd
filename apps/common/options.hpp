#pragma once
/// Options that several commands have, and what an option may be: nothing is clamped, cut or written on that
/// a file or a screen cannot hold.

#include <CLI/CLI.hpp>
#include <array>
#include <cstddef>
#include <filesystem>
#include <map>
#include <optional>
#include <string>

#include "apps/common/picture_size.hpp"

namespace apps {

/// --db DATABASE of vip-study, which must be given.
CLI::Option* add_database(CLI::App& command, std::string& database);

/// The database of vip-stats, by its place or as --db; whoever runs the command calls check_given.
void add_database_argument(CLI::App& command, std::string& database);
/// --incomplete of all commands that read a study (study::StudyFile).
void add_incomplete(CLI::App& command, bool& incomplete);
/// CLI::RequiredError where add_database_argument was given none.
void check_given(const std::string& database);

/// --plan FILE of vip-stats, with all that a plan holds.
CLI::Option* add_plan(CLI::App& command, std::string& plan);

/// --method NAME, --n-star NUMBER and --backend NAME of what runs one fluid, each with its default.
CLI::Option* add_method(CLI::App& command, std::string& method);
CLI::Option* add_n_star(CLI::App& command, std::string& n_star);
CLI::Option* add_backend(CLI::App& command, std::string& backend);
/// --backend as vip-study has it, which takes no other name.
CLI::Option* add_backend(CLI::App& command, std::string& backend, const char* what);

/// --size WIDTHxHEIGHT (parse_picture_size) with its default, or left empty without one.
CLI::Option* add_size(CLI::App& command, PictureSize& size, const char* what);
CLI::Option* add_size(CLI::App& command, std::optional<PictureSize>& size, const char* what);

/// --screen-width-mm and --viewing-distance-mm.
std::array<CLI::Option*, 2> add_viewing(CLI::App& command, std::optional<double>& screen_width_mm,
                                        std::optional<double>& viewing_distance_mm,
                                        const char* width_of_what);

/// Adds a CLI::Range check and the default to the help of a whole number.
CLI::Option* add_count(CLI::App& command, const char* name, int& value, int low, int high, const char* what);

/// Accepts finite numbers from low to high (CLI::Range lets NaN through).
CLI::Validator number_in(double low, double high);

/// Accepts texts of at most so many bytes.
CLI::Validator text_up_to(std::size_t most_bytes);

/// Throws base::Error unless a file can be written there (base::check_output): before an hour of work, not
/// after it.
CLI::Validator output_file();

/// The same of files in a folder (base::check_output_folder).
CLI::Validator output_folder();

/// Outputs by option, empty: not asked for. base::Error where one would overwrite the database or another.
void check_apart(const std::filesystem::path& database, const std::map<std::string, std::string>& outputs);

/// Throws CLI::ValidationError, which names the first argument that is not a plain line of UTF-8
/// (base::is_plain_line): arguments come to stand in databases, JSON and messages.
void check_arguments(int argc, const char* const* argv);

/// Gives each option of `app` and of its commands that is bound to a number a check before all others: digits
/// of a whole number that 64 bits hold, or a finite number. CLI11 itself takes the nearest number instead,
/// and reads 010 as eight.
void check_numbers(CLI::App& app);

}  // namespace apps
