#include "stats/base/pattern.hpp"

#include <regex.h>

#include <stdexcept>

namespace base {

struct Pattern::Compiled {
  regex_t regex{};
  Compiled() = default;
  Compiled(const Compiled&) = delete;
  Compiled& operator=(const Compiled&) = delete;
  ~Compiled() { regfree(&regex); }

  /// Start and end of each group of the first match at or after `from`; empty without a match.
  std::vector<regmatch_t> find(const std::string& text, std::size_t from) const {
    std::vector<regmatch_t> groups(regex.re_nsub + 1);
    groups[0].rm_so = static_cast<regoff_t>(from);
    groups[0].rm_eo = static_cast<regoff_t>(text.size());
    if (regexec(&regex, text.data(), groups.size(), groups.data(), REG_STARTEND) != 0) groups.clear();
    return groups;
  }
};

namespace {

Groups texts_of(const std::vector<regmatch_t>& found, const std::string& text) {
  Groups out;
  for (const regmatch_t& group : found) {
    out.push_back(group.rm_so < 0 ? ""
                                  : text.substr(static_cast<std::size_t>(group.rm_so),
                                                static_cast<std::size_t>(group.rm_eo - group.rm_so)));
  }
  return out;
}

}  // namespace

Pattern::Pattern(const std::string& expression) : compiled_(std::make_unique<Compiled>()) {
  const int error = regcomp(&compiled_->regex, expression.c_str(), REG_EXTENDED);
  if (error == 0) return;
  char reason[256];
  regerror(error, &compiled_->regex, reason, sizeof reason);
  throw std::invalid_argument("regular expression " + expression + ": " + reason);
}
Pattern::~Pattern() = default;
Pattern::Pattern(Pattern&&) noexcept = default;
Pattern& Pattern::operator=(Pattern&&) noexcept = default;

std::optional<Groups> Pattern::match(const std::string& text) const {
  const auto found = compiled_->find(text, 0);
  const bool whole = !found.empty() && found[0].rm_so == 0 && found[0].rm_eo == std::ssize(text);
  return whole ? std::optional(texts_of(found, text)) : std::nullopt;
}

std::vector<Groups> Pattern::all(const std::string& text) const {
  std::vector<Groups> out;
  replaced(text, [&](const Groups& found) {
    out.push_back(found);
    return std::string();
  });
  return out;
}

std::string Pattern::replaced(const std::string& text,
                              const std::function<std::string(const Groups&)>& write) const {
  std::string out;
  std::size_t copied = 0;
  for (std::size_t from = 0; from <= text.size();) {
    const auto found = compiled_->find(text, from);
    if (found.empty()) break;
    const auto begin = static_cast<std::size_t>(found[0].rm_so);
    const auto end = static_cast<std::size_t>(found[0].rm_eo);
    out.append(text, copied, begin - copied).append(write(texts_of(found, text)));
    copied = end;
    from = end > begin ? end : end + 1;  // after an empty match one character is skipped
  }
  return out.append(text, copied);
}

}  // namespace base
