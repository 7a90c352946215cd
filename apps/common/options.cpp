#include "apps/common/options.hpp"

#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "libsim/methods/method.hpp"
#include "stats/base/error.hpp"
#include "stats/base/new_file.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

template <class Number>
std::optional<Number> signed_number(std::string_view text) {
  if (text.starts_with('+')) text.remove_prefix(1);
  return base::parse_number<Number>(text);
}

/// Checks a whole number and rewrites it without leading zeros: "10" for "010". Returns the problem, or an
/// empty text.
template <class Whole>
std::string check_whole(std::string& text) {
  const auto value = signed_number<Whole>(text);
  if (!value) {
    return "\"" + base::shortened(text) + "\" is not a whole number from " +
           std::to_string(std::numeric_limits<Whole>::min()) + " to " +
           std::to_string(std::numeric_limits<Whole>::max());
  }
  text = std::to_string(*value);
  return "";
}

std::string check_finite(std::string& text) {
  const auto value = signed_number<double>(text);
  return value && std::isfinite(*value) ? "" : "\"" + base::shortened(text) + "\" is not a finite number";
}

}  // namespace

CLI::Option* add_database(CLI::App& command, std::string& database) {
  return command.add_option("--db", database, "Database of the study")->required();
}

void add_incomplete(CLI::App& command, bool& incomplete) {
  command.add_flag("--incomplete", incomplete,
                   "Continue even if the journal of answers beside the database holds more than the "
                   "database; prints what is missing");
}

void add_database_argument(CLI::App& command, std::string& database) {
  auto* positional = command.add_option("database", database, "The study's database");
  command.add_option("--db", database, "The same as an option")->excludes(positional);
}

void check_given(const std::string& database) {
  if (database.empty()) throw CLI::RequiredError("database or --db");
}

CLI::Option* add_plan(CLI::App& command, std::string& plan) {
  return command.add_option(
      "--plan", plan,
      "Analysis plan (TOML): decision rule, tests, margins, level, exclusion rules, hypotheses, seed; "
      "without: the defaults");
}

CLI::Option* add_method(CLI::App& command, std::string& method) {
  return command.add_option("--method", method, sim::method_names())->capture_default_str();
}

CLI::Option* add_n_star(CLI::App& command, std::string& n_star) {
  return command
      .add_option("--n-star", n_star, "Number of particles if all were at the coarsest level; k = 1,024")
      ->capture_default_str();
}

CLI::Option* add_backend(CLI::App& command, std::string& backend) {
  return command.add_option("--backend", backend, "cpu, cuda or auto")->capture_default_str();
}

CLI::Option* add_backend(CLI::App& command, std::string& backend, const char* what) {
  return command.add_option("--backend", backend, what)
      ->check(CLI::IsMember({"cpu", "cuda", "auto"}))
      ->capture_default_str();
}

CLI::Option* add_size(CLI::App& command, base::PictureSize& size, const char* what) {
  const auto take = [&size](const std::string& text) { size = base::parse_picture_size(text); };
  return command.add_option_function<std::string>("--size", take, what)->default_str(base::size_words(size));
}

CLI::Option* add_size(CLI::App& command, std::optional<base::PictureSize>& size, const char* what) {
  const auto take = [&size](const std::string& text) { size = base::parse_picture_size(text); };
  return command.add_option_function<std::string>("--size", take, what);
}

std::array<CLI::Option*, 2> add_viewing(CLI::App& command, std::optional<double>& screen_width_mm,
                                        std::optional<double>& viewing_distance_mm,
                                        const char* width_of_what) {
  return {command.add_option("--screen-width-mm", screen_width_mm, width_of_what),
          command.add_option("--viewing-distance-mm", viewing_distance_mm, "From the eye to the screen")};
}

CLI::Option* add_count(CLI::App& command, const char* name, int& value, int low, int high, const char* what) {
  return command.add_option(name, value, what)->check(CLI::Range(low, high))->capture_default_str();
}

CLI::Validator number_in(double low, double high) {
  const std::string range = CLI::detail::to_string(low) + " to " + CLI::detail::to_string(high);
  const auto check = [low, high, range](std::string& text) -> std::string {
    double value = 0;
    const bool number = CLI::detail::lexical_cast(text, value) && std::isfinite(value);
    if (number && value >= low && value <= high) return "";
    return "\"" + base::shortened(text) + "\" is not a number from " + range;
  };
  return CLI::Validator(check, range);
}

CLI::Validator text_up_to(std::size_t most_bytes) {
  const auto check = [most_bytes](std::string& text) -> std::string {
    if (text.size() <= most_bytes) return "";
    return "\"" + base::shortened(text) + "\" is longer than " + std::to_string(most_bytes) + " bytes";
  };
  return CLI::Validator(check, "");
}

CLI::Validator output_file() {
  const auto check = [](std::string& path) -> std::string {
    base::check_output(path);
    return "";
  };
  return CLI::Validator(check, "");
}

CLI::Validator output_folder() {
  const auto check = [](std::string& path) -> std::string {
    base::check_output_folder(path);
    return "";
  };
  return CLI::Validator(check, "");
}

void check_apart(const std::filesystem::path& database, const std::map<std::string, std::string>& outputs) {
  const std::filesystem::path file = std::filesystem::weakly_canonical(database);
  std::map<std::filesystem::path, std::string> taken{{file, "the database"}};
  if (!database.empty())
    for (const char* end : {"-wal", "-shm", "-journal", ".answers.jsonl", ".personal"})
      taken[file.string() + end] = "a file of the database";
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    const auto [other, added] =
        taken.emplace(std::filesystem::weakly_canonical(path), "the file of " + option);
    if (!added)
      throw base::Error(option + " " + path, "is " + other->second, "give each output its own path");
  }
}

void check_arguments(int argc, const char* const* argv) {
  for (int i = 1; i < argc; ++i) {
    if (base::is_plain_line(argv[i])) continue;
    throw CLI::ValidationError(
        "argument " + std::to_string(i),
        "\"" + base::shortened(argv[i]) +
            "\" is not UTF-8 on one line; write or rename it without control characters");
  }
}

void check_numbers(CLI::App& app) {
  for (CLI::Option* option : app.get_options()) {
    const std::string type = option->get_type_name();
    if (type.starts_with("INT")) option->transform(CLI::Validator(check_whole<std::int64_t>, ""));
    if (type.starts_with("UINT")) option->transform(CLI::Validator(check_whole<std::uint64_t>, ""));
    if (type.starts_with("FLOAT")) option->transform(CLI::Validator(check_finite, ""));
  }
  for (CLI::App* command : app.get_subcommands([](CLI::App*) { return true; })) check_numbers(*command);
}

}  // namespace apps
