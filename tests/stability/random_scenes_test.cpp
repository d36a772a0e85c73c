/// Any scene that the checks accept either finishes inside its energy limit or stops with a named cause.
///
/// Scenes are drawn over the allowed ranges, with a bias to what somebody might form, though fast. By hand, some
/// hundreds:
///     INTERPLY_RANDOM_SCENES=300 INTERPLY_RANDOM_SEED=1000 stability_tests --gtest_filter='RandomScenes.*'
/// prints a line per scene; INTERPLY_RANDOM_SCENES=1 and a seed prints that scene, too, to be run as a file.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <cmath>
#include <cstdlib>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "support/in_process_run.hpp"

namespace {

using namespace interply;

/// The same numbers with every standard library, unlike its distributions.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : bits_(seed) { bits_.discard(8); }
  double between(double low, double high) { return low + (high - low) * 0x1p-53 * static_cast<double>(bits_() >> 11); }
  /// Evenly over the orders of magnitude.
  double order(double low, double high) { return low * std::pow(high / low, between(0, 1)); }
  int whole(int low, int high) { return low + static_cast<int>(bits_() % static_cast<std::uint64_t>(high - low + 1)); }
  bool chance(double p) { return between(0, 1) < p; }
  template <typename T>
  T one_of(const std::vector<T>& choices) {
    return choices[static_cast<std::size_t>(whole(0, static_cast<int>(choices.size()) - 1))];
  }

 private:
  std::mt19937_64 bits_;
};

/// A number for both fibre directions, or a pair.
template <typename Draw>
std::string draw_pair(Dice& dice, Draw draw) {
  const double warp = draw();
  return dice.chance(0.5) ? fmt::format("{:.4g}", warp) : fmt::format("[{:.4g}, {:.4g}]", warp, draw());
}

std::string draw_fabric(Dice& dice) {
  const auto pair = [&](auto draw) { return draw_pair(dice, draw); };
  const std::vector<std::string> variants{"fabric", "uncoupled", "full", "biaxial", "normal_shear"};
  std::string law = "variant: " + dice.one_of(variants);
  law += ", a: " + pair([&] { return dice.chance(0.1) ? 0 : dice.order(100, 1e5); });
  law += ", b: " + pair([&] { return dice.order(10, 1e3); });
  law += ", c: " + pair([&] { return dice.between(0, 75); });
  law += ", p_min: " + pair([&] { return dice.chance(0.2) ? 0 : dice.between(0, 1); });
  law += ", d: " + pair([&] { return dice.order(5, 300); });
  const double shear = dice.order(0.1, 10);
  law += fmt::format(", s: [{:.4g}, {:.4g}, {:.4g}]", 0.17 * shear, -0.53 * shear, 0.63 * shear);
  law += ", s_T: " + pair([&] { return dice.between(0, 500); });
  law += ", s_C: " + pair([&] { return dice.between(0, 2000); });
  if (dice.chance(0.5)) law += fmt::format(", strain_cap: {:.4g}", dice.between(0.01, 0.1));
  std::string layer = fmt::format("thickness: {:.4g}, density: {:.4g}", dice.between(0.3, 2), dice.order(2e-10, 2e-9));
  layer += ", orientation: " + dice.one_of<std::string>({"0", "0", "90", "45", "-45", "22.5"});
  layer += ", bending: " + pair([&] { return dice.chance(0.1) ? 0 : dice.order(0.1, 100); });
  return layer + ", law: {woven: {" + law + "}}";
}

