#pragma once
/// Places in the results' JSON, and how they are printed. Every number of the page goes through here, with
/// its place beside it as data-field, so that page and JSON can be compared.

#include <string>
#include <vector>

#include "stats/base/json.hpp"

namespace apps::report {

using Json = base::Json;

/// A value of the results with its JSON pointer. What is absent reads as null.
class Field {
 public:
  /// `root` outlives every Field.
  explicit Field(const Json& root) : value_(&root) {}

  Field operator[](const std::string& key) const;
  Field operator[](std::size_t index) const;

  const Json& json() const { return *value_; }
  const std::string& pointer() const { return pointer_; }
  /// Neither absent, null nor refused.
  bool there() const;
  /// Why there is no value: its own "refused", its "..._reason" or the "reason" beside it; empty = none is
  /// given.
  std::string reason() const;
  /// Of a list; empty for anything else.
  std::vector<Field> entries() const;
  /// Of an object, by name; empty for anything else.
  std::vector<std::pair<std::string, Field>> members() const;
  bool is_number() const { return value_->is_number(); }
  double number() const;      ///< 0 when it is none
  std::string words() const;  ///< "" when it is no text
  bool yes() const;           ///< true, and nothing else

 private:
  Field(const Json& value, std::string pointer, const Json* parent)
      : value_(&value), pointer_(std::move(pointer)), parent_(parent) {}

  const Json* value_;
  std::string pointer_;
  const Json* parent_ = nullptr;
};

/// A number as people read it: a true minus sign.
std::string decimal(double value, int decimals);
/// A p value as the APA prints it: ".029", "< .001", "1.000" as "> .999".
std::string p_value(double p);

/// Formulas as they stand in texts of the results ("n_*", "mu(delta)", "+-3 %"), in italics and with the
/// signs of print. `html`: escaped.
std::string typeset(std::string html);

/// What particles there are when all are coarsest, as the paper writes it.
inline const std::string n_star_sign = "<i>n</i><sub>*</sub>";

/// mu(delta) = a e^(b delta), the curve of the pilot.
inline const std::string pilot_curve =
    "<i>\xCE\xBC</i>(<i>\xCE\xB4</i>) = <i>a</i>\xE2\x80\x89"
    "e<sup><i>b</i>\xE2\x80\x89<i>\xCE\xB4</i></sup>";

// As HTML with data-field. What is not there is a dash that says why.
std::string fixed(const Field& field, int decimals);
std::string count(const Field& field);
/// A share in [0, 1] as per cent, with the sign behind it.
std::string percent(const Field& field, int decimals = 0);
/// "= .029" or "< .001", for running text; `bare` leaves "=" out, for tables.
std::string p(const Field& field);
std::string p_bare(const Field& field);
/// "[0.12, 0.34]"; open ends as infinity.
std::string interval(const Field& field, int decimals);
/// As interval(), for frame rates: prints "no upper bound" if the upper end is above 1000 frames/s.
std::string rate_interval(const Field& field);
/// A text, its formulas typeset.
std::string words(const Field& field);
/// "yes" or "no".
std::string yes_no(const Field& field);
/// "tracked: 26, mouse: 3" of an object with counts; an empty name is "not said". "none" of no count.
std::string counts(const Field& object);
/// The reason why `field` is not there, as a sentence; "" when it is.
std::string why_not(const Field& field);

/// The same for the attributes of an SVG text.
std::string data_field(const Field& field);

}  // namespace apps::report
