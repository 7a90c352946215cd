#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <string_view>

#include "libstudy/store/file/sqlite.hpp"

namespace study {
namespace {

using sqlite::Connection;
using sqlite::Statement;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;

template <class Value>
concept Bound = requires(Statement& statement, const Value& value) {
  statement.bind_at(0, value);
};
static_assert(Bound<int> && Bound<std::int64_t> && Bound<double> && Bound<const char*> && Bound<std::string>);
static_assert(Bound<std::nullopt_t> && Bound<std::optional<int>> && Bound<std::optional<std::string>>);
static_assert(!Bound<std::size_t>, "may not fit");
static_assert(!Bound<const void*>);

class StatementTest : public ::testing::Test {
 protected:
  std::string told(Statement& statement) {
    EXPECT_TRUE(statement.step());
    std::string all = statement.text(0);
    EXPECT_FALSE(statement.step());
    return all;
  }
  Connection database{"statement", sqlite::Temporary{}};
};

TEST_F(StatementTest, BindAllGivesEachParameterItsValueInOrder) {
  Statement row(database,
                "SELECT printf('%s', typeof(?1)||?1||typeof(?2)||?2||typeof(?3)||?3||typeof(?4)||?4||"
                "typeof(?5)||typeof(?6)||typeof(?7)||?7||typeof(?8)||?8)");
  row.bind_all(7, std::numeric_limits<std::int64_t>::min(), 0.5, "one", std::nullopt,
               std::optional<std::string>(), std::optional(std::string("two")), std::string_view());
  EXPECT_EQ(told(row), "integer7integer-9223372036854775808real0.5textonenullnulltexttwotext");
  row.bind_all(0, 1, std::nan(""), "", 2, 3, 4, 5);
  EXPECT_EQ(told(row), "") << "NaN is NULL, and so is what it is joined to";
}

TEST_F(StatementTest, BindAllRefusesAnotherNumberOfValues) {
  Statement row(database, "SELECT ? || ?");
  const auto wrong = ThrowsMessage<std::logic_error>(HasSubstr("parameters of: SELECT ? || ?"));
  EXPECT_THAT([&] { row.bind_all(); }, wrong);
  EXPECT_THAT([&] { row.bind_all("a"); }, wrong);
  EXPECT_THAT([&] { row.bind_all("a", "b", "c"); }, wrong);
  row.bind_all("a", "b");
  EXPECT_EQ(told(row), "ab");

  Statement named(database, "SELECT ?2 || ?1 || ?2");
  EXPECT_THAT([&] { named.bind_all("a", "b", "c"); },
              ThrowsMessage<std::logic_error>(HasSubstr("3 values for the 2")));
  named.bind_all("a", "b");
  EXPECT_EQ(told(named), "bab");
}

}  // namespace
}  // namespace study
