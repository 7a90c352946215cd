#pragma once
/// Pieces of an HTML page: headings, tables and figures that a screen reader finds its way in.

#include <string>
#include <vector>

#include "apps/common/svg.hpp"

namespace apps::html {

/// A table with a caption. Cells are HTML; the first of each row names it.
class Table {
 public:
  Table(std::string caption, std::vector<std::string> columns);
  void row(std::vector<std::string> cells);
  /// A row that names what follows, across all columns.
  void group(const std::string& title);
  /// A row of which only the name is known, and why.
  void refused(const std::string& name, const std::string& reason);
  bool empty() const { return rows_.empty(); }
  std::string html() const;

 private:
  std::string caption_, rows_;
  std::vector<std::string> columns_;
};

/// A second-level heading with what stands under it.
std::string section(const std::string& id, const std::string& title, const std::string& body);
std::string subsection(const std::string& title, const std::string& body);
std::string paragraph(const std::string& html);
/// `caption` is HTML.
std::string figure(const svg::Picture& picture, const std::string& caption);
/// What is shown when the reader opens it; printed as it stands.
std::string details(const std::string& summary, const std::string& body);
std::string list(const std::vector<std::string>& items);
/// `body` between the page's head with its style sheet and its end. What a reader comes for has the id
/// "main".
std::string whole_page(const std::string& title, const std::string& body);

}  // namespace apps::html
