#pragma once
/// A JSON value. nlohmann's library parses and prints the text, but only json_text.cpp includes that library,
/// because its templates slow down the compilation of each file that uses them.
///
///     base::Json fit = {{"a", 24.5}, {"b", 0.021}, {"people", 16}};
///     fit["scenes"] = base::Json::array({"SingleDam"});
///     const double a = base::Json::parse(fit.dump(2)).at("a").get<double>();

#include <compare>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <map>
#include <optional>
#include <ranges>
#include <set>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace base {

/// Thrown for text that is not JSON, a missing member, or a value of another kind than requested.
class JsonError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Deepest nesting of brackets and braces that is accepted, deeper than in any JSON file that the project's
/// programs write.
inline constexpr int most_json_levels = 32;

/// A path to a value within a JSON value, as in RFC 6901: "/task1/mixed/0". The empty path names the value
/// itself.
class JsonPointer {
 public:
  /// Throws JsonError unless the text is empty or begins with '/'.
  explicit JsonPointer(std::string_view text);
  const std::vector<std::string>& steps() const { return steps_; }
  std::string text() const;

 private:
  std::vector<std::string> steps_;
};

/// Null, a boolean, a number, a string, an array, or an object whose members keep the order in which they
/// were added. A C++ initializer list becomes an object if each of its elements is a pair that begins with a
/// string, as in {{"n", 3}, {"mean", 2.5}}; otherwise it becomes an array. Numbers that are not finite are
/// printed as null.
class Json {
 public:
  using exception = JsonError;
  using json_pointer = JsonPointer;
  using value_type = Json;
  using iterator = Json*;
  using const_iterator = const Json*;

  Json() = default;
  Json(std::nullptr_t) {}
  Json(bool value);
  Json(int value);
  Json(long value);
  Json(long long value);
  Json(unsigned value);
  Json(unsigned long value);
  Json(unsigned long long value);
  Json(double value);
  Json(const char* value);
  Json(std::string value);
  Json(std::string_view value);
  Json(std::initializer_list<Json> values);
  /// Null if the optional is empty.
  template <class T>
  Json(const std::optional<T>& value) {
    if (value) *this = Json(*value);
  }
  /// Deleted: pointers other than const char* would convert to booleans.
  template <class T>
  Json(const T*) = delete;
  /// An array, from a vector, array, set or span.
  template <std::ranges::input_range Values>
  requires(!std::convertible_to<const Values&, std::string_view> && !std::derived_from<Values, Json>)
      Json(const Values& values)
      : Json(array()) {
    for (const auto& value : values) push_back(Json(static_cast<std::ranges::range_value_t<Values>>(value)));
  }
  template <class T>
  Json(const std::map<std::string, T>& members) : type_(Type::Object) {
    for (const auto& [key, value] : members) (*this)[key] = Json(value);
  }
  Json(const Json&);
  Json(Json&&) noexcept;
  Json& operator=(const Json&);
  Json& operator=(Json&&) noexcept;
  ~Json();

  static Json array();
  static Json array(std::initializer_list<Json> values);
  static Json object();
  /// Throws JsonError unless each element is a pair that begins with a string.
  static Json object(std::initializer_list<Json> members);

  /// Throws JsonError with the position of the first syntax error, or if the text is nested deeper than
  /// `most_json_levels`.
  static Json parse(std::string_view text);
  static Json parse(std::istream& text);
  /// Prints the value as JSON, on one line if `indent` is negative, else with `indent` spaces per level.
  /// Bytes that are not UTF-8 become U+FFFD, since strings from a database may hold any bytes.
  std::string dump(int indent = -1) const;

  bool is_null() const { return type_ == Type::Null; }
  bool is_boolean() const { return type_ == Type::Boolean; }
  bool is_number() const { return is_number_integer() || type_ == Type::Double; }
  bool is_number_integer() const { return type_ == Type::Signed || type_ == Type::Unsigned; }
  bool is_number_float() const { return type_ == Type::Double; }
  bool is_string() const { return type_ == Type::Text; }
  bool is_array() const { return type_ == Type::Array; }
  bool is_object() const { return type_ == Type::Object; }
  bool is_structured() const { return is_array() || is_object(); }

  /// Number of elements of an array or members of an object; 0 for null, 1 for every other value.
  std::size_t size() const;
  bool empty() const { return size() == 0; }
  Json* begin() { return items_.data(); }
  Json* end() { return items_.data() + items_.size(); }
  const Json* begin() const { return items_.data(); }
  const Json* end() const { return items_.data() + items_.size(); }

  struct Member {
    std::string key;
    Json& value;
  };
  struct ConstMember {
    std::string key;
    const Json& value;
  };
  /// An object's members with their keys, or an array's elements with their indices as strings; empty for
  /// other values.
  std::vector<Member> items();
  std::vector<ConstMember> items() const;

