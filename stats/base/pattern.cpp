#include "stats/base/pattern.hpp"

#include <regex>

namespace base {

struct Pattern::Compiled {
  std::regex regex;
};

namespace {

Groups groups_of(const std::smatch& found) {
  Groups out;
  for (const auto& group : found) out.push_back(group.str());
  return out;
}

}  // namespace

Pattern::Pattern(const std::string& expression)
    : compiled_(std::make_unique<Compiled>(Compiled{std::regex(expression)})) {}
Pattern::~Pattern() = default;
Pattern::Pattern(Pattern&&) noexcept = default;
Pattern& Pattern::operator=(Pattern&&) noexcept = default;

std::optional<Groups> Pattern::match(const std::string& text) const {
  std::smatch found;
  if (!std::regex_match(text, found, compiled_->regex)) return {};
  return groups_of(found);
}

std::vector<Groups> Pattern::all(const std::string& text) const {
  std::vector<Groups> out;
  for (std::sregex_iterator one(text.begin(), text.end(), compiled_->regex), end; one != end; ++one)
    out.push_back(groups_of(*one));
  return out;
}

std::string Pattern::replaced(const std::string& text,
                              const std::function<std::string(const Groups&)>& write) const {
  std::string out;
  auto rest = text.begin();
  for (std::sregex_iterator one(text.begin(), text.end(), compiled_->regex), end; one != end; ++one) {
    out.append(rest, (*one)[0].first).append(write(groups_of(*one)));
    rest = (*one)[0].second;
  }
  return out.append(rest, text.end());
}

}  // namespace base
