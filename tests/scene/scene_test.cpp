#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <memory>
#include <random>

#include "paths.hpp"
#include "scene.pb.h"
#include "scene/scene_test_support.hpp"

namespace interply::scene {
namespace {

using ::testing::HasSubstr;

const std::filesystem::path kSource = INTERPLY_SOURCE_DIR;

std::vector<std::filesystem::path> list_scenes() {
  std::vector<std::filesystem::path> files;
  for (const char* folder : {"deploy/scenes", "tests/scenes"})
    for (const auto& entry : std::filesystem::directory_iterator(kSource / folder))
      if (entry.path().extension() == ".yaml") files.push_back(entry.path());
  return files;
}

/// Reads `text` from a file interply_law.yaml in a folder of this process.
Law parse_law_file(const std::string& text) {
  const auto folder = std::filesystem::path(testing::TempDir()) / ("interply_law_" + std::to_string(getpid()));
  std::filesystem::create_directories(folder);
  std::ofstream(folder / "interply_law.yaml") << text;
  const auto remove = [](const std::filesystem::path* f) { std::filesystem::remove_all(*f); };
  const std::unique_ptr<const std::filesystem::path, decltype(remove)> cleanup(&folder, remove);
  return read_law(folder / "interply_law.yaml");
}

std::string refuse_law_file(const std::string& text) {
  try {
    parse_law_file(text);
  } catch (const SceneError& error) {
    const std::string said = error.what();
    return said.substr(said.find("interply_law.yaml"));
  }
  return "";
}

TEST(Law, ASceneInItsPlaceIsCalledOne) {
  EXPECT_EQ(refuse_law_file(kSmallScene),
            "interply_law.yaml: is a scene; a law file holds the `law` block of one layer, such as  j2: {}");
}

TEST(Scene, AMissingFileIsNamedWithANearOne) {
  const auto refuse = [](const std::filesystem::path& file) {
    try {
      read_scene(file);
    } catch (const SceneError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  const std::filesystem::path scenes = kSource / "deploy/scenes";
  EXPECT_EQ(
      refuse(scenes / "tetrahedron_fm.yaml"),
      (scenes / "tetrahedron_fm.yaml").string() + ": there is no such file; did you mean 'tetrahedron_fml.yaml'?");
  EXPECT_EQ(refuse(scenes / "cup.yaml"), (scenes / "cup.yaml").string() + ": there is no such file");
  EXPECT_THAT(refuse(scenes), HasSubstr("is a folder, not a file"));
}

TEST(Scene, AbsentKeysTakeTheDefaultsOfTheStructs) {
  const Scene scene = parse_scene("layers: [{name: ply, density: 1e-9, law: {woven: {}}}]", "scene.yaml");
  const WovenLaw& law = std::get<WovenLaw>(scene.layers[0].law);
  EXPECT_EQ(law.a.weft, WovenLaw{}.a.weft);
  EXPECT_EQ(law.s, WovenLaw{}.s);
  EXPECT_TRUE(std::isinf(law.strain_cap.warp));
  EXPECT_FALSE(law.tables);
  EXPECT_EQ(scene.layers[0].twist, 1.1);
  EXPECT_EQ(scene.tools.die.offset, Opening{}.offset);
  EXPECT_FALSE(scene.tools.punch);
  EXPECT_TRUE(scene.blank.half);
  EXPECT_EQ(scene.exchange.address, "shm");
}

TEST(Scene, TextOfAnyEditorIsRead) {
  const std::uint64_t digest = parse_scene(kSmallScene, "a").digest;
  std::string cr, crlf = "\xEF\xBB\xBF", utf_16 = "\xFF\xFE";
  for (const char c : std::string(kSmallScene)) {
    cr += c == '\n' ? '\r' : c;
    crlf += c == '\n' ? "\r\n" : std::string(1, c);
    utf_16 += {c, '\0'};
  }
  for (const std::string& text : {cr, crlf, utf_16}) EXPECT_EQ(parse_scene(text, "a").digest, digest);
}

TEST(Scene, ScalarStandsForBothFibreDirections) {
  const Law law = parse_law_file("woven: {a: 7, b: [8, 9], strain_cap: [none, 0.02], p_min: 0}");
  const WovenLaw& woven = std::get<WovenLaw>(law);
  EXPECT_EQ(woven.a.warp, 7);
  EXPECT_EQ(woven.a.weft, 7);
  EXPECT_EQ(woven.b.warp, 8);
  EXPECT_EQ(woven.b.weft, 9);
  EXPECT_TRUE(std::isinf(woven.strain_cap.warp));
  EXPECT_EQ(woven.strain_cap.weft, 0.02);
  EXPECT_EQ(woven.p_min.warp, 0);
}

TEST(Scene, TwistFollowsFromBendingUnlessGiven) {
  const auto parse = [](const std::string& keys) {
    return parse_scene("layers: [{name: ply, density: 1e-9, law: {woven: {}}, " + keys + "}]", "scene.yaml").layers[0];
  };
  EXPECT_DOUBLE_EQ(parse("bending: [4, 9]").twist, 3);  // sqrt(4 * 9) / 2
  EXPECT_EQ(parse("bending: [4, 9], twist: 0.5").twist, 0.5);
}

TEST(Scene, EveryHardeningLawIsRead) {
  const auto parse = [](const std::string& hardening) {
    return std::get<J2Law>(parse_law_file("j2: {hardening: " + hardening + "}")).hardening;
  };
  EXPECT_EQ(std::get<Swift>(parse("{swift: {K: 500, e0: 0.01}}")).K, 500);
  EXPECT_EQ(std::get<Swift>(parse("{swift: {K: 500, e0: 0.01}}")).n, 0.23);
  EXPECT_EQ(std::get<Voce>(parse("{voce: {s0: 100, s_inf: 200, rate: 10}}")).rate, 10);
  EXPECT_EQ(std::get<HockettSherby>(parse("{hockett_sherby: {s0: 100, s_inf: 200, rate: 10, n: 0.7}}")).n, 0.7);
  const Table table{{0, 166}, {0.1, 280}};
  EXPECT_EQ(std::get<HardeningTable>(parse("{table: [[0, 166], [0.1, 280]]}")).points, table);
}

TEST(Scene, FabricTablesAreRead) {
  const Law law = parse_law_file(
      "woven: {variant: fabric, tables: {warp: [[-0.1, -5], [0, 0], [0.1, 50]], weft: [[0, 0], [0.1, 40]], "
      "shear: [[0, 0], [1, 0.2]]}}");
  const FabricTables& tables = *std::get<WovenLaw>(law).tables;
  EXPECT_EQ(tables.warp.size(), 3u);
  EXPECT_EQ(tables.weft[1][1], 40);
  EXPECT_EQ(tables.shear[1][0], 1);
}

TEST(Scene, FrictionPairsAreRead) {
  const Scene scene =
      parse_scene(kSmallScene + "friction: {pairs: [{between: [die, sheet], coefficient: 0.05}]}\n", "scene.yaml");
  ASSERT_EQ(scene.contact.pairs.size(), 1u);
  EXPECT_EQ(scene.contact.pairs[0].first, "die");
  EXPECT_EQ(scene.contact.pairs[0].second, "sheet");
  EXPECT_EQ(scene.contact.pairs[0].coefficient, 0.05);
}

TEST(LawFile, HoldsTheLawBareOrWrapped) {
  EXPECT_EQ(std::get<WovenLaw>(parse_law_file("woven: {c: 12}")).c.warp, 12);
  EXPECT_EQ(std::get<WovenLaw>(parse_law_file("law: {woven: {c: 12}}")).c.warp, 12);
  EXPECT_EQ(std::get<J2Law>(parse_law_file("law:\n  j2: {young: 1e5}\n")).young, 1e5);
}

TEST(LawFile, MistakesAreSaidAsInAScene) {
  EXPECT_EQ(refuse_law_file("woven:\n  p_min: 1.4\n"), "interply_law.yaml:2: woven.p_min: 1.4 is not in [0, 1]");
  EXPECT_EQ(refuse_law_file("law:\n  woven:\n    p_min: 1.4\n"),
            "interply_law.yaml:3: law.woven.p_min: 1.4 is not in [0, 1]");
  EXPECT_EQ(refuse_law_file("wovn: {}\n"), "interply_law.yaml:1: wovn: unknown key; did you mean 'woven'?");
  EXPECT_EQ(refuse_law_file("{}\n"), "interply_law.yaml:1: needs one of woven, j2, vumat, file");
  EXPECT_EQ(refuse_law_file("law:\n"), "interply_law.yaml:1: law: must be a block of keys, not empty");
  EXPECT_EQ(refuse_law_file("woven: {s: [-1, 0, 0]}\n").substr(0, 28), "interply_law.yaml:1: woven.s");
}

TEST(LawFile, ShippedSetsAreThoseOfTheFmlScene) {
  const Scene scene = read_scene(kSource / "deploy/scenes/tetrahedron_fml.yaml");
  const WovenLaw ply = std::get<WovenLaw>(scene.layers[1].law);
  const WovenLaw soft = std::get<WovenLaw>(read_law(kSource / "deploy/scenes/laws/woven_soft.yaml"));
  EXPECT_EQ(ply.a.warp, soft.a.warp);
  EXPECT_EQ(ply.b.warp, soft.b.warp);
  EXPECT_EQ(ply.c.weft, soft.c.weft);
  EXPECT_EQ(ply.s, soft.s);
  const WovenLaw stiff = std::get<WovenLaw>(read_law(kSource / "deploy/scenes/laws/woven_stiff.yaml"));
  EXPECT_EQ(stiff.a.warp, 5.5e4);
  EXPECT_EQ(stiff.strain_cap.weft, 0.03);
  EXPECT_EQ(std::get<Swift>(std::get<J2Law>(read_law(kSource / "deploy/scenes/laws/dc04.yaml")).hardening).e0, 0.0065);
}

TEST(ShippedScenes, AreAcceptedWithoutWarning) {
  const auto files = list_scenes();
  EXPECT_GE(files.size(), 5u);
  for (const auto& file : files) {
    const Scene scene = read_scene(file);
    EXPECT_EQ(find_warnings(scene), std::vector<std::string>{}) << file;
    EXPECT_EQ(scene.name, file.stem()) << file;
    EXPECT_EQ(scene.time.mass_scaling, 1) << file;
  }
}

TEST(ShippedScenes, CoarseTwinDiffersInNameAndMeshOnly) {
  for (const std::string name : {"tetrahedron_fml", "tetrahedron_fabric"}) {
    const Scene coarse = read_scene(kSource / "deploy/scenes" / (name + "_coarse.yaml"));
    const Scene fine = read_scene(kSource / "deploy/scenes" / (name + ".yaml"),
                                  {"name=" + coarse.name, "blank.mesh_size=" + std::to_string(coarse.blank.mesh_size)});
    EXPECT_EQ(fine.text, coarse.text);
  }
}

TEST(ResolvedScene, ReadsBackToTheSameTextAndDigest) {
  std::vector<Scene> scenes;
  for (const auto& file : list_scenes()) scenes.push_back(read_scene(file));
  scenes.push_back(parse_scene(
      kSmallScene, "scene.yaml",
      {"layers.sheet.thickness=0.1000000000000000055511151231257827", "layers.ply_1.thickness=1.2000000000000002",
       "layers.ply_1.law.woven.strain_cap=[0.03, none]", "name=\"odd: 'name' # with no\\u00e9 sense\"",
       "exchange.address=tcp://localhost:5555", "layers.sheet.law.j2.hardening={table: [[0, 166.25], [0.1, 280]]}",
       "tools.punch=none", "friction.pairs=[{between: [sheet, ply_1], coefficient: 0.3}]"}));
  scenes.push_back(parse_scene(
      kSmallScene, "scene.yaml",
      {"layers.ply_1.law.woven={variant: fabric, tables: {warp: [[-1, -1e-30], [1, 1]], weft: [[0, 0], [1, 1]], shear: "
       "[[0, 0], [1, 1]]}}",
       "name='5'", "layers.sheet.law.j2.hardening={hockett_sherby: {s0: 1, s_inf: 2, rate: 3, n: 0.5}}"}));
  for (const Scene& scene : scenes) {
    const Scene again = parse_scene(scene.text, "resolved");
    EXPECT_EQ(again.text, scene.text);
    EXPECT_EQ(again.digest, scene.digest);
    EXPECT_EQ(again.name, scene.name);
  }
}

/// Every key of the schema that holds a value, as the paths at which the resolved scene must show it.
void list_keys(const google::protobuf::Descriptor& type, std::vector<std::string>& keys) {
  for (int i = 0; i < type.field_count(); ++i) {
    const auto* inner = type.field(i)->message_type();
    if (!type.field(i)->real_containing_oneof()) keys.push_back(type.field(i)->name());
    if (inner && !inner->options().GetExtension(schema::list) && !type.field(i)->real_containing_oneof())
      list_keys(*inner, keys);
  }
}

TEST(ResolvedScene, WritesEveryKeyOfTheSchema) {
  const Scene scene =
      parse_scene(kSmallScene, "scene.yaml",
                  {"friction.pairs=[{between: [sheet, ply_1], coefficient: 0.3}]",
                   "layers.ply_1.law.woven={variant: fabric, tables: {warp: [[0, 0], [1, 1]], weft: [[0, "
                   "0], [1, 1]], shear: [[0, 0], [1, 1]]}}"});
  const std::string file = "{path: /a, digest: 0123456789abcdef}";
  const Scene files = parse_scene(kSmallScene, "scene.yaml",
                                  {"blank={mesh: {file: " + file + ", set: a}}", "tools.die={stl: " + file + "}",
                                   "layers.sheet.law.j2.hill48={r0: 1, r45: 1, r90: 1}"});
  const Scene sizes = parse_scene(kSmallScene, "scene.yaml", {"layers.sheet.mesh_size=5"});
  const std::string text = " " + scene.text + files.text + sizes.text;
  std::vector<std::string> keys;
  list_keys(*schema::Scene::descriptor(), keys);
  list_keys(*schema::WovenLaw::descriptor(), keys);
  list_keys(*schema::J2Law::descriptor(), keys);
  list_keys(*schema::Swift::descriptor(), keys);
  EXPECT_GT(keys.size(), 70u);
  for (const std::string& key : keys) EXPECT_NE(text.find(key + ":"), std::string::npos) << key;
}

TEST(ResolvedScene, DigestFollowsTheValuesNotTheirSpelling) {
  const auto digest = [](const std::vector<std::string>& o) { return parse_scene(kSmallScene, "a", o).digest; };
  EXPECT_EQ(digest({}), digest({"layers.sheet.thickness=1", "motion.stroke=6e1", "blank={symmetry: half}"}));
  EXPECT_EQ(digest({}), parse_scene("# a comment\n" + kSmallScene, "b").digest);
}

/// Walks the resolved text line by line, changes each number, and expects another digest.
TEST(ResolvedScene, DigestChangesWithEveryValue) {
  const Scene scene =
      parse_scene(kSmallScene, "a", {"tools.die.offset=30", "tools.blank_holder.offset=30", "blank.symmetry=full"});
  std::size_t changed = 0;
  for (std::size_t at = scene.text.find_first_of("0123456789"); at != std::string::npos;
       at = scene.text.find_first_of("0123456789", at + 1)) {
    if (std::string(" [").find(scene.text[at - 1]) == std::string::npos) continue;  // first digit of a number
    const std::size_t end = scene.text.find_first_of(",]\n", at);
    const double number = std::stod(scene.text.substr(at, end - at));
    const bool whole = scene.text.substr(at, end - at).find_first_of(".e") == std::string::npos;
    bool differs = false;
    for (const double other : {number + 1, number - 1, number * (1 + 1e-9)}) {
      if (!whole && other != number * (1 + 1e-9)) continue;
      char word[40];
      std::snprintf(word, sizeof word, "%.17g", other);
      std::string text = scene.text;
      text.replace(at, end - at, word);
      try {
        EXPECT_NE(parse_scene(text, "a").digest, scene.digest) << text.substr(at - 30, 60);
        differs = true;
        break;
      } catch (const SceneError&) {  // out of range or not a whole number: the next candidate
      }
    }
    EXPECT_TRUE(differs) << scene.text.substr(at - 30, 60);
    changed += differs;
  }
  EXPECT_GT(changed, 60u);
}

TEST(Warnings, ShearWeakenedCompressionSaysItsAngle) {
  // Without tension-shear energy and with tau = s1 g, W_S = s1 g^2 / 2; 2 d = 8.6 s_C^(2/3) W_S at 30 deg = 0.5236 rad
  // for s1 = 1, s_C = 1000: d = 8.6 * 100 * 0.137078 / 2 = 58.94 MPa.
  const auto warn = [](const std::string& d, const std::string& variant) {
    return find_warnings(parse_scene(
        kSmallScene, "a", {"layers.ply_1.law.woven={variant: " + variant + ", s: [1, 0, 0], s_T: 0, d: " + d + "}"}));
  };
  ASSERT_EQ(warn("58.9", "full").size(), 1u);
  EXPECT_EQ(
      warn("58.9", "full")[0],
      "layers[1].law.woven: a compressed warp is unstable from a shear of 30 deg, where 2 d > 8.6 s_C^(2/3) (W_S + "
      "W_ST) fails; raise d or lower s_C");
  EXPECT_NE(warn("[100000, 59]", "normal_shear").at(0).find("compressed weft is unstable from a shear of 31 deg"),
            std::string::npos);
  EXPECT_TRUE(warn("240", "full").empty());  // 60 deg needs 235.8
  EXPECT_TRUE(warn("58.9", "biaxial").empty());
}

TEST(Warnings, StrongBiaxialCouplingSaysItsStrain) {
  const auto warn = [](const std::string& keys) {
    return find_warnings(parse_scene(kSmallScene, "a", {"layers.ply_1.law.woven={" + keys + "}"}));
  };
  ASSERT_EQ(warn("c: [25, 52]").size(), 1u);
  EXPECT_EQ(
      warn("c: [25, 52]")[0],
      "layers[1].law.woven.c: 52 makes equibiaxial tension unstable from a strain of 0.04; lower c or set strain_cap");
  EXPECT_TRUE(warn("c: [25, 52], strain_cap: [none, 0.03]").empty());
  EXPECT_TRUE(warn("c: 52, variant: uncoupled").empty());
}

TEST(Warnings, MeshAcrossTheFibresLocks) {
  const auto warn = [](const std::string& angle) {
    return find_warnings(parse_scene(kSmallScene, "a", {"layers.ply_1.orientation=" + angle, "blank.symmetry=full"}));
  };
  ASSERT_EQ(warn("45").size(), 1u);
  EXPECT_TRUE(
      warn("45")[0].starts_with("layers[1].orientation: 100 % of the mesh has no sides along both fibres and locks: "));
  EXPECT_EQ(warn("22.5").size(), 1u);
  EXPECT_TRUE(warn("90").empty());
  EXPECT_TRUE(warn("-178").empty());
}

TEST(Warnings, MassScalingOfPureFabric) {
  const std::string fabric = "layers: [{name: ply, density: 1e-9, law: {woven: {}}}]\ntime: {mass_scaling: 10}";
  EXPECT_EQ(find_warnings(parse_scene(fabric, "a")).size(), 1u);
  EXPECT_TRUE(find_warnings(parse_scene(kSmallScene, "a", {"time.mass_scaling=10"})).empty());
}

/// A number in the wrong unit is named with the unit that it most likely is in.
TEST(Warnings, ValueInAnotherUnitIsNamedWithTheUnit) {
  const auto warn = [](const std::string& value) {
    const auto warnings = find_warnings(parse_scene(kSmallScene, "a", {value}));
    return warnings.empty() ? "" : warnings[0];
  };
  EXPECT_EQ(
      warn("layers.ply_1.density=6.19e-7"),
      "layers[1].density: 6.19e-07 t/mm3 is unusual, common is [1e-10, 3e-8]; in kg/mm3 it would be 6.19e-10 t/mm3");
  EXPECT_EQ(warn("layers.sheet.law.j2.young=210"),
            "layers[0].law.j2.young: 210 MPa is unusual, common is [1e3, 1e6]; in GPa it would be 210000 MPa");
  EXPECT_THAT(warn("layers.sheet.law.j2.young=2.1e11"), HasSubstr("; in Pa it would be 210000 MPa"));
  EXPECT_THAT(warn("layers.sheet.law.j2.hardening={swift: {K: 5.3e8}}"), HasSubstr("; in Pa it would be 530 MPa"));
  EXPECT_THAT(warn("layers.ply_1.law.woven.a=5.5e9"), HasSubstr("; in Pa it would be 5500 MPa"));
  EXPECT_THAT(warn("layers.ply_1.law.woven.s=[1.7e5, 0, 0]"), HasSubstr("; in Pa it would be 0.17 MPa"));
  EXPECT_THAT(warn("layers.sheet.thickness=0.002"), HasSubstr("; in m it would be 2 mm"));
  EXPECT_THAT(warn("tools.blank_holder.pressure=2e6"), HasSubstr("; in Pa it would be 2 MPa"));
  EXPECT_THAT(warn("tools.blank_holder.ramp=1"), HasSubstr("; in ms it would be 0.001 s"));
  EXPECT_THAT(warn("motion.forming_time=15"), HasSubstr("; in ms it would be 0.015 s"));
  EXPECT_THAT(warn("motion.stroke=0.06"), HasSubstr("; in m it would be 60 mm"));
  EXPECT_EQ(warn("friction.tool_steel=15"),
            "friction.tool_steel: 15 is unusual, common is [0, 1]; in per cent it would be 0.15");
  EXPECT_THAT(warn("friction.pairs=[{between: [die, sheet], coefficient: 10}]"),
              HasSubstr("in per cent it would be 0.1"));
  for (const char* common : {"friction.tool_steel=0", "motion.stroke=0", "tools.blank_holder.pressure=0"})
    EXPECT_EQ(warn(common), "");
}

/// The punch moves 1.875 strokes per forming time at its fastest.
TEST(Warnings, SpeedStrokeAndMeshBesideTheBlank) {
  const auto warn = [](const std::vector<std::string>& values) {
    const auto warnings = find_warnings(parse_scene(kSmallScene, "a", values));
    return warnings.empty() ? "" : warnings[0];
  };
  EXPECT_THAT(warn({"tools.punch={}", "motion={stroke: 60, forming_time: 2e-3}"}),
              HasSubstr("motion.forming_time: the punch moves at up to 56.25 m/s"));
  EXPECT_EQ(warn({"tools.punch={}", "motion={stroke: 60, forming_time: 4e-3}"}), "");
  EXPECT_THAT(warn({"motion={stroke: 141, forming_time: 0.1}"}),
              HasSubstr("motion.stroke: 141 mm is more than half the blank of 280 mm"));
  EXPECT_THAT(warn({"layers.sheet.mesh_size=0.4", "layers.sheet.thickness=1"}),
              HasSubstr("layers[0].mesh_size: a mesh of 0.4 mm is finer than half the thickness of 1 mm"));
}

/// Damaged text is either still a scene or refused in words; it never ends the process.
TEST(Robustness, DamagedTextNeverCrashes) {
  const std::string whole = read_file(kSource / "deploy/scenes/tetrahedron_fml.yaml");
  const std::string alphabet = "{}[]:,-&*#|>'\"%@`!? \n\t0e.~\\x<=\xc3\x00";
  std::mt19937 random(7);
  const auto pick = [&](std::size_t n) { return random() % n; };
  std::size_t refused = 0;
  for (int i = 0; i < 1500; ++i) {
    std::string text = whole;
    if (i % 3 == 0) text.resize(pick(text.size()));
    for (std::size_t k = i % 3 == 0 ? 0 : 1 + pick(8); k > 0; --k) {
      const std::size_t at = pick(text.size());
      const std::size_t kind = pick(3);
      if (kind == 0) text[at] = alphabet[pick(alphabet.size())];
      if (kind == 1) text.insert(at, 1, alphabet[pick(alphabet.size())]);
      if (kind == 2) text.erase(at, 1 + pick(20));
    }
    try {
      parse_scene(text, "scene.yaml");
    } catch (const SceneError& error) {
      EXPECT_NE(std::string(error.what()), "");
      ++refused;
    }
  }
  EXPECT_GT(refused, 500u);
}

TEST(Robustness, AliasesThatMultiplyAreRefused) {
  std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n", deep = "b0: &b0 [x]\n";
  for (int i = 1; i < 40; ++i) {
    const std::string last = "*a" + std::to_string(i - 1), name = std::to_string(i);
    text += "a" + name + ": &a" + name + " [" + last + ", " + last + ", " + last + ", " + last + "]\n";
    deep += "b" + name + ": &b" + name + " [*b" + std::to_string(i - 1) + "]\n";
  }
  EXPECT_NE(refuse(text).find("too many values"), std::string::npos);
  EXPECT_NE(refuse(deep).find("nested too deeply"), std::string::npos);
  EXPECT_NE(refuse("a: " + std::string(100000, '[')), "");
}

TEST(Robustness, DamagedOverridesNeverCrash) {
  const std::string whole = "layers.ply_1.law.woven.strain_cap[0]={a: [1, 2]}";
  std::mt19937 random(11);
  for (int i = 0; i < 1000; ++i) {
    std::string override = whole;
    for (int k = 0; k < 3; ++k) override[random() % override.size()] = ".[]=:{a1\n"[random() % 9];
    try {
      parse_scene(kSmallScene, "scene.yaml", {override});
    } catch (const SceneError&) {
    }
  }
}

}  // namespace
}  // namespace interply::scene
