#include "exchange/admission.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "exchange/carriers.hpp"

namespace interply::exchange {
namespace {

using testing::HasSubstr;

class AdmissionTest : public testing::Test {
 protected:
  int admit(const std::string& layer) {
    const auto verdict = admission.judge(make_join(layer));
    EXPECT_EQ(verdict.refusal, "");
    return verdict.who;
  }
  Admission admission{kDigest, {{"sheet_lower", 10}, {"ply_1", 20}, {"ply_2", 5}}};
};

TEST_F(AdmissionTest, SeatsFollowTheScene) {
  EXPECT_EQ(admit("ply_2"), 2);
  EXPECT_EQ(admit("sheet_lower"), 0);
  EXPECT_TRUE(admission.is_active(2));
  EXPECT_FALSE(admission.is_active(1));
}

TEST_F(AdmissionTest, MotionsComeOnePerStepAndInOrder) {
  const int who = admit("ply_1");
  EXPECT_EQ(admission.judge_motion(who, 0, 20, 0), "");
  EXPECT_THAT(admission.judge_motion(who, 1, 20, 0), HasSubstr("step 0 is not answered"));
  EXPECT_TRUE(admission.note_answer(who, make_force(0, 20, 0)));
  EXPECT_THAT(admission.judge_motion(who, 0, 20, 0), HasSubstr("expected was step 1"));
  EXPECT_THAT(admission.judge_motion(who, 2, 20, 0), HasSubstr("expected was step 1"));
  EXPECT_EQ(admission.judge_motion(who, 1, 20, 20), "");
}

TEST_F(AdmissionTest, TheFirstMotionSetsTheFirstStepOfTheRun) {
  const int a = admit("ply_1"), b = admit("ply_2");
  EXPECT_NE(admission.judge_motion(a, -1, 20, 0), "");
  EXPECT_EQ(admission.judge_motion(a, 500, 20, 0), "");
  EXPECT_THAT(admission.judge_motion(b, 0, 5, 0), HasSubstr("expected was step 500"));
  EXPECT_EQ(admission.judge_motion(b, 500, 5, 0), "");
}

TEST_F(AdmissionTest, ArraysKeepTheSizeOfTheJoin) {
  const int who = admit("ply_1");
  EXPECT_THAT(admission.judge_motion(who, 0, 19, 0), HasSubstr("the scene gives it 20 nodes"));
  EXPECT_THAT(admission.judge_motion(who, 0, 20, 7), HasSubstr("7 thicknesses"));
}

TEST_F(AdmissionTest, FinalOnlyFollowsTheLastAnswer) {
  const int who = admit("ply_1");
  EXPECT_NE(admission.judge_final(who), "");
  EXPECT_EQ(admission.judge_motion(who, 0, 20, 0), "");
  EXPECT_TRUE(admission.note_answer(who, make_force(0, 20, 0, true)));
  EXPECT_NE(admission.judge_motion(who, 1, 20, 0), "");
  EXPECT_EQ(admission.judge_final(who), "");
  EXPECT_NE(admission.judge_final(who), "");
  EXPECT_FALSE(admission.note_gone(who)) << "leaving after the end is no loss";
}

TEST_F(AdmissionTest, LeavingBeforeTheEndIsALossOnce) {
  const int who = admit("ply_1");
  EXPECT_TRUE(admission.note_gone(who));
  EXPECT_FALSE(admission.note_gone(who));
  EXPECT_FALSE(admission.note_answer(who, make_force(0, 20, 0)));
}

TEST_F(AdmissionTest, LeavingWhenToldToIsNoLoss) {
  const int who = admit("ply_1");
  admission.close("cancelled");
  EXPECT_FALSE(admission.note_gone(who));
  EXPECT_THAT(admission.judge(make_join("ply_2")).refusal, HasSubstr("cancelled"));
}

TEST_F(AdmissionTest, ASolverOfAnotherKindIsToldWhichToStartAndTheSeatStaysFree) {
  Admission admission{kDigest, {{.layer = "ply_1", .n_nodes = 20, .kind = "fabric"}}};
  Join join = make_join("ply_1");
  join.kind = "metal";
  EXPECT_THAT(admission.judge(join).refusal, HasSubstr("start interply-solver-fabric for it"));
  join.kind = "fabric";
  EXPECT_EQ(admission.judge(join).who, 0);
}

TEST_F(AdmissionTest, TheHostOfAPeerIsOnePrintableLine) {
  Join join = make_join("ply_1");
  join.host = "node7\n@digest 0000000000000000\x1b[2J";
  const int who = admission.judge(join).who;
  EXPECT_EQ(admission.join(who).host, "node7\\x0a@digest 0000000000000000\\x1b[2J");
}

TEST_F(AdmissionTest, AWrongAnswerIsOurOwnMistake) {
  const int who = admit("ply_1");
  EXPECT_THROW(admission.note_answer(who, make_force(0, 20, 0)), std::logic_error);
  EXPECT_EQ(admission.judge_motion(who, 0, 20, 0), "");
  EXPECT_THROW(admission.note_answer(who, make_force(0, 20, 1)), std::logic_error);
  EXPECT_THROW(admission.note_answer(who, make_force(0, 19, 0)), std::logic_error);
  EXPECT_TRUE(admission.note_answer(who, make_force(0, 20, 0)));
  EXPECT_THROW(admission.note_answer(who, make_force(0, 20, 0)), std::logic_error);
}

TEST(RefusalLog, SaysOneLinePerPeerAndKindAndNotWithoutEnd) {
  const LogCapture log;
  RefusalLog refusals;
  for (int i = 0; i < 1000; ++i) refusals.warn("ply_1", "motion", "sent a motion of step " + std::to_string(i));
  EXPECT_EQ(log.count("\n"), 1);
  for (int i = 0; i < 1000; ++i) refusals.warn("stranger " + std::to_string(i), "malformed", "sent nonsense");
  EXPECT_LE(log.count("\n"), 210);
  EXPECT_EQ(log.count("not reported"), 1);
}

}  // namespace
}  // namespace interply::exchange
