#include "stats/base/toml_text.hpp"

#include <algorithm>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/text.hpp"

namespace base {

namespace {

constexpr std::string_view byte_order_mark = "\xEF\xBB\xBF";

/// Scans a text with just enough grammar to distinguish keys, values, quoted texts and comments. After a
/// syntax error the scan may be wrong, which does no harm, because the parser refuses the text at the error.
class Walk {
 public:
  Walk(std::string_view text, const std::string& name) : text_(text), name_(name) {}

  void check_characters() {
    for (at_ = 0; at_ < text_.size();) {
      const std::size_t length = utf8_length(text_.substr(at_));
      if (length == 0) fail("is not UTF-8", "save the file as UTF-8");
      const auto c = static_cast<unsigned char>(text_[at_]);
      const bool line_end = c == '\n' || (c == '\r' && text_.substr(at_, 2) == "\r\n");
      if ((c < 0x20 && c != '\t' && !line_end) || c == 0x7F)
        fail("holds a control character", "remove it, or write it within quotes as \\u and four digits");
      at_ += length;
    }
  }

  void check_structure() {
    for (at_ = 0; at_ < text_.size();) {
      const char c = text_[at_];
      if (c == '#')
        skip_line();
      else if (c == '"' || c == '\'')
        skip_text(c);
      else
        step(c);
    }
  }

 private:
  /// A list or inline table whose closing bracket has not been reached yet.
  struct Bracket {
    char kind;
    int depth;  // nesting depth of keys and brackets around its contents
  };

  void step(char c) {
    if (static_cast<unsigned char>(c) >= 0x80)
      fail("is a character outside ASCII that is not within quotes", "put the word in double quotes");
    check_value_is_alone(c);
    const bool top = open_.empty();
    if (c == '\n' && top)
      start_line();
    else if (c == '=')
      await_value();
    else if (c == '.' && key_)
      deepen();
    else if (c == ',' && !top)
      start_element();
    else if (c == '[' && top && key_)
      open_header();
    else if (c == ']' && header_)
      close_header();
    else if (c == '[' || c == '{')
      open_bracket(c);
    else if ((c == ']' || c == '}') && !top)
      close_bracket();
    else if (!is_space(c) && !key_)
      value_ = true;
    ++at_;
  }

  static bool is_space(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n'; }

  void await_value() {
    key_ = false;
    value_ = false;
  }

  void start_line() {
    depth_ = header_depth_;
    key_ = true;
    header_ = false;
  }

  /// Begins a table header such as [a.b]. Its nesting depth counts from the document's root, not from the
  /// header before it.
  void open_header() {
    header_ = true;
    depth_ = 1;
  }

  void close_header() {
    header_depth_ = depth_;
    header_ = false;
    end_value();
  }

  void start_element() {
    depth_ = open_.back().depth;
    key_ = open_.back().kind == '{';
    value_ = false;
  }

  void open_bracket(char kind) {
    deepen();
    open_.push_back({kind, depth_});
    key_ = kind == '{';
    value_ = false;
  }

  void close_bracket() {
    open_.pop_back();
    end_value();
  }

  /// Marks the value as complete: until the next comma or line end, a quote or opening bracket is an error.
  void end_value() {
    key_ = false;
    value_ = true;
  }

  void deepen() {
    if (++depth_ > most_toml_levels)
      fail("is nested more than " + std::to_string(most_toml_levels) + " levels deep",
           "use fewer dots in keys and brackets within brackets");
  }

  void skip_line() { at_ = std::min(text_.find('\n', at_), text_.size()); }

  /// Refuses a second '=', and a quote or opening bracket directly after a value: toml++ 3.3 reads text
  /// directly after a number or date as a part of that value.
  void check_value_is_alone(char c) const {
    if (!key_ && (c == '=' || (value_ && std::string_view("\"'[{").find(c) != std::string_view::npos)))
      fail(std::string("is a ") + c + " behind a value", "put a comma or the end of the line between them");
  }

  void check_key_begins() const {
    constexpr std::string_view separators = " \t\n[{,.";
    if (key_ && at_ > 0 && separators.find(text_[at_ - 1]) == std::string_view::npos)
      fail("is a quote behind a key", "put a dot or an equals sign between them");
  }

  void skip_text(char quote) {
    check_value_is_alone(quote);
    check_key_begins();
    value_ = !key_;
    const std::string three(3, quote);
    if (text_.substr(at_, 3) != three) return skip_one_line_text(quote);
    at_ += 3;
    while (at_ < text_.size() && text_.substr(at_, 3) != three) skip_in_text(quote, true);
    at_ = std::min(at_ + 3, text_.size());
    // A multi-line text may itself end with up to two quotes, before the closing three.
    for (int i = 0; i < 2 && at_ < text_.size() && text_[at_] == quote; ++i) ++at_;
  }

  void skip_one_line_text(char quote) {
    ++at_;
    while (at_ < text_.size() && text_[at_] != quote && text_[at_] != '\n') skip_in_text(quote, false);
    if (at_ < text_.size() && text_[at_] == quote) ++at_;
  }

  void skip_in_text(char quote, bool lines) {
    if (quote == '"' && text_[at_] == '\\') return skip_escape(lines);
    ++at_;
  }

  void skip_escape(bool lines) {
    const std::string_view rest = text_.substr(at_);
    if (rest.starts_with("\\u0000") || rest.starts_with("\\U00000000"))
      fail("is a NUL within a text", "remove this escape");
    ++at_;
    if (!lines) {
      if (at_ < text_.size() && text_[at_] != '\n') ++at_;
      return;
    }
    const std::size_t next = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
    const bool line_ending = next > at_;
    at_ = next;
    if (at_ < text_.size() && static_cast<unsigned char>(text_[at_]) >= 0x80)
      fail("is a character outside ASCII right after a backslash at a line's end",
           "write it as \\u and four digits, or join the lines");
    if (!line_ending && at_ < text_.size()) ++at_;
  }

  [[noreturn]] void fail(const std::string& problem, const std::string& mend) const {
    const auto before = text_.substr(0, at_);
    const auto line_start = before.rfind('\n') == std::string_view::npos ? 0 : before.rfind('\n') + 1;
    const auto line = 1 + std::count(before.begin(), before.end(), '\n');
    const auto column =
        1 + std::count_if(before.begin() + static_cast<std::ptrdiff_t>(line_start), before.end(),
                          [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; });
    throw Error(name_ + ":" + std::to_string(line) + ":" + std::to_string(column), problem, mend);
  }

  std::string_view text_;
  const std::string& name_;
  std::size_t at_ = 0;
  std::vector<Bracket> open_;
  int depth_ = 0, header_depth_ = 0;
  bool key_ = true, header_ = false;
  /// Outside keys: true if a value has begun, or a table header has ended, since the last '=', ',' or opening
  /// bracket.
  bool value_ = false;
};

}  // namespace

void check_toml_text(std::string_view text, const std::string& name) {
  if (text.size() > most_toml_bytes)
    throw Error(name,
                "holds " + std::to_string(text.size()) + " bytes, at most " +
                    std::to_string(most_toml_bytes) + " are read",
                "name the right file, or shorten its texts");
  if (text.starts_with(byte_order_mark)) text.remove_prefix(byte_order_mark.size());
  Walk walk(text, name);
  walk.check_characters();
  walk.check_structure();
}

}  // namespace base
