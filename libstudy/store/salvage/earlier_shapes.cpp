#include "libstudy/store/salvage/earlier_shapes.hpp"

#include <algorithm>
#include <utility>

#include "libstudy/store/file/database.hpp"

namespace study::salvaging {

namespace {

constexpr std::size_t first_schema = 2;

bool same(const Shape::Column& a, const Shape::Column& b) {
  return a.name == b.name && a.type == b.type && a.may_be_null == b.may_be_null;
}

bool same(const Shape& a, const Shape& b) {
  return a.table == b.table &&
         std::equal(a.columns.begin(), a.columns.end(), b.columns.begin(), b.columns.end(),
                    [](const auto& x, const auto& y) { return same(x, y); });
}

EarlierShape placed(const Shape& shape, const std::vector<Shape>& now, std::size_t index) {
  EarlierShape out{shape, index, {}};
  for (const Shape::Column& column : now[index].columns) {
    const auto found = std::find_if(shape.columns.begin(), shape.columns.end(),
                                    [&](const Shape::Column& before) { return same(before, column); });
    out.source.emplace_back();
    if (found != shape.columns.end())
      out.source.back() = static_cast<std::size_t>(found - shape.columns.begin());
  }
  return out;
}

/// The shapes of every schema before this program's.
std::vector<Shape> shapes_before() {
  std::vector<Shape> out;
  const SchemaSteps steps = read_schema_steps();
  for (std::size_t schema = first_schema; schema < steps.size(); ++schema) {
    const auto database =
        make_temporary_database("schema " + std::to_string(schema),
                                {steps.begin(), steps.begin() + static_cast<std::ptrdiff_t>(schema)});
    for (Shape& shape : shapes_of(*database)) out.push_back(std::move(shape));
  }
  return out;
}

}  // namespace

std::vector<EarlierShape> earlier_shapes(const std::vector<Shape>& now) {
  static const std::vector<Shape> before = shapes_before();
  std::vector<EarlierShape> out;
  for (const Shape& shape : before) {
    const auto table =
        std::find_if(now.begin(), now.end(), [&](const Shape& one) { return one.table == shape.table; });
    const bool known =
        table == now.end() || same(*table, shape) ||
        std::any_of(out.begin(), out.end(), [&](const EarlierShape& one) { return same(one.shape, shape); });
    if (!known) out.push_back(placed(shape, now, static_cast<std::size_t>(table - now.begin())));
  }
  return out;
}

Values as_now(const EarlierShape& earlier, const Values& row) {
  Values out;
  for (const auto& column : earlier.source) out.push_back(column ? row.at(*column) : Value());
  return out;
}

}  // namespace study::salvaging
