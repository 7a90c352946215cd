/// Every hard case of libsim/cases with each of its methods: S02TallColumn.HiRes is small and on the CPU;
/// suites that end in Slow have full size, those that end in Gpu full size on CUDA.

#include "libsim/cases/hard_case.hpp"

#include <gtest/gtest.h>

#include <algorithm>

namespace {

using sim::cases::HardCase;
using sim::cases::Setting;
using sim::cases::Size;

class CaseTest : public testing::Test {
 public:
  CaseTest(const HardCase& hard_case, const Setting& setting) : case_(hard_case), setting_(setting) {}
  void TestBody() override {
    const auto outcome = case_.run(setting_);
    std::printf("%s, %s: %s\n", case_.id, sim::method_name(setting_.method).c_str(), outcome.text().c_str());
    EXPECT_TRUE(outcome.passes()) << outcome.text();
  }

 private:
  const HardCase& case_;
  Setting setting_;
};

/// True for cases whose full size needs a GPU.
bool too_large_for_a_cpu(const HardCase& one) { return std::string(one.id) == "S8b"; }

void add(const HardCase& one, const Setting& setting, const std::string& suite) {
  std::string method = sim::method_name(setting.method);
  std::erase(method, '-');
  testing::RegisterTest(suite.c_str(), method.c_str(), nullptr, nullptr, __FILE__, __LINE__,
                        [&one, setting]() -> testing::Test* { return new CaseTest(one, setting); });
}

const bool added = [] {
  for (const HardCase& one : sim::cases::hard_cases()) {
    const std::string suite = one.suite;
    for (const auto method : one.methods) {
      add(one, {.method = method}, suite);
      add(one, {.method = method, .backend = sim::Backend::Cuda, .size = Size::Full}, suite + "Gpu");
      if (!too_large_for_a_cpu(one)) add(one, {.method = method, .size = Size::Full}, suite + "Slow");
    }
  }
  return true;
}();

}  // namespace
