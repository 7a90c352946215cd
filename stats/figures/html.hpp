#pragma once
/// Parts of an HTML page: headings, tables and figures that a screen reader can navigate.

#include <string>
#include <vector>

#include "stats/figures/svg.hpp"

namespace html {

/// A table with a caption. Cells are HTML; the first cell of each row is its header.
class Table {
 public:
  Table(std::string caption, std::vector<std::string> columns);
  void row(std::vector<std::string> cells);
  /// A heading row across all columns.
  void group(const std::string& title);
  /// A row with only a name and the reason why its values are missing.
  void refused(const std::string& name, const std::string& reason);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  std::string caption_, rows_;
  std::vector<std::string> columns_;
};

/// A second-level heading and its content.
std::string section(const std::string& id, const std::string& title, const std::string& body);
std::string subsection(const std::string& title, const std::string& body);
std::string paragraph(const std::string& html);
/// A figure with its caption below; `caption` is HTML.
std::string figure(const svg::Picture& picture, const std::string& caption);
/// A section that the reader can open and close. It is printed as it is shown: open or closed.
std::string details(const std::string& summary, const std::string& body);
std::string list(const std::vector<std::string>& items);
/// A complete page: the head with the style sheet, then `body`. The element of `body` with the main content
/// must have the id "main", the target of the link that skips the navigation.
std::string whole_page(const std::string& title, const std::string& body);

}  // namespace html
