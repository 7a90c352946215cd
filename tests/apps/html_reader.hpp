#pragma once
/// A strict reader of the report's HTML: the printed texts, and the elements around them.

#include <map>
#include <stdexcept>
#include <string>
#include <vector>

namespace html_reader {

struct Element {
  std::string name;
  std::map<std::string, std::string> attributes;
};

/// Text with the elements around it, outermost first.
struct Text {
  std::string words;
  std::vector<Element> around;

  /// Value in the innermost element that has the attribute; "" = none.
  std::string attribute(const std::string& name) const {
    for (auto at = around.rbegin(); at != around.rend(); ++at) {
      const auto found = at->attributes.find(name);
      if (found != at->attributes.end()) return found->second;
    }
    return "";
  }
  bool within(const std::string& name) const {
    for (const auto& element : around)
      if (element.name == name) return true;
    return false;
  }
};

struct Page {
  std::vector<Element> elements;  ///< in the order of their start tags
  std::vector<Text> texts;
};

inline std::string plain(std::string text) {
  const std::pair<const char*, const char*> entities[] = {
      {"&lt;", "<"}, {"&gt;", ">"}, {"&quot;", "\""}, {"&nbsp;", " "}, {"&amp;", "&"}};
  for (const auto& [entity, character] : entities) {
    for (auto at = text.find(entity); at != std::string::npos; at = text.find(entity, at + 1))
      text.replace(at, std::string(entity).size(), character);
  }
  return text;
}

inline Element tag_of(const std::string& tag) {
  std::size_t at = tag.find_first_of(" \n/");
  Element element{tag.substr(0, at), {}};
  while (at < tag.size()) {
    at = tag.find_first_not_of(" \n/", at);
    if (at == std::string::npos) break;
    const auto equals = tag.find("=\"", at);
    if (equals == std::string::npos) throw std::runtime_error("attribute without a value: <" + tag + ">");
    const auto end = tag.find('"', equals + 2);
    if (end == std::string::npos) throw std::runtime_error("value without an end: <" + tag + ">");
    const auto [place, fresh] = element.attributes.emplace(tag.substr(at, equals - at),
                                                           plain(tag.substr(equals + 2, end - equals - 2)));
    if (!fresh) throw std::runtime_error("attribute " + place->first + " twice: <" + tag + ">");
    at = end + 1;
  }
  return element;
}

/// Parses a page. Throws std::runtime_error if tags do not nest.
inline Page read(const std::string& html) {
  Page page;
  std::vector<Element> open;
  std::size_t at = html.find('>') + 1;  // after the document type
  while (at < html.size()) {
    const auto start = html.find('<', at);
    const std::string words = plain(html.substr(at, start - at));
    if (words.find_first_not_of(" \n") != std::string::npos) page.texts.push_back({words, open});
    if (start == std::string::npos) break;
    const auto end = html.find('>', start);
    if (end == std::string::npos) throw std::runtime_error("a tag without an end");
    const std::string tag = html.substr(start + 1, end - start - 1);
    at = end + 1;
    if (tag.front() == '/') {
      if (open.empty() || open.back().name != tag.substr(1))
        throw std::runtime_error("</" + tag.substr(1) + "> closes <" +
                                 (open.empty() ? "" : open.back().name) + ">");
      open.pop_back();
      continue;
    }
    page.elements.push_back(tag_of(tag));
    if (tag.back() != '/' && page.elements.back().name != "meta") open.push_back(page.elements.back());
  }
  if (!open.empty()) throw std::runtime_error("<" + open.back().name + "> is never closed");
  return page;
}

}  // namespace html_reader
