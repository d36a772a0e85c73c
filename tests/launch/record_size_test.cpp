#include "launch/record_size.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "launch/layer_factories.hpp"
#include "launch/run.hpp"
#include "paths.hpp"
#include "scene/read_scene.hpp"

namespace interply::launch {
namespace {

namespace fs = std::filesystem;

/// What is said before the run.
std::uint64_t measure(const fs::path& file, const std::vector<std::string>& overrides) {
  const scene::Scene scene = scene::read_scene(file, overrides);
  coordinator::Stack stack(scene);
  stack.begin_step();
  std::vector<std::unique_ptr<solve::LayerMechanics>> layers;
  for (int i = 0; i < stack.n_layers(); ++i) {
    const mechanics::TriangleMesh& mesh = stack.layer(i).mesh;
    layers.push_back(find_layer_factory(scene.layers[static_cast<std::size_t>(i)].kind())(scene, i, mesh));
    stack.take_motion(i, mesh.reference, {}, 1e-6);
    stack.compute_contact_of(i, 0);
  }
  return measure_record(scene, layers, stack);
}

TEST(RecordSize, IsThatOfTheFilesOfARun) {
  const fs::path source = INTERPLY_SOURCE_DIR, folder = fs::path(testing::TempDir()) / "record_size";
  for (const char* name : {"deploy/scenes/tetrahedron_fml_coarse.yaml", "deploy/scenes/tetrahedron_fabric_coarse.yaml",
                           "tests/scenes/flat_stack.yaml"}) {  // the last one has no punch
    for (const char* frames : {"record.frames=3", "record.frames=40"}) {
      fs::remove_all(folder);
      const std::vector<std::string> overrides{frames, "motion.forming_time=1e-5", "motion.stroke=0.01",
                                               "tools.blank_holder.ramp=1e-5"};
      ASSERT_EQ(run_command(
                    {.scene = source / name, .overrides = overrides, .out = folder, .in_process = true, .quiet = true}),
                kDone);
      const auto written =
          static_cast<double>(fs::file_size(folder / "record.h5") + fs::file_size(folder / "record.xdmf"));
      EXPECT_NEAR(static_cast<double>(measure(source / name, overrides)), written, 0.01 * written)
          << name << ' ' << frames;
    }
  }
  EXPECT_EQ(measure(source / "tests/scenes/flat_stack.yaml", {"record.frames=0"}), 0u);
  fs::remove_all(folder);
}

}  // namespace
}  // namespace interply::launch
