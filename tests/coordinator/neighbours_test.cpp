/// Names of the interfaces and the friction of every kind of pair.
#include <gtest/gtest.h>

#include "coordinator/coordinator.hpp"
#include "coordinator/stack.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;

scene::Scene make_scene(const std::vector<std::pair<std::string, scene::Kind>>& layers) {
  scene::Scene s;
  for (const auto& [name, kind] : layers) {
    scene::Layer layer;
    layer.name = name;
    if (kind == scene::Kind::Metal)
      layer.law = scene::J2Law{};
    else
      layer.law = scene::WovenLaw{};
    s.layers.push_back(layer);
  }
  s.contact.tool_steel = 0.11;
  s.contact.tool_fabric = 0.12;
  s.contact.steel_fabric = 0.13;
  s.contact.fabric_fabric = 0.14;
  s.contact.steel_steel = 0.15;
  return s;
}
const auto kMetal = scene::Kind::Metal, kFabric = scene::Kind::Fabric;

TEST(Friction, DependsOnTheKindsOfTheTwoNeighbours) {
  const auto s = make_scene({{"s1", kMetal}, {"s2", kMetal}, {"f1", kFabric}, {"f2", kFabric}});
  for (const std::string tool : {"die", "punch", "blank_holder"}) {
    EXPECT_EQ(find_friction(s, tool, "s1"), 0.11);
    EXPECT_EQ(find_friction(s, "s2", tool), 0.11);
    EXPECT_EQ(find_friction(s, tool, "f1"), 0.12);
    EXPECT_EQ(find_friction(s, "f2", tool), 0.12);
  }
  EXPECT_EQ(find_friction(s, "s2", "f1"), 0.13);
  EXPECT_EQ(find_friction(s, "f1", "s2"), 0.13);
  EXPECT_EQ(find_friction(s, "f1", "f2"), 0.14);
  EXPECT_EQ(find_friction(s, "s1", "s2"), 0.15);
}

TEST(Friction, NamedPairOverridesItsKindInEitherOrderAndNothingElse) {
  auto s = make_scene({{"s1", kMetal}, {"f1", kFabric}, {"f2", kFabric}});
  s.contact.pairs = {{"f1", "s1", 0.5}, {"punch", "f2", 0.0}};
  EXPECT_EQ(find_friction(s, "s1", "f1"), 0.5);
  EXPECT_EQ(find_friction(s, "f1", "s1"), 0.5);
  EXPECT_EQ(find_friction(s, "f2", "punch"), 0.0);
  EXPECT_EQ(find_friction(s, "f2", "blank_holder"), 0.12);
  EXPECT_EQ(find_friction(s, "f1", "f2"), 0.14);
}

TEST(InterfaceNames, GoUpwardsFromTheDieWithTheLowerLayersNodes) {
  auto s = make_scene({{"s1", kMetal}, {"f1", kFabric}, {"s2", kMetal}});
  const auto expect = [&](const std::vector<std::pair<std::string, std::string>>& names) {
    const auto found = name_interfaces(s);
    ASSERT_EQ(found.size(), names.size());
    for (std::size_t i = 0; i < names.size(); ++i) {
      EXPECT_EQ(found[i].name, names[i].first);
      EXPECT_EQ(found[i].nodes_of, names[i].second);
    }
  };
  s.tools.punch.reset();
  expect({{"die|s1", "s1"}, {"s1|f1", "s1"}, {"f1|s2", "f1"}, {"s2|blank_holder", "s2"}});
  s.tools.punch = scene::Punch{};
  expect({{"die|s1", "s1"}, {"s1|f1", "s1"}, {"f1|s2", "f1"}, {"s2|blank_holder", "s2"}, {"s2|punch", "s2"}});
}

}  // namespace
