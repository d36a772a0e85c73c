/// What is recorded at an interface is what acts there: Coulomb's law, force and moment of both sides, resultants;
/// every frame, interface and node of small laminates.
#include <gtest/gtest.h>

#include <array>
#include <cmath>

#include "coordinator/stack.hpp"
#include "record/sample_run.hpp"
#include "record/writer.hpp"
#include "support/flat_meshes.hpp"
#include "support/in_process_run.hpp"
#include "support/own_tools.hpp"
#include "support/recorded_interface.hpp"

namespace {

using namespace interply;
using test::NodalVectors;
using test::RecordedInterface;
using test::Vector3;

Vector3 total(const NodalVectors& f) { return f.rowwise().sum().matrix(); }

/// Moment of nodal forces about a point, N mm.
Vector3 find_moment(const NodalVectors& position, const NodalVectors& force, const Vector3& about) {
  Vector3 sum = Vector3::Zero();
  for (Eigen::Index i = 0; i < force.cols(); ++i)
    sum += (mechanics::at(position, i) - about).cross(mechanics::at(force, i));
  return sum;
}

double sum_of_lengths(const NodalVectors& a) { return a.matrix().colwise().norm().sum(); }

/// |tau| <= mu p at every node, and nothing at all where the partner is not in front of it or the gap is open.
void expect_coulomb(const RecordedInterface& r, double friction) {
  for (Eigen::Index i = 0; i < r.pressure.size(); ++i) {
    const double traction = mechanics::at(r.traction, i).norm();
    ASSERT_GE(r.pressure(i), 0) << r.name << ' ' << r.frame << ' ' << i;
    ASSERT_LE(traction, friction * r.pressure(i) * (1 + 1e-12)) << r.name << ' ' << r.frame << ' ' << i;
    if (r.state(i) == 0 || r.state(i) == 3) ASSERT_EQ(r.pressure(i), 0) << r.name << ' ' << r.frame << ' ' << i;
  }
}

/// Forces on both sides are opposite, and so are their moments: about an axis across the symmetry plane in a half
/// model, whose missing half takes the rest; about all axes in a full one.
void expect_balance(const RecordedInterface& r, bool half) {
  const Vector3 here = total(r.force), there = total(r.other_force);
  EXPECT_LE((here + there).norm(), 1e-12 * std::max(here.norm(), there.norm())) << r.name << ' ' << r.frame;
  const Vector3 about(3, -5, 7);
  Vector3 on_other = r.tool_moment - about.cross(there);
  if (r.other_position.size() > 0) on_other = find_moment(r.other_position, r.other_force, about);
  const Vector3 sum = find_moment(r.position, r.force, about) + on_other;
  const double reach = (r.position.matrix().colwise() - about).colwise().norm().maxCoeff();
  const double scale = sum_of_lengths(r.force) * reach;
  EXPECT_LE(std::abs(sum.y()), 1e-12 * scale) << r.name << ' ' << r.frame;
  const double others = half ? 0 : sum.norm();
  EXPECT_LE(others, 1e-12 * scale) << r.name << ' ' << r.frame;
}

/// On a tool, pressure along the normal and traction add up to the force over the reference areas, and so do what acts
/// per current area over the current areas.
void expect_resultant(const RecordedInterface& r, bool below) {
  const double on_tool = below ? -1 : 1;  // traction is that on the upper partner
  const auto add_up = [&](const test::Scalars& pressure, const NodalVectors& traction, const test::Scalars& area) {
    NodalVectors nodal(3, area.size());
    for (int d = 0; d < 3; ++d)
      nodal.row(d) = (pressure.transpose() * r.normal.row(d) + on_tool * traction.row(d)) * area.transpose();
    return total(nodal);
  };
  const double tolerance = 1e-12 * sum_of_lengths(r.force);
  const Vector3 force = total(r.other_force);
  EXPECT_LE((add_up(r.pressure, r.traction, r.reference_area) - force).norm(), tolerance) << r.name << ' ' << r.frame;
  EXPECT_LE((add_up(r.true_pressure, r.true_traction, r.area) - force).norm(), tolerance) << r.name << ' ' << r.frame;
}

/// @return how many nodes of all frames touched, slid, and had no share of their partner
std::array<int, 3> expect_what_acts(const scene::Scene& scene, const test::MemorySink& sink) {
  std::array<int, 3> seen{};
  for (const RecordedInterface& r : test::read_interfaces(sink)) {
    expect_coulomb(r, coordinator::find_friction(scene, r.nodes_of, r.other));
    expect_balance(r, scene.blank.half);
    if (r.other_position.size() == 0) expect_resultant(r, r.other == "die");
    seen[0] += static_cast<int>((r.pressure > 0).count());
    seen[1] += static_cast<int>((r.state == 2).count());
    seen[2] += static_cast<int>((r.state == 3).count());
  }
  return seen;
}

std::vector<std::string> forming(std::vector<std::string> more) {
  std::vector<std::string> all{"motion.stroke=20", "motion.forming_time=3e-3", "record.frames=8"};
  all.insert(all.end(), more.begin(), more.end());
  return all;
}

TEST(RecordedForces, AreWhatActsInAHalfLaminate) {
  const scene::Scene scene = test::read_test_scene("flat_stack.yaml", forming({}));
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  const auto [touching, sliding, past] = expect_what_acts(scene, *run.sink);
  EXPECT_GT(touching, 1000);
  EXPECT_GT(sliding, 100);
}

/// [-a, a] x [-b, b]
geometry::FlatMesh make_rectangle(double a, double b, double h) {
  const mechanics::TriangleMesh mesh = mechanics::make_rectangle({-a, a}, {-b, b}, h);
  geometry::FlatMesh flat;
  for (Eigen::Index i = 0; i < mesh.n_nodes(); ++i)
    flat.points.push_back({mesh.reference(0, i), mesh.reference(1, i)});
  for (Eigen::Index e = 0; e < mesh.n_elements(); ++e)
    flat.triangles.push_back({mesh.triangles(0, e), mesh.triangles(1, e), mesh.triangles(2, e)});
  return flat;
}

/// Plies smaller than the sheets and of other meshes: many nodes of the lower sheet are past the edge of its partner.
TEST(RecordedForces, AreWhatActsOnOtherMeshesAndAtEdgesOfAFullLaminate) {
  const test::TemporaryFolder folder;
  std::vector<std::string> overrides{"blank.symmetry=full", "blank.mesh_size=25"};
  const double sizes[] = {17, 17, 21};
  for (int i = 0; i < 3; ++i) {
    const std::string name = "ply_" + std::to_string(i + 1), file = (folder / (name + ".inp")).string();
    test::write_inp(make_rectangle(115, 95, sizes[i]), file);
    overrides.push_back("layers." + name + ".mesh={file: " + file + "}");
  }
  const scene::Scene scene = test::read_test_scene("flat_stack.yaml", forming(overrides));
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  const auto [touching, sliding, past] = expect_what_acts(scene, *run.sink);
  EXPECT_GT(touching, 1000);
  EXPECT_GT(sliding, 100);
  EXPECT_GT(past, 100);
}

TEST(RecordedForces, AreWhatActsOnToolsFromStl) {
  const test::OwnTools tools(8);
  const scene::Scene scene = test::read_test_scene("flat_stack.yaml", forming(tools.overrides()));
  const auto run = test::run_in_process(scene);
  ASSERT_EQ(run.outcome.exit_code, 0) << run.outcome.message;
  EXPECT_GT(expect_what_acts(scene, *run.sink)[0], 1000);
}

/// Runs check_forces.py of tests/record. @return its exit status, 0 if all is well
int check_forces(const std::string& arguments) {
  const std::string script = INTERPLY_SOURCE_DIR "/tests/record/check_forces.py ";
  const int status = std::system(("/usr/bin/python3 " + script + arguments).c_str());
  return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
}

/// Laminate and plies alone as they are shipped, on a coarser mesh and with half the stroke: everything once more with
/// h5py, from the file, and the example of RECORD.md as it stands.
TEST(RecordedForces, OfShippedScenesAreWhatActsForWhoReadsTheFile) {
  for (const char* name : {"tetrahedron_fml_coarse.yaml", "tetrahedron_fabric_coarse.yaml"}) {
    const test::TemporaryFolder folder;
    const scene::Scene scene = test::read_shipped_scene(
        name, {"blank.mesh_size=20", "motion.stroke=30", "motion.forming_time=6e-3", "record.frames=6"});
    record::RecordWriter writer(folder / "record.h5");
    const auto outcome = test::run_in_process(scene, {}, writer);
    writer.close();
    ASSERT_EQ(outcome.exit_code, 0) << outcome.message;
    EXPECT_EQ(check_forces("record " + (folder / "record.h5").string()), 0) << name;
    if (scene.layers.size() < 5) continue;  // the example names the sheets
    EXPECT_EQ(check_forces("example " INTERPLY_SOURCE_DIR "/proto/RECORD.md " + folder.path().string()), 0);
  }
}

}  // namespace
