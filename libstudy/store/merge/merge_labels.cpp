/// Labels of people and protocols after a merge: labels of the receiving database never change, whatever
/// labels the others have.
#include <algorithm>
#include <filesystem>
#include <tuple>

#include "libstudy/store/export_labels.hpp"
#include "libstudy/store/merge/merge_parts.hpp"

namespace study::merging {

namespace {

/// Sorts by the time of the first plan, then by identity: independent of the order of the sources.
void sort_labels(std::vector<GivenLabel>& labels, const Content& content) {
  std::map<std::string, std::string> planned;
  for (const SessionCopy& copy : content.copies) {
    const auto [known, fresh] = planned.try_emplace(copy.person, copy.planned_utc);
    if (!fresh) known->second = std::min(known->second, copy.planned_utc);
  }
  const auto key = [&](const GivenLabel& one) {
    const auto when = planned.find(one.owner);
    return std::tuple(one.kind, when == planned.end() ? std::string() : when->second, one.owner, one.label);
  };
  std::sort(labels.begin(), labels.end(),
            [&](const GivenLabel& a, const GivenLabel& b) { return key(a) < key(b); });
}

}  // namespace

void add_labels(const Content& content, sqlite::Connection& target) {
  const auto into = std::filesystem::weakly_canonical(target.path());
  std::vector<GivenLabel> first, others;
  for (const auto& source : content.sources) {
    const bool stays = std::filesystem::weakly_canonical(source->path()) == into;
    const std::vector<GivenLabel> found = labels_of(*source);
    std::vector<GivenLabel>& list = stays ? first : others;
    list.insert(list.end(), found.begin(), found.end());
  }
  sort_labels(others, content);
  std::vector<GivenLabel> joined = joined_labels(first, others);
  std::erase_if(joined, [&](const GivenLabel& one) {
    return one.kind == "person" && content.tombstones.contains(one.owner);
  });
  store_labels(target, joined);
}

}  // namespace study::merging
