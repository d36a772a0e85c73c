#include "observe/known_run.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "record/sample_run.hpp"

namespace interply::observe {
namespace {

using test::SampleRun;
using testing::HasSubstr;

constexpr Sender kCoordinator = {1}, kPly = {2}, kSheet = {3}, kStranger = {9}, kNobody = {};
const std::string kRun = "trial-0123456789abcdef";

/// Why the sample is not admitted; empty if it is.
template <typename Run, typename T>
std::string refusal(Run& known, const T& sample, const Sender& sender, const std::string& run = kRun) {
  try {
    known.admit(sample, run, sender);
    return "";
  } catch (const std::runtime_error& e) {
    return e.what();
  }
}

class AKnownRun : public testing::Test {
 protected:
  AKnownRun() {
    known.admit(run.header(), kRun, kCoordinator);
    known.admit(run.mesh(0), kRun, kPly);
    known.admit(run.mesh(1), kRun, kSheet);
  }
  SampleRun run;
  KnownRun known{kRun};
};
TEST_F(AKnownRun, AdmitsEverythingThatTheRunPublishes) {
  EXPECT_TRUE(known.has_header() && known.has_meshes());
  EXPECT_EQ(refusal(known, run.header(), kCoordinator), "");
  EXPECT_EQ(refusal(known, run.mesh(1), kSheet), "");
  for (int k = 0; k <= 3; ++k) {
    EXPECT_EQ(refusal(known, run.layer_frame(0, k), kPly), "");
    EXPECT_EQ(refusal(known, run.layer_frame(1, k), kSheet), "");
    for (int i = 0; i < 2; ++i) EXPECT_EQ(refusal(known, run.interface_frame(i, k), kCoordinator), "");
    EXPECT_EQ(refusal(known, run.tool_frame(k), kCoordinator), "");
    EXPECT_EQ(refusal(known, run.history_row(k), kCoordinator), "");
  }
  EXPECT_EQ(refusal(known, run.end(4), kCoordinator), "");
}

TEST_F(AKnownRun, NothingOfAnotherIdentityIsAdmitted) {
  const std::string other = "trial-fedcba9876543210";
  EXPECT_THAT(refusal(known, run.header(), kCoordinator, other), HasSubstr("it is of run 'trial-fedcba9876543210'"));
  EXPECT_NE(refusal(known, run.mesh(0), kPly, other), "");
  EXPECT_NE(refusal(known, run.layer_frame(0, 1), kPly, other), "");
  EXPECT_NE(refusal(known, run.interface_frame(0, 1), kCoordinator, other), "");
  EXPECT_NE(refusal(known, run.tool_frame(1), kCoordinator, other), "");
  EXPECT_NE(refusal(known, run.history_row(1), kCoordinator, other), "");
  EXPECT_NE(refusal(known, run.end(4), kCoordinator, other), "");
}

TEST_F(AKnownRun, AStrangerCannotSpeakForAnotherParticipant) {
  for (const Sender& sender : {kStranger, kNobody}) {
    EXPECT_NE(refusal(known, run.header(), sender), "");
    EXPECT_NE(refusal(known, run.mesh(0), sender), "");
    EXPECT_NE(refusal(known, run.layer_frame(0, 1), sender), "");
    EXPECT_NE(refusal(known, run.interface_frame(0, 1), sender), "");
    EXPECT_NE(refusal(known, run.tool_frame(1), sender), "");
    EXPECT_NE(refusal(known, run.history_row(1), sender), "");
    EXPECT_NE(refusal(known, run.end(1), sender), "") << "an early end";
  }
  EXPECT_NE(refusal(known, run.layer_frame(0, 1), kSheet), "") << "a solver for another's layer";
}

TEST_F(AKnownRun, SizesFollowFromHeaderAndMeshes) {
  const SampleRun larger(3, 6);
  EXPECT_THAT(refusal(known, larger.layer_frame(0, 1), kPly), HasSubstr("layer 'ply_1' has 25 nodes, not 36"));
  EXPECT_THAT(refusal(known, larger.mesh(0), kPly), HasSubstr("a second mesh of layer 'ply_1'"));
  EXPECT_THAT(refusal(known, larger.interface_frame(0, 1), kCoordinator), HasSubstr("has 36 values for 25 nodes"));
  LayerFrame frame = run.layer_frame(0, 1);
  frame.fields[1].values.pop_back();
  EXPECT_THAT(refusal(known, frame, kPly), HasSubstr("field 'thickness'"));
  frame = run.layer_frame(0, 4);
  EXPECT_THAT(refusal(known, frame, kPly), HasSubstr("frame 4 is not in [0, 3]"));
  frame.frame = -1;
  EXPECT_NE(refusal(known, frame, kPly), "");
  InterfaceFrame interface = run.interface_frame(0, 1);
  interface.nodes_of = "sheet";
  EXPECT_NE(refusal(known, interface, kCoordinator), "");
  ToolFrame tool = run.tool_frame(1);
  tool.tool = "hammer";
  EXPECT_EQ(refusal(known, tool, kCoordinator), "the run has no tool 'hammer'");
  InterfaceFrame other = run.interface_frame(0, 1);
  other.fields_on_other[0].values.resize(300);
  EXPECT_NE(refusal(known, other, kCoordinator), "");
  HistoryRow row = run.history_row(1);
  row.votes.resize(1000);
  EXPECT_EQ(refusal(known, row, kCoordinator), "a history row of 1000 layers, not 2");
  EXPECT_NE(refusal(known, run.end(5), kCoordinator), "");
}

TEST(KnownRun, AHeaderOfATerabyteOrAMeshThatIsNoMeshIsNotAdmitted) {
  const SampleRun run;
  KnownRun known(kRun);
  RunHeader header = run.header();
  header.frames = std::numeric_limits<int>::max();
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.history_capacity = std::numeric_limits<int>::max();
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.interface_nodes_of = {"ply_1"};
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.interface_nodes_of[1] = "die";
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.interface_others.clear();
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.tool_surfaces.resize(1000);
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.layers = {"ply_1", "ply_1"};
  EXPECT_NE(refusal(known, header, kStranger), "");
  header.layers.clear();
  EXPECT_NE(refusal(known, header, kStranger), "");
  header = run.header();
  header.nodes = header.elements = {25};
  EXPECT_NE(refusal(known, header, kStranger), "");
  EXPECT_FALSE(known.has_header());
  header = run.header();
  header.nodes = {25, 36};
  header.elements = {32, 50};
  EXPECT_EQ(refusal(known, header, kCoordinator), "");
  EXPECT_THAT(refusal(known, SampleRun(3, 9).mesh(0), kPly), HasSubstr("which layer 'ply_1' has not"));
  LayerMesh mesh = run.mesh(0);
  mesh.triangles(2, 3) = static_cast<int>(mesh.reference.cols());
  EXPECT_THAT(refusal(known, mesh, kPly), HasSubstr("triangles of nodes that it has not"));
  mesh.triangles(2, 3) = -1;
  EXPECT_NE(refusal(known, mesh, kPly), "");
  EXPECT_FALSE(known.has_meshes());
}

}  // namespace
}  // namespace interply::observe
