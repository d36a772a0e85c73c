/// Blanks that a scene takes from files.
#include "scene/meshes.hpp"

#include <gmock/gmock.h>
#include <unistd.h>

#include <filesystem>

#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with meshes of a rectangle of 400 x 400 mm and of its half, 100 mm quadrilaterals.
class BlankFiles : public testing::Test {
 protected:
  BlankFiles() {
    std::string path = testing::TempDir() + "interply-blanks-XXXXXX";
    folder_ = mkdtemp(path.data());
    write("half.inp", make_grid(0, 4));
    write("full.inp", make_grid(-2, 8));
  }
  ~BlankFiles() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }
  static std::string make_grid(int first_row, int rows, double scale = 1) {
    std::string nodes = "*NODE\n", elements = "*ELEMENT, TYPE=S4, ELSET=all\n", left = "*ELSET, ELSET=left\n";
    for (int j = 0; j <= rows; ++j)
      for (int i = 0; i <= 4; ++i)
        nodes += std::to_string(5 * j + i + 1) + ", " + std::to_string(scale * 100 * (i - 2)) + ", " +
                 std::to_string(scale * (first_row * 100 + 50 * j)) + "\n";
    for (int j = 0; j < rows; ++j)
      for (int i = 0; i < 4; ++i) {
        const int a = 5 * j + i + 1, e = 4 * j + i + 1;
        elements += std::to_string(e) + ", " + std::to_string(a) + ", " + std::to_string(a + 1) + ", " +
                    std::to_string(a + 6) + ", " + std::to_string(a + 5) + "\n";
        if (i < 2) left += std::to_string(e) + ",\n";
      }
    return nodes + elements + left;
  }
  /// The small scene with a blank from a file, read from a scene file in the folder.
  Scene read(const std::string& blank, const std::vector<std::string>& overrides = {}) const {
    write("scene.yaml", "blank: " + blank + "\n" + kSmallScene);
    return read_scene(folder_ / "scene.yaml", overrides);
  }
  std::string refuse(const std::string& blank, const std::vector<std::string>& overrides = {}) const {
    try {
      read(blank, overrides);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  }
  std::string in_folder(const std::string& name) const { return (folder_ / name).string(); }

  fs::path folder_;
};

TEST_F(BlankFiles, ArePathsFromTheSceneFileAndStandInTheResolvedSceneWithTheirDigest) {
  const Scene scene = read("{mesh: {file: half.inp, set: all}}");
  ASSERT_TRUE(scene.blank.mesh);
  EXPECT_EQ(scene.blank.mesh->file.path, in_folder("half.inp"));
  EXPECT_EQ(scene.blank.mesh->file.digest.size(), 16u);
  EXPECT_EQ(scene.text.find("mesh_size"), std::string::npos);
  const Scene again = parse_scene(scene.text, "somewhere/else.yaml");
  EXPECT_EQ(again.text, scene.text);
  EXPECT_EQ(again.digest, scene.digest);
  EXPECT_EQ(read_mesh_of(again, 0)->triangles.size(), 32u);
  EXPECT_FALSE(read_mesh_of(parse_scene(kSmallScene, "a"), 0));
}

TEST_F(BlankFiles, AChangedFileIsAnotherScene) {
  const Scene scene = read("{mesh: {file: half.inp}}");
  write("half.inp", make_grid(0, 4) + "** a remark\n");
  EXPECT_NE(read("{mesh: {file: half.inp}}").digest, scene.digest);
  try {
    read_mesh_of(scene, 1);
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("blank.mesh.file: " + in_folder("half.inp") + " has changed"));
  }
}

/// A file without others has the digest of its content; with others, it has that of all of them.
TEST_F(BlankFiles, AChangedIncludedFileIsAnotherScene) {
  const std::string grid = make_grid(0, 4);
  const std::size_t cut = grid.find("*ELEMENT");
  fs::create_directory(folder_ / "parts");
  write("parts/nodes.inp", grid.substr(0, cut));
  write("main.inp", "*INCLUDE, INPUT=parts/nodes.inp\n" + grid.substr(cut));
  const Scene scene = read("{mesh: {file: main.inp, set: all}}");
  EXPECT_EQ(read_mesh_of(scene, 0)->points, read_mesh_of(read("{mesh: {file: half.inp}}"), 0)->points);
  write("parts/nodes.inp", grid.substr(0, cut) + "** a remark\n");
  EXPECT_NE(read("{mesh: {file: main.inp, set: all}}").digest, scene.digest);
  try {
    read_mesh_of(scene, 0);
    FAIL();
  } catch (const SceneError& error) {
    EXPECT_THAT(error.what(), HasSubstr("blank.mesh.file: " + in_folder("main.inp") + " has changed"));
  }
  fs::remove(folder_ / "parts/nodes.inp");
  EXPECT_THAT(refuse("{mesh: {file: main.inp}}"), HasSubstr("main.inp:1: includes 'parts/nodes.inp', but " +
                                                            in_folder("parts/nodes.inp") + ": there is no such file"));
}