  bool contains(std::string_view key) const { return find(key) != end(); }
  bool contains(const JsonPointer& place) const;
  /// The member with this key; end() if there is none.
  Json* find(std::string_view key);
  const Json* find(std::string_view key) const;
  /// Throws JsonError if there is no such member or element.
  Json& at(std::string_view key);
  const Json& at(std::string_view key) const;
  Json& at(std::size_t index);
  const Json& at(std::size_t index) const;
  Json& at(const JsonPointer& place);
  const Json& at(const JsonPointer& place) const;
  /// Adds a missing member with the value null; a null value becomes an object. On a const value a missing
  /// member throws JsonError.
  Json& operator[](std::string_view key);
  const Json& operator[](std::string_view key) const { return at(key); }
  Json& operator[](const char* key) { return (*this)[std::string_view(key)]; }
  const Json& operator[](const char* key) const { return at(std::string_view(key)); }
  Json& operator[](std::size_t index) { return at(index); }
  const Json& operator[](std::size_t index) const { return at(index); }
  Json& operator[](int index) { return at(static_cast<std::size_t>(index)); }
  const Json& operator[](int index) const { return at(static_cast<std::size_t>(index)); }
  Json& operator[](const JsonPointer& place);
  const Json& operator[](const JsonPointer& place) const { return at(place); }
  Json& front() { return at(std::size_t{0}); }
  const Json& front() const { return at(std::size_t{0}); }
  Json& back() { return at(size() - 1); }
  const Json& back() const { return at(size() - 1); }

  /// A null value becomes an array. Throws JsonError for other kinds of values.
  void push_back(Json value);
  /// Adds the members of `object`. Members that exist already get the value that they have in `object`.
  void update(const Json& object);
  /// Returns the number of members removed, 0 or 1.
  std::size_t erase(std::string_view key);

  /// Throws JsonError if the value is of another kind. Numbers are converted by static_cast.
  template <class T>
  T get() const {
    T out;
    get_to(out);
    return out;
  }
  void get_to(bool& out) const;
  void get_to(double& out) const;
  void get_to(std::string& out) const;
  void get_to(Json& out) const { out = *this; }
  template <std::integral T>
  void get_to(T& out) const {
    out = type_ == Type::Unsigned ? static_cast<T>(unsigned_number()) : static_cast<T>(signed_number());
  }
  void get_to(float& out) const { out = static_cast<float>(get<double>()); }
  template <class T>
  void get_to(std::vector<T>& out) const {
    out.clear();
    for (const Json& value : elements()) out.push_back(value.get<T>());
  }
  template <class T>
  void get_to(std::map<std::string, T>& out) const {
    out.clear();
    for (const auto& [key, value] : items()) out[key] = value.template get<T>();
  }
  template <class T>
  void get_to(std::set<T>& out) const {
    out.clear();
    for (const Json& value : elements()) out.insert(value.get<T>());
  }
  /// Converts implicitly to the types listed, as get<T>() does.
  template <class T>
  requires(std::same_as<T, std::string> || std::same_as<T, double> || std::same_as<T, int> ||
           std::same_as<T, std::vector<double>> || std::same_as<T, std::set<std::string>>)
  operator T() const {
    return get<T>();
  }
  /// Throws JsonError if the value is not a string.
  const std::string& text() const;
  /// The member's value, or `otherwise` if there is no such member. Throws JsonError if the value is of
  /// another kind than T.
  template <class T>
  T value(std::string_view key, T otherwise) const {
    const Json* found = find(key);
    return found == end() ? otherwise : found->get<T>();
  }
  std::string value(std::string_view key, const char* otherwise) const {
    return value(key, std::string(otherwise));
  }
  Json value(const JsonPointer& place, const Json& otherwise) const;

  /// Numbers compare by value; objects compare without regard to the order of their members.
  friend bool operator==(const Json& a, const Json& b);
  template <class T>
  requires std::is_arithmetic_v<T>
  friend bool operator==(const Json& a, T b) { return a == Json(b); }
  /// Two numbers are ordered by value and two strings by their bytes; all other pairs are unordered.
  friend std::partial_ordering operator<=>(const Json& a, const Json& b);
  template <class T>
  requires std::is_arithmetic_v<T>
  friend std::partial_ordering operator<=>(const Json& a, T b) { return a <=> Json(b); }
  /// Prints the value as JSON on one line; GoogleTest uses this in its messages.
  friend std::ostream& operator<<(std::ostream& out, const Json& value);

 private:
  enum class Type : unsigned char { Null, Boolean, Signed, Unsigned, Double, Text, Array, Object };
  std::int64_t signed_number() const;
  std::uint64_t unsigned_number() const;
  const std::vector<Json>& elements() const;
  const Json* found(const JsonPointer& place) const;
  [[noreturn]] void wrong_kind(const char* wanted) const;
  friend struct JsonLibrary;

  Type type_ = Type::Null;
  union {
    bool boolean_;
    std::int64_t signed_;
    std::uint64_t unsigned_ = 0;
    double double_;
  };
  std::string text_;
  /// Elements of an array, or values of an object's members. `keys_` holds the members' keys in the same
  /// order.
  std::vector<Json> items_;
  std::vector<std::string> keys_;
};

/// True if brackets and braces outside strings are nested deeper than `levels`. The text need not be valid
/// JSON. Callers refuse such text, because printing or comparing a deep tree would overflow the stack.
bool nested_deeper_than(int levels, std::string_view json);

/// Parses untrusted JSON: null if the text is not JSON or is nested deeper than `levels`.
Json parse_json(std::string_view text, int levels = most_json_levels);

}  // namespace base
