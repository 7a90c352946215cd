#pragma once
/// What an option may be: nothing is clamped, cut or written on that a file or a screen cannot hold.

#include <CLI/CLI.hpp>
#include <cstddef>
#include <filesystem>
#include <map>
#include <string>

namespace apps {

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
