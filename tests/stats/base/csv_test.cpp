/// Tables in CSV files.

#include "stats/base/csv.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "stats/base/error.hpp"
#include "stats/base/file.hpp"
#include "tests/common/temporary_folder.hpp"

namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

class Csv : public ::testing::Test {
 protected:
  base::CsvTable read(const std::string& text) {
    const auto path = folder_ / "table.csv";
    base::write_file_atomically(path, text);
    return base::CsvTable(path);
  }
  std::string refusal(const std::string& text) {
    try {
      read(text);
    } catch (const base::Error& error) {
      return error.what();
    }
    return "";
  }
  ::test::TemporaryFolder folder_;
};

TEST_F(Csv, FieldsInQuotesHoldSeparatorsLineEndsAndQuotes) {
  const auto table =
      read("\xEF\xBB\xBFname,note\r\n\"a, b\",\"two\nlines\"\r\n\n c\t, \"say \"\"no\"\"\" \n");
  EXPECT_THAT(table.columns(), ElementsAre("name", "note"));
  ASSERT_EQ(table.rows().size(), 2u);
  EXPECT_THAT(table.rows()[0].fields, ElementsAre("a, b", "two\nlines"));
  EXPECT_THAT(table.rows()[1].fields, ElementsAre("c", "say \"no\""));
  EXPECT_EQ(table.rows()[0].line, 2);
  EXPECT_EQ(table.rows()[1].line, 5);
  EXPECT_EQ(table.column("note"), 1u);
  EXPECT_FALSE(table.find("Note"));
}

TEST_F(Csv, SeparatorIsThatOfTheFirstLine) {
  EXPECT_THAT(read("a;b\n1,5;2\n").rows()[0].fields, ElementsAre("1,5", "2"));
  EXPECT_THAT(read("a\tb\n1\t\n").rows()[0].fields, ElementsAre("1", ""));
  EXPECT_THAT(read("\"a;b\",c\n1;2,3").rows()[0].fields, ElementsAre("1;2", "3"));
  EXPECT_THAT(read("a\n1\n2").rows()[1].fields, ElementsAre("2"));
}

TEST_F(Csv, ErrorsNameTheLine) {
  EXPECT_THAT(refusal(""), HasSubstr("is empty"));
  EXPECT_THAT(refusal("a,b\n1,2\n\n1\n"), HasSubstr("table.csv:4: has 1 fields where 2 belong"));
  EXPECT_THAT(refusal("a,\n1,2\n"), HasSubstr("table.csv:2: has 2 fields where 1 belong"));
  EXPECT_THAT(refusal("a\n\"x\n"), HasSubstr("table.csv:2: opens a quote"));
  EXPECT_THAT(refusal("a,b\n\"x\"y,2\n"), HasSubstr("after a closing quote"));
  EXPECT_THAT(refusal("a\nb\n\xE4\n"), HasSubstr("table.csv:3: is no text in UTF-8"));
  EXPECT_THAT(refusal(std::string("a\n\0\n", 4)), HasSubstr("is no text in UTF-8"));
  EXPECT_THAT(refusal("person,score\n"), "");
  try {
    static_cast<void>(read("person,score\n").column("persons"));
    FAIL();
  } catch (const base::Error& error) {
    EXPECT_THAT(error.what(), HasSubstr("the nearest is \"person\""));
  }
}

TEST_F(Csv, ANameThatColumnsShareIsRefusedWhenItIsUsed) {
  const auto table = read("a,b,a\n1,2,3\n");
  EXPECT_EQ(table.column("b"), 1u);
  EXPECT_THAT([&] { static_cast<void>(table.find("a")); },
              testing::ThrowsMessage<base::Error>(HasSubstr("names the column a twice")));
}

TEST_F(Csv, SeparatorsAtTheEndsOfLinesMakeNoColumn) {
  const auto table = read("a,b,\n1,2,\n3,4\n");
  EXPECT_THAT(table.columns(), ElementsAre("a", "b"));
  EXPECT_THAT(table.rows()[0].fields, ElementsAre("1", "2"));
  EXPECT_THAT(table.rows()[1].fields, ElementsAre("3", "4"));
}

}  // namespace
