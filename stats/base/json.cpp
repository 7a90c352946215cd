#include "stats/base/json.hpp"

#include <algorithm>
#include <ostream>

namespace base {
namespace {

std::vector<std::string> steps_of(std::string_view text) {
  if (text.empty()) return {};
  if (text[0] != '/')
    throw JsonError("\"" + std::string(text) + "\" is no JSON pointer: it does not begin with '/'");
  std::vector<std::string> steps;
  for (const char c : text) {
    if (c == '/')
      steps.emplace_back();
    else
      steps.back() += c;
  }
  for (std::string& step : steps) {
    for (const auto& [code, sign] : {std::pair{"~1", "/"}, std::pair{"~0", "~"}})
      for (auto at = step.find(code); at != std::string::npos; at = step.find(code, at + 1))
        step.replace(at, 2, sign);
  }
  return steps;
}

/// The array index that one step of a JSON pointer names; -1 if the step is not an index.
std::ptrdiff_t index_of(const std::string& step) {
  if (step.empty() || step.size() > 9 || step.find_first_not_of("0123456789") != std::string::npos) return -1;
  return std::stol(step);
}

}  // namespace

JsonPointer::JsonPointer(std::string_view text) : steps_(steps_of(text)) {}

std::string JsonPointer::text() const {
  std::string text;
  for (const std::string& step : steps_) {
    text += '/';
    for (const char c : step) text += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  }
  return text;
}

Json::Json(bool value) : type_(Type::Boolean), boolean_(value) {}
Json::Json(int value) : Json(static_cast<long long>(value)) {}
Json::Json(long value) : Json(static_cast<long long>(value)) {}
Json::Json(long long value) : type_(Type::Signed), signed_(value) {}
Json::Json(unsigned value) : Json(static_cast<unsigned long long>(value)) {}
Json::Json(unsigned long value) : Json(static_cast<unsigned long long>(value)) {}
Json::Json(unsigned long long value) : type_(Type::Unsigned), unsigned_(value) {}
Json::Json(double value) : type_(Type::Double), double_(value) {}
Json::Json(const char* value) : type_(Type::Text), text_(value) {}
Json::Json(std::string value) : type_(Type::Text), text_(std::move(value)) {}
Json::Json(std::string_view value) : type_(Type::Text), text_(value) {}

Json::Json(std::initializer_list<Json> values) {
  const bool members = std::ranges::all_of(values, [](const Json& value) {
    return value.is_array() && value.items_.size() == 2 && value.items_[0].is_string();
  });
  *this = members ? object(values) : array(values);
}

Json::Json(const Json&) = default;
Json::Json(Json&&) noexcept = default;
Json& Json::operator=(const Json&) = default;
Json& Json::operator=(Json&&) noexcept = default;
Json::~Json() = default;

Json Json::array() { return array({}); }

Json Json::array(std::initializer_list<Json> values) {
  Json out;
  out.type_ = Type::Array;
  out.items_ = values;
  return out;
}

Json Json::object() { return object({}); }

Json Json::object(std::initializer_list<Json> members) {
  Json out;
  out.type_ = Type::Object;
  for (const Json& member : members) {
    if (!member.is_array() || member.items_.size() != 2) member.wrong_kind("a pair of a key and a value");
    const std::string& key = member.items_[0].text();
    if (!out.contains(key)) out[key] = member.items_[1];
  }
  return out;
}

std::size_t Json::size() const {
  if (is_structured()) return items_.size();
  return is_null() ? 0 : 1;
}

std::vector<Json::Member> Json::items() {
  std::vector<Member> out;
  for (std::size_t i = 0; i < items_.size(); ++i)
    out.push_back({is_object() ? keys_[i] : std::to_string(i), items_[i]});
  return out;
}

std::vector<Json::ConstMember> Json::items() const {
  std::vector<ConstMember> out;
  for (std::size_t i = 0; i < items_.size(); ++i)
    out.push_back({is_object() ? keys_[i] : std::to_string(i), items_[i]});
  return out;
}

Json* Json::find(std::string_view key) { return const_cast<Json*>(std::as_const(*this).find(key)); }

const Json* Json::find(std::string_view key) const {
  if (!is_object()) return end();
  return begin() + (std::ranges::find(keys_, key) - keys_.begin());
}

Json& Json::at(std::string_view key) { return const_cast<Json&>(std::as_const(*this).at(key)); }

const Json& Json::at(std::string_view key) const {
  if (!is_object()) wrong_kind("an object");
  const Json* found = find(key);
  if (found == end()) throw JsonError("there is no member \"" + std::string(key) + "\"");
  return *found;
}

Json& Json::at(std::size_t index) { return const_cast<Json&>(std::as_const(*this).at(index)); }

const Json& Json::at(std::size_t index) const {
  if (!is_array()) wrong_kind("an array");
  if (index >= items_.size())
    throw JsonError("there is no element " + std::to_string(index) + " in an array of " +
                    std::to_string(items_.size()));
  return items_[index];
}

const Json* Json::found(const JsonPointer& place) const {
  const Json* here = this;
  for (const std::string& step : place.steps()) {
    if (here->is_object()) {
      const Json* next = here->find(step);
      if (next == here->end()) return nullptr;
      here = next;
    } else {
      const std::ptrdiff_t index = here->is_array() ? index_of(step) : -1;
      if (index < 0 || index >= std::ssize(here->items_)) return nullptr;
      here = &here->items_[static_cast<std::size_t>(index)];
    }
  }
  return here;
}

bool Json::contains(const JsonPointer& place) const { return found(place) != nullptr; }

Json& Json::at(const JsonPointer& place) { return const_cast<Json&>(std::as_const(*this).at(place)); }

const Json& Json::at(const JsonPointer& place) const {
  const Json* there = found(place);
  if (!there) throw JsonError("there is no value at \"" + place.text() + "\"");
  return *there;
}

Json Json::value(const JsonPointer& place, const Json& otherwise) const {
  const Json* there = found(place);
  return there ? *there : otherwise;
}

Json& Json::operator[](std::string_view key) {
  if (is_null()) type_ = Type::Object;
  if (!is_object()) wrong_kind("an object");
  if (Json* found = find(key); found != end()) return *found;
  keys_.emplace_back(key);
  return items_.emplace_back();
}

Json& Json::operator[](const JsonPointer& place) {
  Json* here = this;
  for (const std::string& step : place.steps()) {
    if (here->is_array()) {
      const std::ptrdiff_t index = index_of(step);
      here = &here->at(index < 0 ? here->size() : static_cast<std::size_t>(index));
    } else {
      here = &(*here)[step];
    }
  }
  return *here;
}

void Json::push_back(Json value) {
  if (is_null()) type_ = Type::Array;
  if (!is_array()) wrong_kind("an array");
  items_.push_back(std::move(value));
}

void Json::update(const Json& object) {
  if (!object.is_object()) object.wrong_kind("an object");
  for (std::size_t i = 0; i < object.items_.size(); ++i) (*this)[object.keys_[i]] = object.items_[i];
}

std::size_t Json::erase(std::string_view key) {
  if (!is_object()) wrong_kind("an object");
  const auto at = std::ranges::find(keys_, key);
  if (at == keys_.end()) return 0;
  items_.erase(items_.begin() + (at - keys_.begin()));
  keys_.erase(at);
  return 1;
}

void Json::get_to(bool& out) const {
  if (type_ != Type::Boolean) wrong_kind("true or false");
  out = boolean_;
}

void Json::get_to(double& out) const {
  switch (type_) {
    case Type::Signed:
      out = static_cast<double>(signed_);
      return;
    case Type::Unsigned:
      out = static_cast<double>(unsigned_);
      return;
    case Type::Double:
      out = double_;
      return;
    default:
      wrong_kind("a number");
  }
}

void Json::get_to(std::string& out) const { out = text(); }

const std::string& Json::text() const {
  if (!is_string()) wrong_kind("a text");
  return text_;
}

std::int64_t Json::signed_number() const {
  switch (type_) {
    case Type::Signed:
      return signed_;
    case Type::Unsigned:
      return static_cast<std::int64_t>(unsigned_);
    case Type::Double:
      return static_cast<std::int64_t>(double_);
    default:
      wrong_kind("a number");
  }
}

std::uint64_t Json::unsigned_number() const {
  if (type_ == Type::Unsigned) return unsigned_;
  return static_cast<std::uint64_t>(signed_number());
}

const std::vector<Json>& Json::elements() const {
  if (!is_array()) wrong_kind("an array");
  return items_;
}

void Json::wrong_kind(const char* wanted) const {
  static constexpr const char* names[] = {"null",     "true or false", "a number", "a number",
                                          "a number", "a text",        "an array", "an object"};
  throw JsonError(std::string("the value is ") + names[static_cast<int>(type_)] + ", not " + wanted);
}

bool operator==(const Json& a, const Json& b) {
  using Type = Json::Type;
  if (a.is_number() && b.is_number()) {
    if (a.type_ == Type::Double || b.type_ == Type::Double) return a.get<double>() == b.get<double>();
    const auto negative = [](const Json& value) { return value.type_ == Type::Signed && value.signed_ < 0; };
    return negative(a) == negative(b) && a.unsigned_number() == b.unsigned_number();
  }
  if (a.type_ != b.type_) return false;
  switch (a.type_) {
    case Type::Boolean:
      return a.boolean_ == b.boolean_;
    case Type::Text:
      return a.text_ == b.text_;
    case Type::Array:
      return a.items_ == b.items_;
    case Type::Object:
      return a.items_.size() == b.items_.size() &&
             std::ranges::all_of(a.items(), [&](const Json::ConstMember& member) {
               const Json* found = b.find(member.key);
               return found != b.end() && *found == member.value;
             });
    default:
      return true;
  }
}

std::partial_ordering operator<=>(const Json& a, const Json& b) {
  if (a.is_string() && b.is_string()) return a.text_ <=> b.text_;
  if (!a.is_number() || !b.is_number()) return std::partial_ordering::unordered;
  return a.get<double>() <=> b.get<double>();
}

std::ostream& operator<<(std::ostream& out, const Json& value) { return out << value.dump(); }

}  // namespace base
