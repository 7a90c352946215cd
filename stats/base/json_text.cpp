/// Reads and prints JSON: the only source that includes nlohmann's library.

#include <istream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <set>

#include "stats/base/json.hpp"
#include "stats/base/json_problems.hpp"

namespace base {

using Library = nlohmann::ordered_json;

/// Converts between base::Json and nlohmann's values.
struct JsonLibrary {
  static Json from(const Library& value) {
    switch (value.type()) {
      case Library::value_t::boolean:
        return value.get<bool>();
      case Library::value_t::number_integer:
        return value.get<std::int64_t>();
      case Library::value_t::number_unsigned:
        return value.get<std::uint64_t>();
      case Library::value_t::number_float:
        return value.get<double>();
      case Library::value_t::string:
        return value.get_ref<const std::string&>();
      case Library::value_t::array: {
        Json out = Json::array();
        out.items_.reserve(value.size());
        for (const Library& item : value) out.items_.push_back(from(item));
        return out;
      }
      case Library::value_t::object: {
        Json out = Json::object();
        out.items_.reserve(value.size());
        out.keys_.reserve(value.size());
        for (const auto& [key, item] : value.items()) {
          out.keys_.push_back(key);
          out.items_.push_back(from(item));
        }
        return out;
      }
      default:
        return {};
    }
  }

  static Library to(const Json& value) {
    switch (value.type_) {
      case Json::Type::Null:
        return nullptr;
      case Json::Type::Boolean:
        return value.boolean_;
      case Json::Type::Signed:
        return value.signed_;
      case Json::Type::Unsigned:
        return value.unsigned_;
      case Json::Type::Double:
        return value.double_;
      case Json::Type::Text:
        return value.text_;
      case Json::Type::Array: {
        Library out = Library::array();
        for (const Json& item : value.items_) out.push_back(to(item));
        return out;
      }
      case Json::Type::Object: {
        // Appends to the underlying vector, because ordered_json's own emplace would search all earlier keys
        // for each new one. Keys of a Json object are unique already.
        Library::object_t out;
        out.reserve(value.items_.size());
        for (std::size_t i = 0; i < value.items_.size(); ++i)
          static_cast<std::vector<Library::object_t::value_type>&>(out).emplace_back(value.keys_[i],
                                                                                     to(value.items_[i]));
        return out;
      }
    }
    return {};
  }
};

namespace {

/// Reads a text until an object names a key again.
class KeyReader final : public nlohmann::json_sax<Library> {
 public:
  std::optional<RepeatedKey> found;

  bool null() override { return value(); }
  bool boolean(bool) override { return value(); }
  bool number_integer(number_integer_t) override { return value(); }
  bool number_unsigned(number_unsigned_t) override { return value(); }
  bool number_float(number_float_t, const string_t&) override { return value(); }
  bool string(string_t&) override { return value(); }
  bool binary(binary_t&) override { return value(); }
  bool start_array(std::size_t) override { return open(true); }
  bool start_object(std::size_t) override { return open(false); }
  bool end_array() override { return close(); }
  bool end_object() override { return close(); }
  bool key(string_t& key) override {
    if (!levels_.back().insert(key).second) found = {key, entry_};
    return !found;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override {
    return false;
  }

 private:
  /// Counts the elements of the outermost list.
  bool value() {
    if (list_ && levels_.size() == 1) ++entry_;
    return true;
  }
  bool open(bool list) {
    if (levels_.empty()) list_ = list;
    value();
    levels_.emplace_back();
    return true;
  }
  bool close() {
    levels_.pop_back();
    return true;
  }

  std::vector<std::set<std::string>> levels_;  ///< keys of each open object; none of an open list
  bool list_ = false;                          ///< the outermost value is a list
  std::size_t entry_ = 0;
};

}  // namespace

std::string json_problem(const std::string& message) {
  const auto says = [&](const char* words) { return message.find(words) != std::string::npos; };
  std::string problem =
      says("unexpected end of input") || says("missing closing quote") || says("empty input")
          ? "it ends too early"
      : says("expected end of input") ? "it goes on behind its end"
      : says("UTF-8")                 ? "it has bytes that are not UTF-8"
      : says("nested deeper than")    ? message
                                      : "it has a mistake";
  if (const std::size_t line = message.find("line "), end = message.find(':', line);
      line != std::string::npos && end != std::string::npos)
    problem += ", at " + message.substr(line, end - line);
  return problem;
}

std::optional<RepeatedKey> repeated_key(std::string_view json) {
  KeyReader reader;
  Library::sax_parse(json, &reader);
  return reader.found;
}

Json Json::parse(std::string_view text) {
  if (nested_deeper_than(most_json_levels, text))
    throw JsonError("the text is nested deeper than " + std::to_string(most_json_levels) + " levels");
  try {
    return JsonLibrary::from(Library::parse(text));
  } catch (const Library::exception& error) {
    throw JsonError(error.what());
  }
}

Json Json::parse(std::istream& text) {
  return parse(std::string(std::istreambuf_iterator<char>(text), std::istreambuf_iterator<char>()));
}

std::string Json::dump(int indent) const {
  return JsonLibrary::to(*this).dump(indent, ' ', false, Library::error_handler_t::replace);
}

bool nested_deeper_than(int levels, std::string_view json) {
  int depth = 0;
  bool text = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (text) {
      if (c == '\\') ++i;
      if (c == '"') text = false;
    } else if (c == '"') {
      text = true;
    } else if (c == '[' || c == '{') {
      if (++depth > levels) return true;
    } else if (c == ']' || c == '}') {
      --depth;
    }
  }
  return false;
}

Json parse_json(std::string_view text, int levels) {
  if (nested_deeper_than(levels, text)) return {};
  const Library json = Library::parse(text, nullptr, false);
  return JsonLibrary::from(json);
}

}  // namespace base
