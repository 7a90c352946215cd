/// Lists that repeat the names of the solver's methods, in protocols and pages, must name the same methods.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "libsim/methods/method.hpp"
#include "libsim/render/fluid_renderer.hpp"
#include "libstudy/protocol/names.hpp"
#include "libstudy/protocol/reference.hpp"
#include "stats/base/file.hpp"

namespace apps {
namespace {

std::vector<std::string> solver_methods() {
  std::vector<std::string> out;
  for (const auto& method : sim::all_methods()) out.emplace_back(method.name);
  return out;
}

TEST(MethodNames, ProtocolsKnowTheMethodsOfTheSolver) { EXPECT_EQ(study::method_names(), solver_methods()); }

TEST(MethodNames, ProtocolsKnowTheSurfacesOfTheRenderer) {
  for (const std::string& name : study::surface_names())
    EXPECT_EQ(sim::surface_name(sim::parse_surface(name)), name);
  EXPECT_EQ(study::surface_names().front(), sim::surface_name(sim::RenderOptions{}.surface))
      << "the usual one";
}

TEST(MethodNames, ThePagesNameEachMethod) {
  std::string all;
  for (const std::string& name : solver_methods()) all += (all.empty() ? "" : ", ") + name;
  const auto& keys = study::protocol_reference();
  const auto key = std::find_if(keys.begin(), keys.end(), [](const study::KeyReference& one) {
    return one.table == "design" && one.key == "method";
  });
  ASSERT_NE(key, keys.end());
  EXPECT_EQ(key->meaning, all) << "libstudy/protocol/reference.cpp";
  const std::string page = base::read_file(base::resource("docs/methods.md"), 1 << 20);
  for (const std::string& name : solver_methods())
    EXPECT_THAT(page, ::testing::HasSubstr("\n| " + name + " | "));
}

}  // namespace
}  // namespace apps
