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
/// `caption` is HTML.
std::string figure(const svg::Picture& picture, const std::string& caption);
/// A section that the reader can open; printed as it is on the page.
std::string details(const std::string& summary, const std::string& body);
std::string list(const std::vector<std::string>& items);
/// `body` between the page's head with its style sheet and its end. `body` must give the main content the id
/// "main".
std::string whole_page(const std::string& title, const std::string& body);

}  // namespace html
