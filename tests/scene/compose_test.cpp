/// A scene in several files: laws by path, overlays, keys for anchors.
#include <gmock/gmock.h>
#include <stdlib.h>

#include <filesystem>

#include "paths.hpp"
#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

/// A folder with `laws/`, an overlay and a scene in it.
class Compose : public testing::Test {
 protected:
  Compose() {
    std::string path = testing::TempDir() + "interply-compose-XXXXXX";
    folder_ = mkdtemp(path.data());
    fs::create_directories(folder_ / "laws");
    write("laws/steel.yaml", "j2: {young: 2e5, hardening: {voce: {s0: 200, s_inf: 300, rate: 10}}}\n");
    write("laws/weave.yaml", "law:\n  woven:\n    c: 33\n");
    write("scene.yaml", kSmallScene);
  }
  ~Compose() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& text) { std::ofstream(folder_ / name) << text; }
  Scene read(const std::vector<std::string>& overrides = {}, const std::vector<fs::path>& overlays = {}) {
    return read_scene(folder_ / "scene.yaml", overrides, overlays);
  }
  std::string refuse(const std::vector<std::string>& overrides = {}, const std::vector<fs::path>& overlays = {}) {
    try {
      read(overrides, overlays);
    } catch (const SceneError& error) {
      return error.what();
    }
    return "";
  }

  fs::path folder_;
};

const J2Law& sheet_of(const Scene& scene) { return std::get<J2Law>(scene.layers[0].law); }

TEST_F(Compose, ALawInAFileIsTheSameSceneAsWrittenOut) {
  write("scene.yaml", with("law: {j2: {}}", "law: {file: laws/steel.yaml}"));
  const Scene by_file = read();
  write("scene.yaml",
        with("law: {j2: {}}", "law: {j2: {young: 2e5, hardening: {voce: {s0: 200, s_inf: 300, rate: 10}}}}"));
  EXPECT_EQ(by_file.digest, read().digest);
  EXPECT_EQ(parse_scene(by_file.text, "resolved.yaml").digest, by_file.digest);
}

TEST_F(Compose, ALawIsSwappedOnTheCommandLineByItsFile) {
  const Scene scene = read({"layers.ply_1.law.file=laws/weave.yaml", "layers.ply_1.law.woven.variant=biaxial"});
  EXPECT_EQ(std::get<WovenLaw>(scene.layers[1].law).c.warp, 33);
  EXPECT_EQ(std::get<WovenLaw>(scene.layers[1].law).variant, Variant::Biaxial);
  EXPECT_EQ(read({"layers.ply_1.law.file=laws/steel.yaml"}).layers[1].kind(), Kind::Metal);
}

TEST_F(Compose, AnOverlayChangesOnlyWhatItHolds) {
  write("soft.yaml", "motion: {stroke: 7}\nlayers: {ply_1: {thickness: 0.5, law: {woven: {c: 12}}}}\n");
  const Scene plain = read(), scene = read({}, {folder_ / "soft.yaml"});
  EXPECT_EQ(scene.motion.stroke, 7);
  EXPECT_EQ(scene.motion.forming_time, plain.motion.forming_time);
  EXPECT_EQ(scene.layers[1].thickness, 0.5);
  EXPECT_EQ(scene.layers[1].density, plain.layers[1].density);
  EXPECT_EQ(std::get<WovenLaw>(scene.layers[1].law).c.warp, 12);
  EXPECT_EQ(scene.layers[0].thickness, plain.layers[0].thickness);
  EXPECT_EQ(read({"motion.stroke=8"}, {folder_ / "soft.yaml"}).motion.stroke, 8);  // --set goes after it
}

