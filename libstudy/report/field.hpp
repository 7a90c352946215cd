#pragma once
/// Values of the results' JSON with their pointers, and how they are printed. Every number of the page is
/// printed here, with its JSON pointer as data-field, so that page and JSON can be compared.

#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace study::report {

using Json = base::Json;

/// A value of the results with its JSON pointer. An absent value reads as null.
class Field {
 public:
  /// `root` must outlive every Field.
  explicit Field(const Json& root) : value_(&root) {}

  Field operator[](const std::string& key) const;
  Field operator[](std::size_t index) const;

  const Json& json() const { return *value_; }
  const std::string& pointer() const { return pointer_; }
  /// True if the value is neither absent, null nor refused.
  bool exists() const;
  /// Why there is no value: its own "refused", its "..._reason" or the "reason" beside it; empty if none is
  /// given.
  std::string reason() const;
  /// Entries of a list; empty for other values.
  std::vector<Field> entries() const;
  /// Members of an object, with their names; empty for other values.
  std::vector<std::pair<std::string, Field>> members() const;
  bool is_number() const { return value_->is_number(); }
  double number() const;      ///< 0 if it is not a number
  std::string words() const;  ///< "" if it is not text
  bool yes() const;           ///< true only for the JSON value true

 private:
  Field(const Json& value, std::string pointer, const Json* parent)
      : value_(&value), pointer_(std::move(pointer)), parent_(parent) {}

  const Json* value_;
  std::string pointer_;
  const Json* parent_ = nullptr;
};

/// A number as text, with a true minus sign.
std::string decimal(double value, int decimals);
/// A p value in APA style: ".029", "< .001", "1.000" as "> .999".
std::string p_value(double p);

/// Typesets the formulas in texts of the results ("n_*", "mu(delta)", "+-3 %"): italics and typographic
/// signs. `html`: already escaped.
std::string typeset(std::string html);

/// The paper's symbol for the number of particles if all are coarsest.
inline const std::string n_star_sign = "<i>n</i><sub>*</sub>";

/// mu(delta) = a e^(b delta), the curve of the pilot.
inline const std::string pilot_curve =
    "<i>\xCE\xBC</i>(<i>\xCE\xB4</i>) = <i>a</i>\xE2\x80\x89"
    "e<sup><i>b</i>\xE2\x80\x89<i>\xCE\xB4</i></sup>";

// The following return HTML with data-field. An absent value is a dash that says why.
std::string fixed(const Field& field, int decimals);
std::string count(const Field& field);
/// A share in [0, 1] as per cent, followed by the sign.
std::string percent(const Field& field, int decimals = 0);
/// p(): "= .029" or "< .001", for running text. p_bare(): without "=", for tables.
std::string p(const Field& field);
std::string p_bare(const Field& field);
/// "[0.12, 0.34]"; open ends as infinity.
std::string interval(const Field& field, int decimals);
/// As interval(), for frame rates: prints "no upper bound" if the upper end is above 1000 frames/s.
std::string rate_interval(const Field& field);
/// A text with its formulas typeset.
std::string words(const Field& field);
/// "yes" or "no".
std::string yes_no(const Field& field);
/// An object of counts as "tracked: 26, mouse: 3". An empty name is "not said"; without counts "none".
std::string counts(const Field& object);
/// The reason why `field` is absent, as a sentence; "" if it is present.
std::string why_not(const Field& field);

/// The data-field attribute, e.g. for SVG text.
std::string data_field(const Field& field);

}  // namespace study::report
