/// Values and names as PostgreSQL's texts.
#include <algorithm>
#include <charconv>
#include <cmath>

#include "libstudy/store/central/postgres.hpp"

namespace study::pg {

namespace {

/// True if a value in the text of an array needs quotes.
bool needs_quotes(const std::string& value) {
  const auto plain = [](char c) {
    return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'z') || c == '.' || c == '-' || c == '+';
  };
  // Values without capitals, so that NULL is not among them.
  return value.empty() || !std::all_of(value.begin(), value.end(), plain) || value == "null";
}

}  // namespace

void check_service_name(const std::string& service) {
  const auto plain = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' ||
           c == '-' || c == '.';
  };
  if (!service.empty() && std::all_of(service.begin(), service.end(), plain)) return;
  // The text is not shown, because it may contain a password.
  throw base::Error(
      "service", "is not a name of letters, digits, '.', '_' and '-'",
      "give the name of a section of libpq's service file, ~/.pg_service.conf, which holds host and "
      "database; passwords belong in ~/.pgpass");
}

std::string array_of(const std::vector<Row>& rows, std::size_t column) {
  std::string out = "{";
  for (const Row& row : rows) {
    if (out.size() > 1) out += ',';
    const Field& value = row.at(column);
    const bool quotes = value && needs_quotes(*value);
    if (quotes) out += '"';
    for (const char c : value ? *value : "NULL") {
      if (quotes && (c == '"' || c == '\\')) out += '\\';
      out += c;
    }
    if (quotes) out += '"';
  }
  return out + "}";
}

void append_line(const Row& row, std::string& out) {
  for (std::size_t i = 0; i < row.size(); ++i) {
    if (i > 0) out += '\t';
    if (!row[i]) {
      out += "\\N";
      continue;
    }
    for (const char c : *row[i]) {
      switch (c) {
        case '\\':
          out += "\\\\";
          break;
        case '\n':
          out += "\\n";
          break;
        case '\r':
          out += "\\r";
          break;
        case '\t':
          out += "\\t";
          break;
        default:
          out += c;
      }
    }
  }
  out += '\n';
}

std::string text_of(std::int64_t value) { return std::to_string(value); }

std::string text_of(double value) {
  if (std::isinf(value)) return value > 0 ? "Infinity" : "-Infinity";
  if (std::isnan(value)) return "NaN";
  char text[32];
  const auto end = std::to_chars(text, text + sizeof text, value);
  return {text, end.ptr};
}

std::string quoted_name(const std::string& name) {
  std::string out = "\"";
  for (const char c : name) out += c == '"' ? std::string("\"\"") : std::string(1, c);
  return out + "\"";
}

std::string quoted_text(const std::string& text) {
  std::string out = "'";
  for (const char c : text) out += c == '\'' ? std::string("''") : std::string(1, c);
  return out + "'";
}

}  // namespace study::pg