std::string draw_metal(Dice& dice) {
  const double yield = dice.between(50, 400);
  const std::vector<std::string> hardening{
      fmt::format("swift: {{K: {:.4g}, e0: {:.4g}, n: {:.4g}}}", 2 * yield, dice.order(1e-3, 0.1),
                  dice.between(0, 0.5)),
      fmt::format("voce: {{s0: {:.4g}, s_inf: {:.4g}, rate: {:.4g}}}", yield, yield * dice.between(1, 3),
                  dice.between(0, 50)),
      fmt::format("hockett_sherby: {{s0: {:.4g}, s_inf: {:.4g}, rate: {:.4g}, n: {:.4g}}}", yield, 2 * yield,
                  dice.between(0, 20), dice.between(0.3, 1.2)),
      fmt::format("table: [[0, {:.4g}], [0.1, {:.4g}], [0.5, {:.4g}]]", yield, 1.5 * yield, 1.5 * yield)};
  return fmt::format("thickness: {:.4g}, density: {:.4g}, integration_points: {}", dice.between(0.3, 2),
                     dice.between(2e-9, 8e-9), dice.whole(1, 9)) +
         fmt::format(", law: {{j2: {{young: {:.4g}, poisson: {:.4g}, hardening: {{{}}}}}}}", dice.order(5e4, 2.2e5),
                     dice.between(0, 0.49), dice.one_of(hardening));
}

/// A scene in YAML. Not all that are drawn pass the checks.
std::string draw_scene(std::uint64_t seed) {
  Dice dice(seed);
  std::string text = fmt::format("name: random_{}\n", seed);
  text += fmt::format("blank: {{length: {:.4g}, width: {:.4g}, symmetry: {}, mesh_size: {:.4g}}}\nlayers:\n",
                      dice.between(240, 320), dice.between(230, 320), dice.chance(0.6) ? "half" : "full",
                      dice.between(18, 40));
  const int n_layers = dice.whole(1, 4);
  for (int i = 0; i < n_layers; ++i)
    text += fmt::format("  - {{name: layer_{}, {}}}\n", i, dice.chance(0.6) ? draw_fabric(dice) : draw_metal(dice));
  const double radius = dice.between(8, 20), offset = radius + dice.between(2, 12), shoulder = dice.between(3, 15);
  text += "tools:\n";
  if (dice.chance(0.75))
    text += fmt::format("  punch: {{edge: {:.4g}, height: {:.4g}, radius: {:.4g}}}\n", dice.between(80, 100),
                        dice.between(20, 80), radius);
  text += fmt::format("  die: {{offset: {:.4g}, shoulder: {:.4g}}}\n", offset, shoulder);
  text += fmt::format(
      "  blank_holder: {{offset: {:.4g}, shoulder: {:.4g}, pressure: {:.4g}, ramp: {:.4g}, mass_ratio: {:.4g}, "
      "damping: "
      "{:.4g}}}\n",
      offset, shoulder, dice.chance(0.1) ? 0 : dice.order(0.01, 10), dice.order(3e-5, 5e-4), dice.order(0.1, 30),
      dice.chance(0.2) ? 0 : dice.between(0, 1));
  text += fmt::format("motion: {{stroke: {:.4g}, forming_time: {:.4g}}}\n", dice.chance(0.1) ? 0 : dice.order(0.5, 80),
                      dice.order(1e-4, 2e-3));
  text += fmt::format(
      "contact: {{reference_pressure: {:.4g}, penetration: {:.4g}, damping: {:.4g}, tangential_stiffness: {:.4g}}}\n",
      dice.order(1, 100), dice.order(0.01, 0.05), dice.chance(0.2) ? 0 : dice.between(0, 0.5), dice.order(0.3, 3));
  text += "friction: {";
  for (const char* pair : {"tool_steel", "tool_fabric", "steel_fabric", "fabric_fabric", "steel_steel"})
    text += fmt::format("{}: {:.4g}, ", pair, dice.chance(0.1) ? 0 : dice.between(0, 1));
  text += fmt::format("}}\ntime: {{safety: {:.4g}, mass_scaling: {:.4g}, vote_every: {}}}\n", dice.between(0.5, 0.99),
                      dice.chance(0.7) ? 1 : dice.order(1, 10), dice.whole(1, 100));
  return text + "record: {frames: 4, history: 50}\n";
}

bool is_word_of_a_number_gone_wrong(const std::string& text) {
  return text.find("nan") != text.npos || text.find("inf") != text.npos;
}

