#include "stats/figures/html.hpp"

namespace html {

namespace {

// Text has a contrast of at least 7 to 1 against its background. Coloured backgrounds are not printed.
constexpr const char* style = R"(
:root { color-scheme: light; }
body { font: 16px/1.5 "DejaVu Sans", Arial, sans-serif; color: #111; background: #fff; margin: 0 auto; max-width: 62rem; padding: 1rem 1.5rem 4rem; overflow-wrap: anywhere; }
h1 { font-size: 1.8rem; line-height: 1.2; margin: 1rem 0 .3rem; }
h2 { font-size: 1.35rem; margin: 2.6rem 0 .6rem; border-bottom: 2px solid #0072b2; padding-bottom: .2rem; }
h3 { font-size: 1.08rem; margin: 1.8rem 0 .4rem; }
a { color: #004a80; }
a:focus, [tabindex]:focus { outline: 3px solid #d55e00; outline-offset: 2px; }
.skip { position: absolute; left: -99rem; }
.skip:focus { position: static; }
nav ul { columns: 2; padding-left: 1.2rem; }
.wide { overflow-x: auto; overflow-y: hidden; padding-bottom: .3rem; margin: .8rem 0 1.2rem; }
table { border-collapse: collapse; overflow-wrap: normal; font-size: .82rem; font-variant-numeric: tabular-nums; }
caption { text-align: left; font-weight: bold; padding: .3rem 0; caption-side: top; }
th, td { padding: .22rem .6rem .22rem 0; text-align: left; vertical-align: top; }
thead th { border-top: 2px solid #111; border-bottom: 1px solid #111; vertical-align: bottom; }
tbody tr:last-child > * { border-bottom: 2px solid #111; }
tbody th { font-weight: normal; }
tbody th.group { font-weight: bold; padding-top: .5rem; border-top: 1px solid #888; }
/* Room for a subscript in the last line, which would else bring a scroll bar. */
figure { margin: 1rem 0 1.6rem; overflow-x: auto; overflow-y: hidden; padding-bottom: .3rem; }
figure svg { max-width: 100%; height: auto; }
figcaption, .note { font-size: .88rem; }
.badge { font-size: .72rem; font-weight: bold; letter-spacing: .03em; border: 2px solid #111; border-radius: .3rem; padding: .05rem .4rem; white-space: nowrap; vertical-align: middle; }
.badge.exploratory { border-style: dashed; font-weight: normal; }
.warning { border-left: .4rem solid #d55e00; background: #fff4ea; padding: .5rem .8rem; margin: .8rem 0; }
.refused { border-left: .4rem solid #666; background: #f3f3f3; padding: .4rem .8rem; margin: .6rem 0; }
.apa li { margin: .15rem 0; }
.number, .ordinal { white-space: nowrap; }
sub, sup { line-height: 0; }
.formula { margin: .4rem 0 .8rem 1.5rem; overflow-x: auto; }
details { margin: .6rem 0; }
summary { cursor: pointer; }
.hash { font-family: "DejaVu Sans Mono", monospace; font-size: .8rem; overflow-wrap: anywhere; }
@media screen and (max-width: 640px) {
  body { padding: .5rem .7rem 3rem; }
  nav ul { columns: 1; }
  .wide table { width: max-content; }
  /* A shade at an edge behind which there is more to scroll to. */
  .wide, figure {
    background: linear-gradient(to right, #fff 30%, transparent) 0 0 / 2.4rem 100% local no-repeat,
      linear-gradient(to left, #fff 30%, transparent) 100% 0 / 2.4rem 100% local no-repeat,
      linear-gradient(to right, #999, transparent) 1px 0 / .8rem 100% scroll no-repeat,
      linear-gradient(to left, #999, transparent) calc(100% - 1px) 0 / .8rem 100% scroll no-repeat;
  }
  .wide th, .wide td { max-width: 15rem; }
  .wide caption { max-width: calc(100vw - 2rem); }
  /* As drawn, so that its words keep their size; a wide one scrolls in its own frame. */
  figure svg { max-width: none; }
}
@media print {
  html { font-size: 9.5pt; }
  @page { size: A4; margin: 15mm 13mm; }
  body { font-size: 1rem; max-width: none; padding: 0; }
  nav, .skip { display: none; }
  a { color: inherit; text-decoration: none; }
  .wide { overflow: visible; }
  table { font-size: 7pt; }
  th, td { padding-right: .35rem; }
  thead { display: table-header-group; }
  tr, figure, h2, h3, caption { break-inside: avoid; }
  h2, h3, caption, thead { break-after: avoid; }
  figure svg { max-height: 230mm; }
  .warning, .refused { background: none; border: 1px solid #111; }
}
)";

std::string element(const std::string& name, const std::string& body, const std::string& attributes = "") {
  return "<" + name + attributes + ">" + body + "</" + name + ">";
}

}  // namespace

Table::Table(std::string caption, std::vector<std::string> columns)
    : caption_(std::move(caption)), columns_(std::move(columns)) {}

void Table::row(std::vector<std::string> cells) {
  rows_ += "<tr>";
  for (std::size_t i = 0; i < cells.size(); ++i)
    rows_ += i == 0 ? element("th", cells[i], " scope=\"row\"") : element("td", cells[i]);
  rows_ += "</tr>\n";
}

void Table::group(const std::string& title) {
  rows_ +=
      "<tr>" +
      element("th", title,
              " class=\"group\" scope=\"rowgroup\" colspan=\"" + std::to_string(columns_.size()) + "\"") +
      "</tr>\n";
}

void Table::refused(const std::string& name, const std::string& reason) {
  rows_ += "<tr>" + element("th", name, " scope=\"row\"") +
           element("td", reason, " colspan=\"" + std::to_string(columns_.size() - 1) + "\"") + "</tr>\n";
}

std::string Table::html() const {
  std::string head;
  for (const auto& column : columns_) head += element("th", column, " scope=\"col\"");
  return "<div class=\"wide\" tabindex=\"0\">\n<table>\n" + element("caption", caption_) + "\n<thead><tr>" +
         head + "</tr></thead>\n<tbody>\n" + rows_ + "</tbody>\n</table>\n</div>\n";
}

std::string section(const std::string& id, const std::string& title, const std::string& body) {
  return "<section" + svg::attribute("aria-labelledby", id) + ">\n<h2" + svg::attribute("id", id) + ">" +
         title + "</h2>\n" + body + "</section>\n";
}

std::string subsection(const std::string& title, const std::string& body) {
  return element("h3", title) + "\n" + body;
}

std::string paragraph(const std::string& html) { return element("p", html) + "\n"; }

std::string figure(const svg::Picture& picture, const std::string& caption) {
  return "<figure>\n" + svg::element(picture) + element("figcaption", caption) + "\n</figure>\n";
}

std::string details(const std::string& summary, const std::string& body) {
  return element("details", "\n" + element("summary", summary) + "\n" + body) + "\n";
}

std::string list(const std::vector<std::string>& items) {
  std::string out = "<ul class=\"apa\">\n";
  for (const auto& item : items) out += element("li", item) + "\n";
  return items.empty() ? "" : out + "</ul>\n";
}

std::string whole_page(const std::string& title, const std::string& body) {
  return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
         "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n" +
         element("title", svg::escaped(title)) + "\n<style>" + style +
         "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#main\">To the results</a>\n" + body +
         "</body>\n</html>\n";
}

}  // namespace html
