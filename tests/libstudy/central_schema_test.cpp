/// The tables of the central database are those of the stations' files.
#include "libstudy/store/central/central_schema.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <map>

#include "libstudy/store/file/database.hpp"
#include "libstudy/store/file/schema.hpp"
#include "tests/libstudy/central_fixture.hpp"

namespace study {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

TEST(CentralSchema, EveryTableAndColumnHasAPlace) {
  const auto file = make_temporary_database("the schema");
  std::set<std::string> left;
  for (const auto& [key, object] : schema_of(*file)) {
    if (key.first != "table") continue;
    const auto& tables = central::tables();
    const auto table = std::find_if(tables.begin(), tables.end(),
                                    [&](const central::Table& one) { return one.name == key.second; });
    if (table == tables.end()) {
      left.insert(key.second);
      continue;
    }
    std::set<std::string> columns;
    for (const central::Column& column : table->columns) columns.insert(column.local);
    for (const std::string& column : columns_of(key.second)) {
      const bool own_number = column == table->name + "_id" && table->columns.front().local != column;
      EXPECT_TRUE(columns.contains(column) || own_number) << key.second << "." << column;
    }
  }
  EXPECT_THAT(left, ElementsAre("chore", "export", "export_person", "reserved_slot"));
}

TEST(CentralSchema, EveryCheckStandsAtTheCentre) {
  const auto file = make_temporary_database("the schema");
  for (const auto& [key, object] : schema_of(*file)) {
    if (key.first != "table" || key.second == "chore" || key.second == "reserved_slot" ||
        key.second.starts_with("export"))
      continue;
    int checks = 0;
    for (auto at = object.sql.find("CHECK ("); at != std::string::npos;
         at = object.sql.find("CHECK (", at + 1))
      ++checks;
    const auto there =
        test::lab().ask("SELECT count(*) FROM pg_constraint WHERE contype = 'c' AND conrelid = 'vip." +
                        key.second + "'::regclass");
    EXPECT_THAT(there, ElementsAre(std::to_string(checks))) << key.second;
  }
}

TEST(CentralSchema, ChecksAreTranslatedOrRefused) {
  const auto translated = [](const std::string& check) {
    return central::translated_check(check, {{"a", "a"}, {"uid", "session_uid"}}, "table t");
  };
  EXPECT_EQ(translated("a NOT GLOB '*[^a-z]*' AND length(uid) >= 3"),
            "\"a\" !~ '^.*[^a-z].*$' AND length ( \"session_uid\" ) >= 3");
  EXPECT_EQ(translated("a GLOB 'x?.y'"), "\"a\" ~ '^x.\\.y$'");
  for (const char* unknown : {"a LIKE 'x'", "random() > a", "b > 0", "a IN ('it''s')", "a || 'x' = 'y'"}) {
    EXPECT_THAT(test::message_of([&] { translated(unknown); }), HasSubstr("has no counterpart in PostgreSQL"))
        << unknown;
  }
}

TEST(CentralAdmin, OnlyTheOwnerMakesItOnce) {
  auto& server = ::test::postgres_server();
  EXPECT_THAT(test::message_of([] { central::init(test::lab().service()); }), HasSubstr("has a schema vip"));
  EXPECT_THAT(test::message_of([] { central::init("lab_admin"); }), HasSubstr("does not own the database"));
  server.sql("postgres", "CREATE ROLE modest_owner LOGIN");
  server.sql("postgres", "CREATE DATABASE modest OWNER modest_owner");
  server.add_service("modest", "modest_owner", "modest");
  const std::string message = test::message_of([] { central::init("modest"); });
  EXPECT_THAT(message, HasSubstr("may not create roles"));
  EXPECT_THAT(message, HasSubstr("CREATE ROLE \"modest_station\" NOLOGIN;"));
  EXPECT_EQ(server.sql("modest", "SELECT count(*) FROM pg_namespace WHERE nspname = 'vip'"), "0");
  EXPECT_THAT(test::message_of([] { central::upgrade("postgres_none"); }), HasSubstr("add the section"));
}

TEST(CentralAdmin, OnlyPlainRolesAreAdmitted) {
  test::Lab& lab = test::lab();
  const auto refused = [&](const std::string& role, central::Admission as) {
    return test::message_of([&] { central::admit(lab.service(), role, as); });
  };
  EXPECT_THAT(refused("nobody", central::Admission::Station), HasSubstr("createuser -P nobody"));
  EXPECT_THAT(refused("postgres", central::Admission::Station), HasSubstr("is a superuser"));
  EXPECT_THAT(refused("lab_owner", central::Admission::LabReader), HasSubstr("owns the database"));
  const std::string station = lab.admit("plain");
  central::admit(lab.service(), station, central::Admission::Station);  // again changes nothing
  EXPECT_THAT(refused(station, central::Admission::LabReader), HasSubstr("is a member of lab_station"));
}

TEST(CentralAdmin, AnUpgradeAddsTablesAndColumns) {
  test::Lab old("old");
  const std::string station = old.admit("north");
  const auto as_owner = [](const std::string& sql) { pg::Connection("old").script(sql); };
  as_owner(
      "DROP TABLE vip.light CASCADE; ALTER TABLE vip.frame DROP COLUMN nozzle_waited CASCADE; "
      "UPDATE vip.schema_version SET number = 11");
  const std::filesystem::path file = ::test::postgres_server().folder() / "none.db";
  EXPECT_THAT(test::message_of([&] { withdrawn_at_centre(StudyFile(file), station); }), HasSubstr("none.db"));
  const auto done = central::upgrade("old");
  EXPECT_EQ(done.before, 11);
  EXPECT_EQ(done.now, central::schema_number());
  EXPECT_THAT(done.added, ::testing::UnorderedElementsAre("light", "frame.nozzle_waited"));
  EXPECT_THAT(test::Lab::ask_as(station, "SELECT count(*) FROM vip.light"), ElementsAre("0"));
  EXPECT_THAT(central::upgrade("old").added, IsEmpty());

  const auto refusal = [&](const std::string& sql) {
    as_owner(sql);
    return test::message_of([] { central::upgrade("old"); });
  };
  EXPECT_THAT(refusal("ALTER TABLE vip.note DROP COLUMN words CASCADE"),
              HasSubstr("the new column note.words may not be empty"));
  as_owner("ALTER TABLE vip.note ADD COLUMN words text NOT NULL");
  EXPECT_THAT(refusal("ALTER TABLE vip.note ADD COLUMN colour text"), HasSubstr("note.colour is gone"));
  EXPECT_THAT(
      refusal("ALTER TABLE vip.note DROP COLUMN colour; ALTER TABLE vip.ipd DROP COLUMN ipd_mm CASCADE; "
              "ALTER TABLE vip.ipd ADD COLUMN ipd_mm text NOT NULL"),
      HasSubstr("ipd.ipd_mm changes from text to double precision"));
  EXPECT_THAT(refusal("UPDATE vip.schema_version SET number = 99"), HasSubstr("use a newer vip-study"));
}

}  // namespace
}  // namespace study