TEST_F(Compose, AnotherLawInAnOverlayReplacesTheFirst) {
  write("metal.yaml",
        "layers: {ply_1: {law: {j2: {}}}, sheet: {law: {j2: {hardening: {voce: {s0: 1, s_inf: 2, rate: 3}}}}}}");
  const Scene scene = read({}, {folder_ / "metal.yaml"});
  EXPECT_EQ(scene.layers[1].kind(), Kind::Metal);
  EXPECT_EQ(std::get<Voce>(sheet_of(scene).hardening).s_inf, 2);
}

TEST_F(Compose, PathsStartAtTheFileThatNamesThem) {
  fs::create_directories(folder_ / "other/laws");
  write("other/laws/steel.yaml", "j2: {young: 1.5e5}\n");
  write("other/over.yaml", "layers: {sheet: {law: {file: laws/steel.yaml}}}\n");
  EXPECT_EQ(sheet_of(read({}, {folder_ / "other/over.yaml"})).young, 1.5e5);
  EXPECT_EQ(sheet_of(read({"layers.sheet.law.file=laws/steel.yaml"})).young, 2e5);
  write("other/own.yaml", "vumat: {library: libown.so}\n");
  EXPECT_THAT(refuse({"layers.sheet.law.file=other/own.yaml"}), HasSubstr((folder_ / "other/libown.so").string()));
}

TEST_F(Compose, KeysForAnchorsMayStandAtTheTop) {
  write("scene.yaml", "x-steel: &steel {j2: {young: 1.9e5}}\n" + with("law: {j2: {}}", "law: *steel"));
  EXPECT_EQ(sheet_of(read()).young, 1.9e5);
  EXPECT_THAT(read().text, testing::Not(HasSubstr("x-steel")));
  write("scene.yaml", with("    law: {j2: {}}", "    x-note: 1\n    law: {j2: {}}"));
  EXPECT_THAT(refuse(), HasSubstr("layers[0].x-note: unknown key"));
}

TEST_F(Compose, WhatCannotBeIsSaidOnceWithItsPlace) {
  write("scene.yaml", with("law: {j2: {}}", "law: {file: laws/stel.yaml}"));
  const std::string said = refuse({"motion.stroke=1"});
  EXPECT_THAT(said, HasSubstr("scene.yaml:6: layers[0].law.file: " + (folder_ / "laws/stel.yaml").string() +
                              ": there is no such file"));
  EXPECT_EQ(said.find("there is no such file"), said.rfind("there is no such file"));
  write("scene.yaml", kSmallScene);
  EXPECT_EQ(refuse({"layers.ply_1.law.file=none.yaml"}), "--set layers.ply_1.law.file=none.yaml: layers[1].law.file: " +
                                                             (folder_ / "none.yaml").string() + ": there is no such file");
  write("scene.yaml", with("law: {j2: {}}", "law: {file: laws/steel.yaml, j2: {}}"));
  EXPECT_THAT(refuse(), HasSubstr("layers[0].law: holds j2, file; keep one of them"));
  write("laws/bad.yaml", "j2: {yung: 1}\n");
  write("scene.yaml", with("law: {j2: {}}", "law: {file: laws/bad.yaml}"));
  EXPECT_THAT(refuse(), HasSubstr("laws/bad.yaml:1: layers[0].law.j2.yung: unknown key; did you mean 'young'?"));
  write("laws/chain.yaml", "file: steel.yaml\n");
  write("scene.yaml", with("law: {j2: {}}", "law: {file: laws/chain.yaml}"));
  EXPECT_THAT(refuse(), HasSubstr("names a file that names another"));
  write("scene.yaml", kSmallScene);
  write("over.yaml", "layers: {ply_2: {thickness: 1}}\n");
  EXPECT_THAT(refuse({}, {folder_ / "over.yaml"}),
              HasSubstr("over.yaml:1: layers: holds no item named 'ply_2'; did you mean 'ply_1'?"));
  EXPECT_THAT(refuse({}, {folder_ / "none.yaml"}), HasSubstr("none.yaml: there is no such file"));
}

}  // namespace
}  // namespace interply::scene
