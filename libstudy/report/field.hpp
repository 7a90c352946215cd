#pragma once
/// Values of the results' JSON with their JSON pointers, and functions that print the values as HTML. The
/// functions add the JSON pointer as attribute data-field, so that page and JSON can be compared.

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
  /// The reason why the value does not exist: its member "refused", or in the object that contains it
  /// "NAME_reason", "reason" or "refused". Empty if the value exists or no reason is given.
  std::string reason() const;
  /// Entries of a list; empty for other values.
  std::vector<Field> entries() const;
  /// Members of an object, with their names; empty for other values.
  std::vector<std::pair<std::string, Field>> members() const;
  bool is_number() const { return value_->is_number(); }
  double number() const;      ///< the value; 0 if it is no number
  std::string words() const;  ///< the value; "" if it is no text
  bool yes() const;           ///< true only for the JSON value true

 private:
  Field(const Json& value, std::string pointer, const Json* parent)
      : value_(&value), pointer_(std::move(pointer)), parent_(parent) {}

  const Json* value_;
  std::string pointer_;
  const Json* parent_ = nullptr;
};

/// A number as text, with the typographic minus sign.
std::string decimal(double value, int decimals);
/// A p value in APA style: ".029", or "< .001" below .001, or "> .999" above .9995.
std::string p_value(double p);

/// Replaces formulas in a text of the results ("n_*", "mu(delta)", "+-3 %") by HTML with italics and
/// typographic signs. `html`: the text, already escaped.
std::string typeset(std::string html);

/// The paper's symbol n_*: number of particles if all are of the coarsest level.
inline const std::string n_star_sign = "<i>n</i><sub>*</sub>";

/// Formula of the pilot's curve: mu(delta) = a e^(b delta).
inline const std::string pilot_curve =
    "<i>\xCE\xBC</i>(<i>\xCE\xB4</i>) = <i>a</i>\xE2\x80\x89"
    "e<sup><i>b</i>\xE2\x80\x89<i>\xCE\xB4</i></sup>";

// The following functions return HTML with the attribute data-field. An absent value is printed as a dash
// whose title is the reason.
std::string fixed(const Field& field, int decimals);
std::string count(const Field& field);
/// A share between 0 and 1 as a percentage, such as "35 %".
std::string percent(const Field& field, int decimals = 0);
/// A p value. p(): "= .029" or "< .001", for sentences. p_bare(): ".029" or "< .001", for tables.
std::string p(const Field& field);
std::string p_bare(const Field& field);
/// An interval: "[0.12, 0.34]". A bound "Inf" or "-Inf" is printed as an infinity sign, a missing bound as a
/// dash.
std::string interval(const Field& field, int decimals);
/// The interval of a frame rate. An upper end above highest_rate (1000 frames/s) is printed as "no upper
/// bound".
std::string rate_interval(const Field& field);
/// A text of the results with formulas by typeset().
std::string words(const Field& field);
/// "yes" or "no".
std::string yes_no(const Field& field);
/// An object of counts as "tracked: 26, mouse: 3", without counts of 0. An empty name is printed as "not
/// said". Returns "none" if all counts are 0.
std::string counts(const Field& object);
/// A paragraph with the reason why `field` does not exist; "" if it exists.
std::string why_not(const Field& field);

/// The attribute data-field with the field's JSON pointer, for HTML and SVG elements.
std::string data_field(const Field& field);

}  // namespace study::report
