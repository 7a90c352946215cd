#pragma once
/// A central database with stations and readers, on the PostgreSQL server of the tests.

#include <string>

#include "libstudy/store/central/central_admin.hpp"
#include "tests/common/postgres_server.hpp"

namespace study::test {

using namespace ::test;

/// A new central database. Roles and services begin with its name, which is `name` and a number.
class CentralWorld {
 public:
  explicit CentralWorld(const std::string& name) : name_(numbered(name)), owner_(name_ + "_owner") {
    auto& server = postgres_server();
    server.sql("postgres", "CREATE ROLE " + owner_ + " LOGIN CREATEROLE");
    server.sql("postgres", "CREATE DATABASE " + name_ + " OWNER " + owner_);
    server.add_service(owner_, owner_, name_);
    central::init(owner_);
  }

  /// Makes a role and its service; returns the service.
  std::string station(const std::string& who) { return role(who, central::Admission::Station); }
  std::string reader(const std::string& who) { return role(who, central::Admission::LabReader); }
  std::string shared_reader(const std::string& who) { return role(who, central::Admission::SharedReader); }

  /// What SQL gives to the administrator.
  std::string sql(const std::string& text) const { return postgres_server().sql(name_, text); }

 private:
  static std::string numbered(const std::string& name) {
    static int worlds = 0;
    return name + std::to_string(++worlds);
  }

  std::string role(const std::string& who, central::Admission admission) {
    const std::string role = name_ + "_" + who;
    postgres_server().sql("postgres", "CREATE ROLE " + role + " LOGIN");
    central::admit(owner_, role, admission);
    postgres_server().add_service(role, role, name_);
    return role;
  }

  std::string name_, owner_;
};

}  // namespace study::test
