/// The wrapper of libpq, against a real server.
#include <arpa/inet.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <unistd.h>

#include <chrono>
#include <filesystem>
#include <fstream>
#include <limits>
#include <thread>

#include "libstudy/store/central/postgres.hpp"
#include "tests/common/postgres_server.hpp"
#include "tests/libstudy/central_fixture.hpp"

namespace {

using study::pg::Connection;
using study::pg::Failure;
using study::pg::Row;
using study::pg::Transaction;
using study::test::message_of;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::Optional;

/// A service of the administrator, for tables in its temporary schema.
const std::string& admin() {
  static const std::string service = [] {
    test::postgres_server().add_service("plain", "postgres", "postgres");
    return std::string("plain");
  }();
  return service;
}

TEST(CentralPostgres, RowsComeBackBitForBit) {
  Connection central(admin());
  central.script("CREATE TEMP TABLE t (n bigint, x double precision, words text)");
  const std::vector<Row> sent{{study::pg::text_of(std::numeric_limits<std::int64_t>::min()),
                               study::pg::text_of(0.1), "a\tb\\N\n\r\\"},
                              {"7", study::pg::text_of(std::numeric_limits<double>::denorm_min()), ""},
                              {"8", study::pg::text_of(-std::numeric_limits<double>::infinity()), "\\N"},
                              {{}, study::pg::text_of(std::numeric_limits<double>::max()), "größer"},
                              {"9", {}, {}}};
  EXPECT_EQ(
      central.insert("pg_temp.t", {{"n", "bigint"}, {"x", "double precision"}, {"words", "text"}}, sent), 5);
  EXPECT_GT(central.bytes_sent(), 40);
  std::vector<Row> got;
  central.copy_out("COPY pg_temp.t TO STDOUT", [&](const Row& row) { got.push_back(row); });
  EXPECT_EQ(got, sent);
  const auto rows =
      central.run("SELECT words FROM pg_temp.t WHERE n = $1 OR x = $2 ORDER BY n", {"7", "0.1"});
  ASSERT_EQ(rows.size(), 2);
  EXPECT_THAT(rows.at(0, 0), Optional(std::string("a\tb\\N\n\r\\")));
  EXPECT_EQ(rows.text(1, 0), "");
}

TEST(CentralPostgres, ErrorsNameTheServiceTheServersMessageAndARemedy) {
  Connection central(admin());
  central.script("CREATE TEMP TABLE t (n bigint CHECK (n > 0))");
  const auto insert = [&](const char* value) {
    return message_of([&] { central.run("INSERT INTO pg_temp.t VALUES ($1)", {value}); });
  };
  EXPECT_THAT(insert("x"), HasSubstr("service plain: invalid input syntax for type bigint"));
  EXPECT_THAT(insert("-1"), HasSubstr("violates check constraint"));
  EXPECT_THAT(insert("-1"), HasSubstr("\n  mend: "));
  EXPECT_THAT(message_of([&] {
                central.insert("pg_temp.t", {{"n", "bigint"}}, {{"1"}, {"word"}});
              }),
              HasSubstr("invalid input syntax"));
  EXPECT_THAT(message_of([&] { central.run("SELECT $1::text", {std::string("a\0b", 3)}); }),
              HasSubstr("NUL byte"));
  EXPECT_EQ(central.run("SELECT count(*) FROM pg_temp.t").integer(0, 0), 0)
      << "the connection is of no more use";
}

TEST(CentralPostgres, ATransactionThatIsNotCommittedLeavesNothing) {
  Connection central(admin());
  central.script("CREATE TEMP TABLE t (n bigint)");
  {
    const Transaction transaction(central);
    central.run("INSERT INTO pg_temp.t VALUES (1)");
  }
  EXPECT_EQ(central.run("SELECT count(*) FROM pg_temp.t").integer(0, 0), 0);
  Transaction transaction(central);
  EXPECT_EQ(central.run("INSERT INTO pg_temp.t VALUES (1), (2)").changed(), 2);
  transaction.commit();
  EXPECT_EQ(central.run("SELECT count(*) FROM pg_temp.t").integer(0, 0), 2);
}

TEST(CentralPostgres, OnlyNamesOfServicesAreTaken) {
  for (const char* text : {"", "host=db password=secret", "postgresql://u:secret@db", "a b", "a\nb"}) {
    const std::string message = message_of([&] { Connection central(text); });
    EXPECT_THAT(message, HasSubstr("is not a name")) << text;
    EXPECT_THAT(message, ::testing::Not(HasSubstr("secret")));
  }
  EXPECT_THAT(message_of([] { Connection central("nowhere"); }),
              HasSubstr("add the section [nowhere] to ~/.pg_service.conf"));
}

TEST(CentralPostgres, PasswordsComeFromThePasswordFile) {
  auto& server = test::postgres_server();
  server.sql("postgres", "CREATE ROLE anna LOGIN PASSWORD 'open:sesame'");
  const auto file = server.folder() / "passwords";
  server.add_service("over_tcp", "anna", "postgres", "host=127.0.0.1\npassfile=" + file.string());
  EXPECT_THAT(message_of([] { Connection central("over_tcp"); }), HasSubstr("service over_tcp: "));
  std::ofstream(file) << "127.0.0.1:*:*:anna:open\\:sesame\n";
  std::filesystem::permissions(file, std::filesystem::perms(0600));
  Connection central("over_tcp");
  EXPECT_EQ(central.run("SELECT session_user").text(0, 0), "anna");
}

TEST(CentralPostgres, ALostServerIsToldFromARefusedRow) {
  Connection central(admin());
  test::postgres_server().stop_immediately();
  try {
    central.run("SELECT 1");
    ADD_FAILURE() << "a stopped server answered";
  } catch (const Failure& failure) {
    EXPECT_TRUE(failure.lost());
  }
  EXPECT_THAT(message_of([] { Connection again(admin()); }), HasSubstr("whether the server runs"));
  test::postgres_server().start();
  Connection again(admin());
  try {
    again.run("SELECT 1 / 0");
    ADD_FAILURE() << "a division by zero gave a number";
  } catch (const Failure& failure) {
    EXPECT_FALSE(failure.lost());
    EXPECT_EQ(failure.sqlstate(), "22012");
  }
}

TEST(CentralPostgres, AnotherThreadCancelsAStatement) {
  Connection central(admin());
  std::thread other([&] {
    Connection watch(admin());
    while (watch.run("SELECT 1 FROM pg_stat_activity WHERE query = 'SELECT pg_sleep(60)'").size() == 0)
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    central.cancel();
  });
  EXPECT_THAT(message_of([&] { central.run("SELECT pg_sleep(60)"); }), HasSubstr("user request"));
  other.join();
}

TEST(CentralPostgres, AServerThatNeverAnswersEndsTheWait) {
  const int silent = ::socket(AF_INET, SOCK_STREAM, 0);
  sockaddr_in address{};
  address.sin_family = AF_INET;
  address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
  socklen_t length = sizeof address;
  ASSERT_EQ(::bind(silent, reinterpret_cast<sockaddr*>(&address), length), 0);
  ASSERT_EQ(::listen(silent, 1), 0);
  ASSERT_EQ(::getsockname(silent, reinterpret_cast<sockaddr*>(&address), &length), 0);
  test::postgres_server().add_service(
      "silent", "postgres", "postgres",
      "host=127.0.0.1\nconnect_timeout=2\nport=" + std::to_string(ntohs(address.sin_port)));
  EXPECT_THAT(message_of([] { Connection central("silent"); }), HasSubstr("no answer within 2 s"));
  ::close(silent);
}

}  // namespace
