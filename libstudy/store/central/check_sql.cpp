/// Translates the CHECKs of SQLite's tables to PostgreSQL.
#include <algorithm>
#include <cctype>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "libstudy/store/central/central_schema.hpp"
#include "stats/base/error.hpp"

namespace study::central {

namespace {

enum class CheckWord { Name, Number, Text, Sign };
struct CheckToken {
  CheckWord kind;
  std::string text;
};

bool is_name_part(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

[[noreturn]] void refuse_check(const std::string& place, const std::string& expression,
                               const std::string& part) {
  throw base::Error(place, "CHECK (" + expression + ") has no counterpart in PostgreSQL: " + part,
                    "add its translation to libstudy/store/central/check_sql.cpp");
}

std::vector<CheckToken> tokens_of(const std::string& sql, const std::string& place) {
  std::vector<CheckToken> tokens;
  for (std::size_t i = 0; i < sql.size();) {
    std::size_t end = i + 1;
    const char c = sql[i];
    CheckWord kind = CheckWord::Sign;
    if (c == '\'' || c == '"') {
      end = sql.find(c, i + 1);
      // A doubled quote inside a text does not occur.
      if (end == std::string::npos || sql.find(c, end + 1) == end + 1)
        refuse_check(place, sql, sql.substr(i));
      ++end;
      kind = c == '"' ? CheckWord::Name : CheckWord::Text;
    } else if (std::isdigit(static_cast<unsigned char>(c))) {
      while (end < sql.size() && (is_name_part(sql[end]) || sql[end] == '.')) ++end;
      kind = CheckWord::Number;
    } else if (is_name_part(c)) {
      while (end < sql.size() && is_name_part(sql[end])) ++end;
      kind = CheckWord::Name;
    } else if (end < sql.size() && (c == '<' || c == '>') && (sql[end] == '=' || sql[end] == '>')) {
      ++end;
    }
    const bool inner = c == '\'' || c == '"';
    if (c != ' ') tokens.push_back({kind, inner ? sql.substr(i + 1, end - i - 2) : sql.substr(i, end - i)});
    i = end;
  }
  return tokens;
}

/// A pattern of GLOB as a regular expression for the whole text.
std::string regex_of(const std::string& glob) {
  std::string out = "^";
  for (std::size_t i = 0; i < glob.size(); ++i) {
    const char c = glob[i];
    if (c == '*') {
      out += ".*";
    } else if (c == '?') {
      out += '.';
    } else if (c == '[') {
      const std::size_t end = glob.find(']', i + 2);
      out += glob.substr(i, end - i + 1);
      i = end;
    } else {
      if (!is_name_part(c)) out += '\\';
      out += c;
    }
  }
  return out + "$";
}

}  // namespace

std::string translated_check(const std::string& expression,
                             const std::vector<std::pair<std::string, std::string>>& renamed,
                             const std::string& place) {
  static const std::set<std::string> words{"AND", "OR", "NOT", "IN", "IS", "NULL", "BETWEEN", "length"};
  static const std::set<std::string> signs{"(", ")", ",", "=", "<", ">", "<=", ">=", "<>"};
  const auto tokens = tokens_of(expression, place);
  std::string out;
  for (std::size_t i = 0; i < tokens.size(); ++i) {
    const CheckWord kind = tokens[i].kind;
    const std::string& text = tokens[i].text;
    const auto column =
        std::find_if(renamed.begin(), renamed.end(), [&](const auto& one) { return one.first == text; });
    std::string piece;
    if (kind == CheckWord::Text) {
      piece = "'" + text + "'";
    } else if (kind == CheckWord::Name && column != renamed.end()) {
      piece = "\"" + column->second + "\"";
    } else if (kind == CheckWord::Name && text == "NOT" && i + 1 < tokens.size() &&
               tokens[i + 1].text == "GLOB") {
      continue;
    } else if (kind == CheckWord::Name && text == "GLOB" && i + 1 < tokens.size() &&
               tokens[i + 1].kind == CheckWord::Text) {
      const bool negative = i > 0 && tokens[i - 1].text == "NOT";
      piece = std::string(negative ? "!~ '" : "~ '") + regex_of(tokens[++i].text) + "'";
    } else if (kind == CheckWord::Number || (kind == CheckWord::Sign && signs.contains(text)) ||
               (kind == CheckWord::Name && words.contains(text))) {
      piece = text;
    } else {
      refuse_check(place, expression, text);
    }
    out += (out.empty() ? "" : " ") + piece;
  }
  return out;
}

}  // namespace study::central
