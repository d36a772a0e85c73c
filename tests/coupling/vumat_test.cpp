/// A ply and a sheet with laws of the user's own in a whole run, in one process and in many.
#include <gmock/gmock.h>

#include <fstream>

#include "faults/programs.hpp"
#include "support/in_process_run.hpp"
#include "support/vumat_laws.hpp"

namespace interply::faults {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// An override that gives a layer a vumat.
std::string set_law(const std::string& layer, const scene::VumatLaw& law) {
  std::string text = "layers." + layer + ".law={vumat: {library: " + law.library.path + ", parameters: [";
  for (const double p : law.parameters) text += std::to_string(p) + ", ";
  text += "], state_variables: " + std::to_string(law.state_variables) + ", integration: ";
  return text + (law.integration == scene::Integration::Shell ? "shell" : "membrane") + "}}";
}

std::string own_ply() { return set_law("ply_2", test::make_woven_vumat({})); }
std::string own_sheet() { return set_law("sheet_upper", test::make_j2_vumat({}, scene::Integration::Shell)); }

const std::vector<std::string> kMoving{"motion.stroke=2", "motion.forming_time=0.4e-3"};

class OwnLaw : public testing::Test {
 protected:
  std::unique_ptr<Program> start(const std::string& out, const std::vector<std::string>& overrides,
                                 const std::vector<std::string>& more = {}) {
    std::vector<std::string> words{"run", kScenes / "flat_stack.yaml", "--out", folder_.path() / out};
    for (const auto& list : {kMoving, overrides})
      for (const std::string& o : list) words.insert(words.end(), {"--set", o});
    words.insert(words.end(), more.begin(), more.end());
    return std::make_unique<Program>("interply", words, folder_.path());
  }
  TemporaryFolder folder_;
};

TEST_F(OwnLaw, FederatedRunHasTheBitsOfTheRunInOneProcess) {
  const auto federated = start("federated", {own_ply(), own_sheet()});
  ASSERT_EQ(federated->wait(), 0) << federated->said();
  const auto in_process = start("in_process", {own_ply(), own_sheet()}, {"--in-process"});
  ASSERT_EQ(in_process->wait(), 0) << in_process->said();
  EXPECT_EQ(federated->last_line(), in_process->last_line());
  EXPECT_THAT(federated->last_line(), HasSubstr("digest "));

  // the run says which library it used
  EXPECT_THAT(read_text(folder_.path() / "federated/scene.yaml"),
              AllOf(HasSubstr("libwoven.so"), HasSubstr("digest: ")));
}

TEST_F(OwnLaw, FormsWhatTheBuiltInLawForms) {
  const auto run = [](const std::vector<std::string>& more) {
    std::vector<std::string> overrides = kMoving;
    overrides.insert(overrides.end(), more.begin(), more.end());
    return test::run_in_process(test::read_test_scene("flat_stack.yaml", overrides));
  };
  const auto built_in = run({}), own = run({own_ply()});
  ASSERT_EQ(own.outcome.exit_code, 0) << own.outcome.message;
  ASSERT_EQ(own.outcome.measures.steps, built_in.outcome.measures.steps);  // steel limits the increment
  const auto& a = own.sink->rows.back();
  const auto& b = built_in.sink->rows.back();
  EXPECT_NEAR(a.punch_force, b.punch_force, 1e-6 * b.punch_force);
  EXPECT_LT(own.outcome.measures.largest_residual, 1e-3);
}

TEST_F(OwnLaw, LibraryThatIsNotThereIsRefusedBeforeAnythingStarts) {
  auto missing = test::make_woven_vumat({});
  missing.library.path = "libmissing.so";
  const auto program = start("out", {set_law("ply_2", missing)});
  EXPECT_EQ(program->wait(), 2);
  EXPECT_THAT(program->said(), AllOf(HasSubstr("layers[2].law.vumat.library"), HasSubstr("libmissing.so")));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(OwnLaw, LibraryWithoutEntryPointIsRefusedBeforeAnythingStarts) {
  const auto program = start("out", {set_law("ply_2", test::make_vumat("umat", {}))});
  EXPECT_EQ(program->wait(), 2);
  EXPECT_THAT(program->said(), HasSubstr("layer ply_2: law.vumat.library"));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
}

TEST_F(OwnLaw, StressThatIsNotANumberEndsTheRunAsADivergence) {
  const auto program = start("out", {set_law("ply_2", test::make_faulty_vumat(500, 1, 1e-4))}, {"--no-record"});
  EXPECT_EQ(program->wait(), 3);
  EXPECT_THAT(program->said(), AllOf(HasSubstr("layer ply_2, element"), HasSubstr("vumat")));
}

TEST_F(OwnLaw, LawThatEndsItsProcessEndsTheRunByNameWithItsWords) {
  const auto words = HasSubstr("no convergence of the return mapping");
  for (const auto fault : {test::kStop, test::kNullPointer})
    for (const std::string how : {"federated", "--in-process"}) {
      std::vector<std::string> more{"--overwrite"};
      if (how == "--in-process") more.push_back(how);
      const auto program = start("out", {set_law("ply_2", test::make_faulty_vumat(500, fault, 1e-4))}, more);
      EXPECT_EQ(program->wait(), 4) << fault << how;
      EXPECT_THAT(program->said(), AllOf(HasSubstr("layer ply_2: law.vumat.library: "), HasSubstr("libfaulty.so ended"),
                                         words));
    }
}

TEST_F(OwnLaw, LawThatNeverReturnsEndsTheRunByTheDeadline) {
  const std::string law = set_law("ply_2", test::make_faulty_vumat(500, test::kNeverReturns, 1e-4));
  for (const std::vector<std::string>& more : {std::vector<std::string>{}, {"--in-process", "--overwrite"}}) {
    const auto program = start("out", {law, "exchange.wait_deadline=2"}, more);
    EXPECT_EQ(program->wait(), 4);
    EXPECT_THAT(program->said(), HasSubstr("ply_2"));
  }
}

TEST_F(OwnLaw, LawThatLeavesWithCodeZeroIsALossByName) {
  const auto program = start("out", {set_law("ply_2", test::make_faulty_vumat(500, test::kExitAtOnce, 1e-4))});
  EXPECT_EQ(program->wait(), 4);
  EXPECT_THAT(program->said(), AllOf(HasSubstr("ply_2 (process"), HasSubstr("left with exit code 0"),
                                     HasSubstr("no convergence of the return mapping")));
}

TEST_F(OwnLaw, LawThatEndsItsProcessAtOnceIsRefusedByEveryCommand) {
  const auto law = test::make_faulty_vumat(500, test::kStop, 1e-6);
  const auto expect_refusal = [](Program& program) {
    EXPECT_EQ(program.wait(), 2);
    EXPECT_THAT(program.said(), AllOf(HasSubstr("law.vumat.library: "), HasSubstr("libfaulty.so ended"),
                                      HasSubstr("no convergence of the return mapping")));
  };
  expect_refusal(*start("out", {set_law("ply_2", law)}));
  EXPECT_FALSE(fs::exists(folder_.path() / "out"));
  Program check("interply", {"check", kScenes / "flat_stack.yaml", "--set", set_law("ply_2", law)}, folder_.path());
  expect_refusal(check);
  std::ofstream(folder_.path() / "law.yaml") << "law: {vumat: {library: " << law.library.path
                                             << ", parameters: [500, 3, 1e-6], state_variables: 0}}\n";
  std::ofstream(folder_.path() / "path.csv") << "F11,F12,F21,F22\n1.001,0,0,1\n";
  Program point("interply",
                {"point", folder_.path() / "law.yaml", "--path", folder_.path() / "path.csv", "-o",
                 folder_.path() / "out.csv"},
                folder_.path());
  expect_refusal(point);
  EXPECT_FALSE(fs::exists(folder_.path() / "out.csv"));
}

}  // namespace
}  // namespace interply::faults
