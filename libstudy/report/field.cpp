#include "libstudy/report/field.hpp"

#include <map>

#include "libstudy/analysis/json_parts.hpp"
#include "stats/base/pattern.hpp"
#include "stats/figures/svg.hpp"

namespace study::report {

namespace {

const Json nothing{};

std::string pointer_token(const std::string& key) {
  std::string out = "/";
  for (const char c : key) out += c == '~' ? "~0" : c == '/' ? "~1" : std::string(1, c);
  return out;
}

std::string span(const Field& field, const std::string& text) {
  return "<span" + data_field(field) + ">" + svg::escaped(text) + "</span>";
}

/// A number as HTML that the browser does not break across lines.
std::string number_span(const Field& field, const std::string& text) {
  return "<span class=\"number\"" + data_field(field) + ">" + svg::escaped(text) + "</span>";
}

std::string dash(const Field& field) {
  const std::string reason = field.reason();
  return "<span class=\"none\"" + (reason.empty() ? "" : svg::attribute("title", reason)) +
         ">\xE2\x80\x93</span>";
}

/// Removes the 0 before the decimal point. APA style omits it if a number cannot exceed 1.
std::string without_zero(const std::string& text) { return text.starts_with("0.") ? text.substr(1) : text; }

std::string end_of(const Field& end, int decimals) {
  if (end.is_number()) return fixed(end, decimals);
  const std::string text = end.words();
  if (text == "-Inf") return span(end, "\xE2\x88\x92\xE2\x88\x9E");
  if (text == "Inf") return span(end, "\xE2\x88\x9E");
  return dash(end);
}

}  // namespace

Field Field::operator[](const std::string& key) const {
  const std::string pointer = pointer_ + pointer_token(key);
  if (!value_->is_object() || !value_->contains(key)) return {nothing, pointer, value_};
  return {(*value_)[key], pointer, value_};
}

Field Field::operator[](std::size_t index) const {
  const std::string pointer = pointer_ + "/" + std::to_string(index);
  if (!value_->is_array() || index >= value_->size()) return {nothing, pointer, value_};
  return {(*value_)[index], pointer, value_};
}

bool Field::exists() const {
  return !value_->is_null() && !(value_->is_object() && value_->contains("refused"));
}

std::string Field::reason() const {
  if (exists()) return "";
  const auto text = [](const Json* json, const char* key) {
    if (json == nullptr || !json->is_object() || !json->contains(key) || !(*json)[key].is_string())
      return std::string();
    return (*json)[key].get<std::string>();
  };
  if (const std::string own = text(value_, "refused"); !own.empty()) return own;
  const std::string key = pointer_.substr(pointer_.rfind('/') + 1) + "_reason";
  if (const std::string its = text(parent_, key.c_str()); !its.empty()) return its;
  const std::string beside = text(parent_, "reason");
  return beside.empty() ? text(parent_, "refused") : beside;
}

std::vector<Field> Field::entries() const {
  std::vector<Field> out;
  if (value_->is_array())
    for (std::size_t i = 0; i < value_->size(); ++i) out.push_back((*this)[i]);
  return out;
}

std::vector<std::pair<std::string, Field>> Field::members() const {
  std::vector<std::pair<std::string, Field>> out;
  if (value_->is_object())
    for (const auto& [key, member] : value_->items()) out.emplace_back(key, (*this)[key]);
  return out;
}

double Field::number() const { return value_->is_number() ? value_->get<double>() : 0; }

std::string Field::words() const { return value_->is_string() ? value_->get<std::string>() : ""; }

bool Field::yes() const { return value_->is_boolean() && value_->get<bool>(); }

std::string data_field(const Field& field) { return svg::attribute("data-field", field.pointer()); }

std::string decimal(double value, int decimals) {
  const std::string text = svg::number(value, decimals);
  return text.front() == '-' ? "\xE2\x88\x92" + text.substr(1) : text;
}

std::string p_value(double p) {
  if (p < 0.001) return "< .001";
  if (p > 0.9995) return "> .999";
  return without_zero(svg::number(p, 3));
}

std::string typeset(std::string html) {
  const auto holds = [&](const char* sign) { return html.find(sign) != std::string::npos; };
  if (!holds("n_*") && !holds("mu") && !holds("delta") && !holds("+-")) return html;
  static const base::Pattern signs("\\bn_\\*|\\bmu\\(delta\\)|\\bmu\\b|\\bdelta\\b|\\+-");
  static const std::map<std::string, std::string> typeset_as{
      {"n_*", n_star_sign},
      {"mu(delta)", "<i>\xCE\xBC</i>(<i>\xCE\xB4</i>)"},
      {"mu", "<i>\xCE\xBC</i>"},
      {"delta", "<i>\xCE\xB4</i>"},
      {"+-", "\xC2\xB1"}};
  return signs.replaced(html, [](const base::Groups& found) { return typeset_as.at(found[0]); });
}

std::string fixed(const Field& field, int decimals) {
  return field.is_number() ? number_span(field, decimal(field.number(), decimals)) : dash(field);
}

std::string count(const Field& field) { return fixed(field, 0); }

std::string percent(const Field& field, int decimals) {
  if (!field.is_number()) return dash(field);
  return "<span class=\"number\" data-unit=\"%\"" + data_field(field) + ">" +
         decimal(100 * field.number(), decimals) + " %</span>";
}

std::string p_bare(const Field& field) {
  return field.is_number() ? number_span(field, p_value(field.number())) : dash(field);
}

std::string p(const Field& field) {
  if (!field.is_number()) return "= " + dash(field);
  const std::string text = p_value(field.number());
  return text.front() == '<' || text.front() == '>' ? number_span(field, text)
                                                    : "= " + number_span(field, text);
}

std::string interval(const Field& field, int decimals) {
  if (field.entries().size() != 2) return dash(field);
  const int digits = interval_decimals({number_of(field[0].json()), number_of(field[1].json())}, decimals);
  return "<span class=\"number\">[" + end_of(field[0], digits) + ", " + end_of(field[1], digits) + "]</span>";
}

std::string rate_interval(const Field& field) {
  if (field.entries().size() != 2 || !(number_of(field[1].json()) > highest_rate)) return interval(field, 2);
  return "<span class=\"number\">[" + end_of(field[0], 2) + ", no upper bound]</span>";
}

std::string words(const Field& field) {
  if (field.words().empty()) return "";
  return "<span" + data_field(field) + ">" + typeset(svg::escaped(field.words())) + "</span>";
}

std::string yes_no(const Field& field) {
  return field.json().is_boolean() ? span(field, field.yes() ? "yes" : "no") : dash(field);
}

std::string counts(const Field& object) {
  std::string out;
  for (const auto& [name, n] : object.members()) {
    if (n.number() <= 0) continue;
    const std::string shown = name.empty() ? "not said" : svg::escaped(name);
    out += (out.empty() ? "" : ", ") + shown + ": " + count(n);
  }
  return out.empty() ? "none" : out;
}

std::string why_not(const Field& field) {
  if (field.exists()) return "";
  const std::string reason = field.reason();
  return "<p class=\"refused\">Not given: " +
         (reason.empty() ? "the results hold no such part" : typeset(svg::escaped(reason))) + ".</p>\n";
}

}  // namespace study::report