TEST_F(BlankFiles, ARectangleAndAMeshExcludeEachOther) {
  EXPECT_THAT(refuse("{mesh: {file: half.inp}, length: 280, mesh_size: 5}"),
              testing::AllOf(HasSubstr("blank.length: and blank.mesh are both given; keep one of them"),
                             HasSubstr("blank.mesh_size: and blank.mesh are both given; keep one of them")));
  EXPECT_THAT(refuse("{mesh: {set: all}}"), HasSubstr("blank.mesh.file: is required and has no default"));
  EXPECT_THAT(refuse("{mesh: half.inp}"), HasSubstr("blank.mesh: must be a block of keys"));
}

TEST_F(BlankFiles, UnusableOnesAreRefusedInOneSentence) {
  const std::string at = in_folder("scene.yaml") + ":1: blank.mesh.file: ";
  EXPECT_EQ(refuse("{mesh: {file: haf.inp}}"),
            at + in_folder("haf.inp") + ": there is no such file; did you mean 'half.inp'?");
  EXPECT_EQ(refuse("{mesh: {file: half.inp, set: al}}"),
            at + in_folder("half.inp") + ": has no element set 'al'; did you mean 'all'?");
  EXPECT_EQ(
      refuse("{mesh: {file: full.inp}}"),
      at + in_folder("full.inp") +
          ": the node at (-200, -200) mm lies at y < 0; a half model holds y >= 0 only: cut the mesh at y = 0, or "
          "take the whole blank with symmetry: full");
  EXPECT_EQ(refuse("{mesh: {file: full.inp}, symmetry: full}"), "");
  write("metres.inp", make_grid(0, 4, 1e-3));
  EXPECT_THAT(refuse("{mesh: {file: metres.inp}}"),
              HasSubstr("mm; it is only 0.4 mm large: if it was drawn in metres, scale it by 1000"));
  EXPECT_EQ(refuse("{mesh: {file: half.inp, set: left}}"), at +
                                                               "the mesh does not reach around opening and shoulder of "
                                                               "tools.die, at (89.6133, 2.78898) mm; the openings are "
                                                               "centred on the origin");
}

TEST_F(BlankFiles, ALayerHasItsOwnMesh) {
  const Scene files = read("{mesh: {file: half.inp}}", {"layers.ply_1.mesh={file: half.inp, set: all}"});
  EXPECT_TRUE(files.layers[1].mesh);
  EXPECT_EQ(read_mesh_of(files, 1)->triangles.size(), 32u);
  const Scene sizes = read("{mesh_size: 4}", {"layers.ply_1.mesh_size=7"});
  EXPECT_EQ(sizes.layers[1].mesh_size, 7);
  EXPECT_EQ(parse_scene(sizes.text, "a").layers[1].mesh_size, 7);
  EXPECT_THAT(refuse("{mesh_size: 4}", {"layers.ply_1.mesh_size=140"}), HasSubstr("140 is not below 140 mm"));
  EXPECT_THAT(refuse("{mesh: {file: half.inp}}", {"layers.ply_1.mesh_size=7"}),
              HasSubstr("layers[1].mesh_size: needs a rectangular blank; give this layer a mesh of its own"));
  EXPECT_THAT(refuse("{mesh_size: 4}", {"layers.ply_1.mesh={file: half.inp}", "layers.ply_1.mesh_size=7"}),
              HasSubstr("layers[1].mesh_size: and mesh are both given"));
}

TEST_F(BlankFiles, AMeshAcrossTheFibresIsWarnedOf) {
  EXPECT_TRUE(find_warnings(read("{mesh: {file: full.inp}, symmetry: full}")).empty());
  const auto turned = find_warnings(read("{mesh: {file: full.inp}, symmetry: full}", {"layers.ply_1.orientation=30"}));
  ASSERT_EQ(turned.size(), 1u);
  EXPECT_THAT(turned[0], HasSubstr("layers[1].orientation: 100 % of the mesh has no sides along both fibres"));
}

}  // namespace
}  // namespace interply::scene
