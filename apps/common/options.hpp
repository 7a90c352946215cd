#pragma once
/// Options that several commands share, and checks of option values. A value that a file or a screen cannot
/// represent is refused, not clamped or cut.

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

/// Adds the database of vip-stats, as a positional argument or as --db. The command must then call
/// check_given().
void add_database_argument(CLI::App& command, std::string& database);
/// Adds --incomplete: a command that reads a study goes on although the journal of answers beside the
/// database holds more than the database (study::StudyFile).
void add_incomplete(CLI::App& command, bool& incomplete);
/// Throws CLI::RequiredError if add_database_argument() got no database.
void check_given(const std::string& database);

/// Adds --plan FILE of vip-stats; its help lists the content of a plan.
CLI::Option* add_plan(CLI::App& command, std::string& plan);

/// Adds --method NAME, --n-star NUMBER or --backend NAME to a command that runs one fluid. The present value
/// of the string is the default.
CLI::Option* add_method(CLI::App& command, std::string& method);
CLI::Option* add_n_star(CLI::App& command, std::string& n_star);
CLI::Option* add_backend(CLI::App& command, std::string& backend);
/// Adds --backend to a command of vip-study, with the help text `what`; refuses an unknown name.
CLI::Option* add_backend(CLI::App& command, std::string& backend, const char* what);

/// Adds --size WIDTHxHEIGHT (parse_picture_size). The present value of `size` is the default; an empty `size`
/// is no default.
CLI::Option* add_size(CLI::App& command, base::PictureSize& size, const char* what);
CLI::Option* add_size(CLI::App& command, std::optional<base::PictureSize>& size, const char* what);

/// Adds --screen-width-mm and --viewing-distance-mm.
std::array<CLI::Option*, 2> add_viewing(CLI::App& command, std::optional<double>& screen_width_mm,
                                        std::optional<double>& viewing_distance_mm,
                                        const char* width_of_what);

/// Adds an option for a whole number from low to high; the help shows the range and the default.
CLI::Option* add_count(CLI::App& command, const char* name, int& value, int low, int high, const char* what);

/// Accepts finite numbers from low to high. Unlike CLI::Range, it refuses NaN.
CLI::Validator number_in(double low, double high);

/// Accepts texts of at most this many bytes.
CLI::Validator text_up_to(std::size_t most_bytes);

/// Accepts paths of files that can be written; otherwise base::Error (base::check_output). The check runs
/// when the command line is parsed, so that no command computes a result that it cannot write.
CLI::Validator output_file();

/// Accepts folders in which files can be written; otherwise base::Error (base::check_output_folder).
CLI::Validator output_folder();

/// base::Error if an output would overwrite the database, a file that belongs to it, or another output.
/// `outputs`: path by option; an empty path is skipped.
void check_apart(const std::filesystem::path& database, const std::map<std::string, std::string>& outputs);

/// Throws CLI::ValidationError naming the first argument that is not one plain line of UTF-8
/// (base::is_plain_line), because arguments are copied into databases, JSON and messages.
void check_arguments(int argc, const char* const* argv);

/// Adds a check, before all others, to each numeric option of `app` and its commands: a whole number must be
/// digits, with or without a sign, that fit in 64 bits; any other number must be finite. Without this check,
/// CLI11 clamps to the nearest number and reads 010 as eight.
void check_numbers(CLI::App& app);

}  // namespace apps
