#pragma once
/// The report's prose: paragraphs, list items, captions and descriptions.

#include <string>
#include <vector>

#include "libstudy/report/page.hpp"
#include "stats/base/json.hpp"
#include "tests/apps/html_reader.hpp"

namespace report_blocks {

struct Block {
  std::string words;  ///< as printed
  std::string form;   ///< the same with "#" for each value
};

/// Parses the content between two tags of a block.
inline Block block_of(const std::string& html) {
  Block out;
  bool value = false;  // inside a span that quotes a value
  for (std::size_t at = 0; at < html.size();) {
    if (html[at] != '<') {
      const auto end = std::min(html.find('<', at), html.size());
      std::string text = html.substr(at, end - at);
      for (auto space = text.find("&nbsp;"); space != std::string::npos; space = text.find("&nbsp;"))
        text.replace(space, 6, "_");
      text = html_reader::plain(text);
      out.words += text;
      if (!value) out.form += text;
      at = end;
      continue;
    }
    const auto end = html.find('>', at);
    const std::string tag = html.substr(at + 1, end - at - 1);
    at = end + 1;
    if (tag == "/span") value = false;
    if (!tag.starts_with("span")) continue;
    const auto element = html_reader::tag_of(tag);
    for (const char* name : {"data-field", "data-count"}) value = value || element.attributes.contains(name);
    const auto kind = element.attributes.find("class");
    value =
        value || (kind != element.attributes.end() && (kind->second == "none" || kind->second == "ordinal"));
    if (value) out.form += "#";
  }
  return out;
}

inline std::vector<Block> blocks_of(const base::Json& json) {
  const std::string html = study::report::results_page(json);
  std::vector<Block> out;
  for (const std::string name : {"p", "li", "figcaption", "caption", "desc"}) {
    for (auto at = html.find("<" + name); at != std::string::npos; at = html.find("<" + name, at + 1)) {
      const char next = html[at + 1 + name.size()];
      if (next != '>' && next != ' ') continue;
      const auto from = html.find('>', at) + 1;
      const std::string inside = html.substr(from, html.find("</" + name + ">", from) - from);
      if (inside.find("<a href") == std::string::npos)
        out.push_back(block_of(inside));  // not the table of contents
    }
  }
  return out;
}

/// A sentence ends at a full stop before a space.
inline std::vector<std::string> sentences_of(const std::string& words) {
  std::vector<std::string> out;
  std::size_t from = 0;
  for (auto at = words.find(". "); at != std::string::npos; at = words.find(". ", from)) {
    out.push_back(words.substr(from, at + 1 - from));
    from = at + 2;
  }
  if (from < words.size()) out.push_back(words.substr(from));
  return out;
}

}  // namespace report_blocks
