#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <functional>
#include <sstream>

#include "coordinator/quantity.hpp"
#include "coordinator/scripted_link.hpp"
#include "coordinator/verdict.hpp"
#include "support/own_tools.hpp"

namespace {

using namespace interply;
using namespace interply::coordinator;
using testing::HasSubstr;
using testing::Not;

TEST(ProgressLine, SaysStrokeStepIncrementTimeLeftAndResidual) {
  const std::string line = format_progress({.step = 1234,
                                            .time = 2.5e-3,
                                            .end_time = 16e-3,
                                            .dt = 4.04e-7,
                                            .stroke = 12.3,
                                            .punch_force = 1500,
                                            .residual = -0.0004,
                                            .seconds_left = 42.4});
  for (const auto* part : {"12.3 mm", "1234", "2.500/16.000 ms", "4.04e-07 s", "1.50 kN", "-0.040 %"})
    EXPECT_THAT(line, HasSubstr(part));
  EXPECT_THAT(line, testing::StartsWith("left    42 s  stroke  12.3 mm  punch 1.50 kN"));
  EXPECT_LT(line.find("% "), 80);  // all but step, increment and time fits a terminal of 80 columns
  EXPECT_THAT(line, Not(HasSubstr("waiting")));
  EXPECT_THAT(line, Not(HasSubstr("\n")));
}

TEST(ProgressLine, SaysWhoIsWaitedForAndNoUnknownTime) {
  const std::string line = format_progress({.seconds_left = -1, .waiting_for = "ply_2"});
  EXPECT_THAT(line, HasSubstr("waiting for ply_2"));
  EXPECT_THAT(line, Not(HasSubstr("left")));
}

TEST(ProgressLine, LongTimesAreInHours) { EXPECT_THAT(format_progress({.seconds_left = 3725}), HasSubstr("1:02:05")); }

/// A scripted run to its end, every layer with these words of its own.
void run_to_the_end(test::ScriptedRun& run, const std::function<exchange::Final(int who)>& make_final) {
  scene::Scene scene = test::read_flat_stack({"motion.forming_time=2e-5", "tools.blank_holder.ramp=1e-5"});
  scene.time.energy_limit = 1e9;
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  link.on_answer = [&](int who, const exchange::Force& force) {
    if (!force.last) return link.answer(who, force);
    link.push({.kind = exchange::Event::Kind::Ended, .who = who, .final = make_final(who)});
  };
  run.run(scene, link);
}

/// What python's json reads: a line "path value" for every leaf, sorted.
std::string read_with_python(const std::string& json) {
  const auto file = std::filesystem::path(testing::TempDir()) / ("summary_" + std::to_string(getpid()) + ".json");
  std::ofstream(file) << json;
  const std::string program =
      "import json, sys\n"
      "def walk(path, x):\n"
      "    items = x.items() if isinstance(x, dict) else enumerate(x) if isinstance(x, list) else None\n"
      "    if items is None: print(path, x)\n"
      "    else: [walk(path + \"/\" + str(k), v) for k, v in items]\n"
      "walk(\"\", json.load(open(sys.argv[1])))\n";
  const std::string command = "python3 -c '" + program + "' '" + file.string() + "' 2>&1";
  std::string text;
  FILE* pipe = popen(command.c_str(), "r");
  std::array<char, 256> buffer;
  while (pipe && fgets(buffer.data(), buffer.size(), pipe)) text += buffer.data();
  EXPECT_EQ(pclose(pipe), 0) << text;
  std::filesystem::remove(file);
  return text;
}

TEST(Summary, JsonHoldsEveryNumberOfTheTextWithItsUnit) {
  test::ScriptedRun run;
  run_to_the_end(run, [](int who) {
    return exchange::Final{.digest = 1, .summary = {{"shear angle \"up\" to", "deg", 12.5 + who}, {"count", "-", 3}}};
  });
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_EQ(run.sink.end.summary, run.outcome.summary_json);
  const std::string leaves = read_with_python(run.outcome.summary_json);
  const char* const expected[] = {"/interply 0.1.0\n",
                                  "/scene flat_stack\n",
                                  "/modelled_part half model\n",
                                  "/stroke/value 0",
                                  "/stroke/unit mm\n",
                                  "/time/value 0.03",
                                  "/time/unit ms\n",
                                  "/steps/unit -\n",
                                  "/wall_time/unit s\n",
                                  "/element_steps_per_second/unit 1/s\n",
                                  "/layers/0/name sheet_lower\n",
                                  "/layers/0/kind metal\n",
                                  "/layers/2/name ply_2\n",
                                  "/layers/2/kind fabric\n",
                                  "/layers/2/items/0/name shear angle \"up\" to\n",
                                  "/layers/2/items/0/quantity/value 14.5\n",
                                  "/layers/2/items/0/quantity/unit deg\n",
                                  "/layers/4/items/1/quantity/value 3",
                                  "/layers/0/draw_in/minus_x/value 0",
                                  "/layers/0/draw_in/plus_x/unit mm\n",
                                  "/layers/0/draw_in/plus_y/unit mm\n",
                                  "/layers/0/draw_in/largest/value 0",
                                  "/layers/0/kinetic_to_internal/unit %\n",
                                  "/punch_force/value 0",
                                  "/punch_force/unit kN\n",
                                  "/blank_holder/target/value 61.25",
                                  "/blank_holder/force/unit kN\n",
                                  "/blank_holder/mean_deviation/unit %\n",
                                  "/blank_holder/largest_deviation/unit %\n",
                                  "/energy/external/unit mJ\n",
                                  "/energy/thinning/unit mJ\n",
                                  "/energy/internal/unit mJ\n",
                                  "/energy/kinetic/unit mJ\n",
                                  "/energy/contact/unit mJ\n",
                                  "/energy/friction/unit mJ\n",
                                  "/energy/damping/unit mJ\n",
                                  "/energy/residual/unit %\n",
                                  "/energy/largest_residual/unit %\n",
                                  "/penetration/percentile_99/unit %\n",
                                  "/penetration/peak/unit %\n"};
  for (const char* leaf : expected) EXPECT_THAT(leaves, HasSubstr(leaf));
  EXPECT_THAT(leaves, HasSubstr("/digest " + run.outcome.digest));
  EXPECT_THAT(leaves, HasSubstr(fmt::format("/steps/value {}", run.outcome.measures.steps)));
}

TEST(Summary, OneSentencePerPassedLimitSaysWhoWhatWhereAndWhen) {
  test::ScriptedRun run;
  run_to_the_end(run, [](int who) {
    exchange::Final final{.digest = 1};
    if (who == 4)
      final.outside_trust = {{.quantity = "thinning",
                              .unit = "%",
                              .meaning = "it necks",
                              .limit = 25,
                              .worst = 54.2,
                              .share = 0.031,
                              .x = 10,
                              .y = 5,
                              .first_time = 2e-5}};
    return final;
  });
  EXPECT_EQ(run.outcome.exit_code, 0);
  EXPECT_THAT(
      run.outcome.summary,
      HasSubstr("  warning: sheet_upper: thinning beyond 25 % in 3.1 % of its area, from 0.0 mm stroke on, up to "
                "54.2 % at (10.0, 5.0) mm of the flat blank: it necks\n"));
  const std::string leaves = read_with_python(run.outcome.summary_json);
  for (const char* leaf : {"/layers/4/outside_trust/0/quantity thinning\n", "/layers/4/outside_trust/0/limit/value 25",
                           "/layers/4/outside_trust/0/worst/value 54.2\n",
                           "/layers/4/outside_trust/0/area_share/value 3.1\n", "/layers/4/outside_trust/0/x/value 10",
                           "/layers/4/outside_trust/0/first_time/value 0.02", " sheet_upper: thinning beyond 25 %"})
    EXPECT_THAT(leaves, HasSubstr(leaf));
  EXPECT_THAT(leaves, Not(testing::ContainsRegex("/warnings/[0-9]+ (sheet_lower|ply_[123]): ")));
}

TEST(Summary, NamesEveryLayerWithItsNumbersForcesEnergiesAndPenetration) {
  test::ScriptedRun run;
  run_to_the_end(run, [](int who) {
    return exchange::Final{.digest = 1, .summary = {{"shear angle up to", "deg", 12.5 + who}, {"count", "-", 3}}};
  });
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  for (const auto* part : {"flat_stack", "sheet_lower", "ply_2", "fabric", "metal", "shear angle up to 14.5 deg",
                           "count 3", "draw-in at -x, +x, +y 0.0 0.0 0.0, rim up to 0.0 mm\n",
                           "punch force 0.000 kN (half model)", "target 61.253 kN", "energy (mJ)", "penetration"})
    EXPECT_THAT(run.outcome.summary, HasSubstr(part));
  EXPECT_THAT(run.outcome.summary, Not(HasSubstr("digest")));
}

/// A pin between the nodes of layers that stay where they are, flat on each other: nothing is ever pressed.
TEST(Summary, SaysWhatNeverTouched) {
  const test::OwnTools tools(4);
  test::Soup pin = test::make_box({4, 4, 40});
  for (test::Vector3& x : pin) x += test::Vector3(10, 10, 0);
  tools.write("punch", pin);
  std::vector<std::string> overrides{"blank.mesh_size=20", "motion.forming_time=2e-5", "tools.blank_holder.ramp=1e-5",
                                     "motion.stroke=15"};
  for (const std::string& override : tools.overrides({"punch"})) overrides.push_back(override);
  scene::Scene scene = test::read_flat_stack(overrides);
  scene.time.energy_limit = 1e9;
  test::ScriptedLink link(scene);
  link.everyone_joins_and_moves();
  test::ScriptedRun run;
  run.run(scene, link);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_THAT(run.outcome.summary, HasSubstr("the punch never touched "));
  EXPECT_THAT(run.outcome.summary, HasSubstr("ply_1 and ply_2 never touched: no pressure between them"));
  EXPECT_THAT(run.outcome.summary, Not(HasSubstr("blank holder never touched")));  // it has come down on the stack
}

TEST(Verdict, NamesEachThatNeverTouchedAndAMissingPunch) {
  scene::Scene scene = test::read_flat_stack();
  std::vector<bool> touched(scene.layers.size() + 2, true);
  EXPECT_TRUE(list_untouched(scene, touched, 9).empty());
  touched.front() = touched.back() = false;
  EXPECT_THAT(list_untouched(scene, touched, 9),
              testing::ElementsAre(HasSubstr("the die never touched sheet_lower: its force was 0 in all 9 steps"),
                                   HasSubstr("the punch never touched sheet_upper: its force was 0 in all 9 steps")));
  scene.tools.punch.reset();
  scene.motion.stroke = 60;
  EXPECT_THAT(list_untouched(scene, std::vector<bool>(scene.layers.size() + 1, true), 9),
              testing::ElementsAre(HasSubstr("there was no punch")));
}

/// A summary of two layers in which everything is fine.
summary::Summary make_fine() {
  summary::Summary s;
  const auto add = [&](const char* name, const char* item, double value) {
    summary::Layer& layer = *s.add_layers();
    layer.set_name(name);
    layer.add_items()->set_name(item);
    set(layer.mutable_items(0)->mutable_quantity(), value, "%");
  };
  add("ply", "fibre strain up to", 1);
  add("sheet", "thinning up to", 24.9);
  set(s.mutable_inertia()->mutable_share(), 5, "%");
  set(s.mutable_inertia()->mutable_time(), 4, "ms");
  set(s.mutable_penetration()->mutable_percentile_99(), 5, "%");
  set(s.mutable_penetration()->mutable_peak(), 99, "%");
  set(s.mutable_energy()->mutable_largest_residual(), 1, "%");
  return s;
}

/// All six verdicts: state and sentence of one.
summary::Verdict judge_one(summary::Summary s, const std::string& name,
                           const std::vector<std::string>& untouched = {}) {
  scene::Scene scene;
  scene.motion.forming_time = 10e-3;
  judge(scene, untouched, s);
  EXPECT_EQ(s.verdicts_size(), 6);
  for (const summary::Verdict& verdict : s.verdicts())
    if (verdict.name() == name) return verdict;
  ADD_FAILURE() << name;
  return {};
}

void add_outside(summary::Layer& layer, const std::string& quantity, double limit, double share) {
  summary::OutsideTrust& passed = *layer.add_outside_trust();
  passed.set_quantity(quantity);
  passed.set_meaning("it breaks");
  set(passed.mutable_limit(), limit, "%");
  set(passed.mutable_area_share(), share, "%");
}

TEST(Verdict, EachIsFineUpToItsLimit) {
  for (const char* name : {"inertia", "thinning", "penetration", "energy", "trust", "contact"})
    EXPECT_EQ(judge_one(make_fine(), name).state(), summary::Verdict::FINE) << name;
  EXPECT_EQ(judge_one(make_fine(), "thinning").sentence(), "sheet by up to 24.9 %");
}

/// Inertia goes with the square of the speed: four times the share takes twice the time.
TEST(Verdict, InertiaNamesTheFormingTimeThatWouldDo) {
  summary::Summary s = make_fine();
  set(s.mutable_inertia()->mutable_share(), 20, "%");
  const summary::Verdict verdict = judge_one(s, "inertia");
  EXPECT_EQ(verdict.state(), summary::Verdict::LOOK);
  EXPECT_THAT(verdict.sentence(), HasSubstr("at most 20 % of the work was kinetic energy, limit 5 %, at 4 ms"));
  EXPECT_THAT(verdict.sentence(), HasSubstr("motion.forming_time: 0.02 would do"));
  s.clear_inertia();
  EXPECT_EQ(judge_one(s, "inertia").state(), summary::Verdict::NOT_JUDGED);
}

TEST(Verdict, BeyondItsLimitEachIsASentence) {
  summary::Summary s = make_fine();
  set(s.mutable_penetration()->mutable_percentile_99(), 5.1, "%");
  EXPECT_THAT(judge_one(s, "penetration").sentence(), HasSubstr("raise contact.reference_pressure"));
  set(s.mutable_penetration()->mutable_peak(), 101, "%");
  EXPECT_THAT(judge_one(s, "penetration").sentence(), HasSubstr("has gone through another"));
  s.clear_penetration();
  EXPECT_EQ(judge_one(s, "penetration").state(), summary::Verdict::NOT_JUDGED);
  set(s.mutable_energy()->mutable_largest_residual(), 1.1, "%");
  EXPECT_EQ(judge_one(s, "energy").state(), summary::Verdict::LOOK);
  EXPECT_EQ(judge_one(s, "contact", {"a never touched b", "c never touched d"}).sentence(),
            "a never touched b; c never touched d");
}

/// Thinning has a verdict of its own; of the others the widest is named.
TEST(Verdict, TrustNamesTheWidestOfWhatIsOutside) {
  summary::Summary s = make_fine();
  add_outside(*s.mutable_layers(1), "thinning", 25, 90);
  EXPECT_EQ(judge_one(s, "trust").state(), summary::Verdict::FINE);
  EXPECT_EQ(judge_one(s, "thinning").sentence(), "sheet by up to 24.9 %, limit 25 %: it breaks");
  add_outside(*s.mutable_layers(0), "fibre strain", 4.8, 20);
  add_outside(*s.mutable_layers(0), "fibre compression", 0.6, 35);
  EXPECT_THAT(
      judge_one(s, "trust").sentence(),
      HasSubstr("1 layer is outside what the law is made for, most of all ply: fibre compression beyond 0.6 % in "
                "35 % of its area"));
}

TEST(Summary, EndsWithTheVerdictsAndKeepsEightyColumns) {
  test::ScriptedRun run;
  run_to_the_end(run, [](int) {
    exchange::Final final{.digest = 1};
    for (int i = 0; i < 7; ++i) final.summary.push_back({"a number that is long enough", "MPa", 12.5});
    return final;
  });
  EXPECT_THAT(run.outcome.summary, HasSubstr("\n  inertia      not judged: no punch has moved\n"));
  EXPECT_THAT(run.outcome.summary, HasSubstr("\n  energy       fine: residual of the balance at most "));
  std::istringstream text(run.outcome.summary.substr(0, run.outcome.summary.find("  inertia")));
  for (std::string line; std::getline(text, line);) EXPECT_LE(line.size(), 80u) << line;
}

}  // namespace
