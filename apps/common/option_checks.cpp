#include "apps/common/option_checks.hpp"

#include <charconv>
#include <cmath>
#include <limits>
#include <string>
#include <string_view>

#include "stats/base/error.hpp"
#include "stats/base/new_file.hpp"
#include "stats/base/text.hpp"

namespace apps {

namespace {

template <class Number>
bool reads_whole(std::string_view text, Number& value) {
  if (text.starts_with('+')) text.remove_prefix(1);
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  return problem == std::errc() && end == text.data() + text.size();
}

/// Digits as they count, "10" for "010".
template <class Whole>
std::string check_whole(std::string& text) {
  Whole value{};
  if (!reads_whole(text, value)) {
    return "\"" + base::shortened(text) + "\" is not a whole number from " +
           std::to_string(std::numeric_limits<Whole>::min()) + " to " +
           std::to_string(std::numeric_limits<Whole>::max());
  }
  text = std::to_string(value);
  return "";
}

std::string check_finite(std::string& text) {
  double value = 0;
  const bool finite = reads_whole(text, value) && std::isfinite(value);
  return finite ? "" : "\"" + base::shortened(text) + "\" is not a number that can be counted with";
}

}  // namespace

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
  std::map<std::filesystem::path, std::string> taken{
      {std::filesystem::weakly_canonical(database), "the database"}};
  for (const auto& [option, path] : outputs) {
    if (path.empty()) continue;
    const auto [other, added] = taken.emplace(std::filesystem::weakly_canonical(path), option);
    if (!added)
      throw base::Error(option + " " + path, "is " + other->second, "give each output a place of its own");
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
