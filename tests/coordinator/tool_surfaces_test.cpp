#include "coordinator/tool_surfaces.hpp"

#include <gtest/gtest.h>

#include "coordinator/scripted_link.hpp"
#include "support/own_tools.hpp"

namespace {

using namespace interply;
using mechanics::at;
using mechanics::Vector3;
using observe::ToolSurface;

struct Tools {
  scene::Scene scene;
  mechanics::TriangleMesh blank = solve::make_layer_mesh(scene, 4);
  coordinator::PlacedTools placed = coordinator::place_tools(scene, solve::make_layer_mesh(scene, 0), blank, 5.6);
  std::vector<ToolSurface> surfaces = coordinator::make_tool_surfaces(scene, placed, blank);

  explicit Tools(const std::vector<std::string>& overrides) : scene(test::read_flat_stack(overrides)) {}
  std::vector<const coordinator::PlacedTool*> tools() const {
    return {&placed.die, &placed.blank_holder, &placed.punch};
  }
};

/// Corner of triangle t.
Vector3 corner(const ToolSurface& s, Eigen::Index t, int k) { return at(s.nodes, s.triangles(k, t)); }

/// Nodes lie on the tool, triangles within their sagitta of it, and their normals point out of it: 10 (1 - cos 5.6 deg)
/// + 22 (1 - cos 3.8 deg) = 0.1 mm at the shoulders; on the ball of the punch, chords of 4 mm in both directions on a
/// radius of 15 mm, 2 4^2/(8 15) = 0.27 mm.
TEST(ToolSurfaces, OfParametricToolsLieOnThemAndFaceOutwards) {
  const Tools t({"motion.stroke=60"});
  ASSERT_EQ(t.surfaces.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const ToolSurface& s = t.surfaces[i];
    const contact::SignedDistance& shape = *t.tools()[i]->shape;
    for (Eigen::Index k = 0; k < s.nodes.cols(); ++k) ASSERT_NEAR(shape.evaluate(at(s.nodes, k)).value, 0, 1e-6) << i;
    for (Eigen::Index e = 0; e < s.triangles.cols(); ++e) {
      const Vector3 a = corner(s, e, 0), b = corner(s, e, 1), c = corner(s, e, 2), area = (b - a).cross(c - a);
      const contact::Distance middle = shape.evaluate((a + b + c) / 3);
      ASSERT_GT(area.norm(), 0) << i;
      ASSERT_GT(area.normalized().dot(middle.gradient), 0.9) << i << ' ' << e;
      ASSERT_LT(std::abs(middle.value), 0.27) << i << ' ' << e;
    }
  }
}

/// Seen from above, the whole blank lies on the die's land or over its opening; the punch reaches from its tip to above
/// the stack at full stroke.
TEST(ToolSurfaces, ReachBeyondTheBlankAndTheStroke) {
  const Tools t({"motion.stroke=60", "blank.symmetry=full"});
  for (const std::size_t i : {0u, 1u}) {
    const ToolSurface& s = t.surfaces[i];
    double land = 0;  // flat triangles, mm2
    for (Eigen::Index e = 0; e < s.triangles.cols(); ++e)
      if (corner(s, e, 0).z() == 0 && corner(s, e, 1).z() == 0 && corner(s, e, 2).z() == 0)
        land += 0.5 * (corner(s, e, 1) - corner(s, e, 0)).cross(corner(s, e, 2) - corner(s, e, 0)).norm();
    EXPECT_GT(land, t.placed.flange_area) << i;
    EXPECT_GT(s.nodes.row(0).maxCoeff(), 140);
    EXPECT_LT(s.nodes.row(1).minCoeff(), -140);
  }
  EXPECT_EQ(t.surfaces[2].nodes.row(2).minCoeff(), 0);
  EXPECT_GT(t.surfaces[2].nodes.row(2).maxCoeff(), 60);
  EXPECT_LT(t.surfaces[0].nodes.row(2).minCoeff(), -60);
}

TEST(ToolSurfaces, OfStlAreAsGiven) {
  const test::OwnTools files(8);
  const Tools t(files.overrides());
  for (std::size_t i = 0; i < 3; ++i) {
    const geometry::Surface& given = *t.tools()[i]->surface;
    EXPECT_TRUE((t.surfaces[i].nodes == given.vertices).all());
    EXPECT_TRUE((t.surfaces[i].triangles == given.triangles).all());
  }
}

TEST(ToolSurfaces, ASceneWithoutAPunchHasTwo) { EXPECT_EQ(Tools({"tools.punch=none"}).surfaces.size(), 2u); }

}  // namespace