/// All that was recorded is finite, and every node within a metre.
void expect_sound_record(const test::MemorySink& sink) {
  for (const auto& frame : sink.layers) {
    EXPECT_TRUE(frame.position.allFinite()) << frame.layer << " frame " << frame.frame;
    EXPECT_LT(frame.position.cwiseAbs().maxCoeff(), 1000) << frame.layer << " frame " << frame.frame << ", mm";
    for (const auto& field : frame.fields)
      for (const double value : field.values) {
        ASSERT_TRUE(std::isfinite(value)) << frame.layer << ' ' << field.name << " frame " << frame.frame;
        ASSERT_TRUE(field.name != "thickness" || value > 0) << frame.layer << " frame " << frame.frame;
      }
  }
  for (const auto& frame : sink.interfaces)
    for (const auto& field : frame.fields)
      for (const double value : field.values)
        ASSERT_TRUE(std::isfinite(value)) << frame.interface << ' ' << field.name << " frame " << frame.frame;
  for (const auto& row : sink.rows)
    for (const double value : {row.dt, row.kinetic, row.internal, row.contact, row.friction, row.damping, row.thinning,
                               row.external, row.residual, row.punch_force, row.blank_holder_force})
      ASSERT_TRUE(std::isfinite(value)) << "history, step " << row.step;
}

/// Who, what and what to do about it.
void expect_named_cause(const std::string& message) {
  using testing::AnyOf;
  using testing::HasSubstr;
  EXPECT_THAT(message, AnyOf(HasSubstr("layer "), HasSubstr("interface "), HasSubstr("blank holder")));
  EXPECT_THAT(message, AnyOf(HasSubstr("energy residual"), HasSubstr("shear angle"), HasSubstr("area ratio"),
                             HasSubstr("strain"), HasSubstr("thickness")));
  EXPECT_THAT(message, AnyOf(HasSubstr("lower "), HasSubstr("smaller "), HasSubstr("refine "), HasSubstr("raise ")));
}

/// Runs the scene of one seed if the checks accept it. @return whether they do
bool try_scene(std::uint64_t seed, bool talk) {
  const std::string text = draw_scene(seed);
  scene::Scene scene;
  try {
    scene = scene::parse_scene(text, "random.yaml");
  } catch (const scene::SceneError&) {
    return false;
  }
  SCOPED_TRACE("seed " + std::to_string(seed));
  const auto start = std::chrono::steady_clock::now();
  const test::InProcessResult run = test::run_in_process(scene);
  const coordinator::Outcome& outcome = run.outcome;
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - start;
  if (talk)
    std::cout << fmt::format("{} exit {} steps {} {:.1f} s residual {:.2e} penetration {:.2f}  {}\n", seed,
                             outcome.exit_code, outcome.measures.steps, seconds.count(),
                             outcome.measures.largest_residual, outcome.measures.penetration_peak, outcome.message)
              << std::flush;
  expect_sound_record(*run.sink);
  EXPECT_FALSE(is_word_of_a_number_gone_wrong(outcome.summary)) << outcome.summary;
  if (outcome.exit_code == 3) {
    expect_named_cause(outcome.message);
  } else {
    EXPECT_EQ(outcome.exit_code, 0) << outcome.message;
    EXPECT_LE(outcome.measures.largest_residual, scene.time.energy_limit);
    EXPECT_EQ(outcome.summary.find("has gone through another") != std::string::npos,
              outcome.measures.penetration_peak > 1);
    EXPECT_LE(std::abs(outcome.measures.final_residual), 2 * scene.time.energy_limit);  // its scale is that of the end
  }
  return true;
}

TEST(RandomScenes, FinishInsideTheEnergyLimitOrStopWithANamedCause) {
  const auto read = [](const char* name, int otherwise) {
    const char* value = std::getenv(name);
    return value ? std::atoi(value) : otherwise;
  };
  const int wanted = read("INTERPLY_RANDOM_SCENES", 20);
  const bool talk = std::getenv("INTERPLY_RANDOM_SCENES") != nullptr;
  std::uint64_t seed = static_cast<std::uint64_t>(read("INTERPLY_RANDOM_SEED", 1030));
  if (wanted == 1) std::cout << draw_scene(seed);
  for (int accepted = 0; accepted < wanted; ++seed) accepted += try_scene(seed, talk);
}

}  // namespace
