/// Blanks from Gmsh and Abaqus files: what is read, and the sentence for what is not.
#include "geometry/blank_mesh.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <random>

#include "geometry/abaqus_text.hpp"
#include "geometry/alignment.hpp"
#include "geometry/read_file.hpp"

namespace interply::geometry {
namespace {

using testing::HasSubstr;
using testing::Not;

/// Two unit squares side by side: one of two triangles (surface 3), one quadrilateral (surface 4), on z = 5; node 90 is
/// used by nobody, line 1 lies on the edge.
const std::string kGmsh41 = R"($MeshFormat
4.1 0 8
$EndMeshFormat
$PhysicalNames
3
1 7 "edge"
2 1 "left"
2 2 "blank"
$EndPhysicalNames
$Entities
1 1 2 0
1 0 0 5 0
2 0 0 5 1 0 5 1 7 0
3 0 0 5 1 1 5 2 1 2 0
4 1 0 5 2 1 5 1 -2 0
$EndEntities
$Nodes
2 7 10 90
0 1 0 1
90
0.5 0.5 5
2 3 1 6
10
11
12
13
14
15
0 0 5 0 0
1 0 5 1 0
1 1 5 1 1
0 1 5 0 1
2 0 5 2 0
2 1 5 2 1
$EndNodes
$Elements
3 4 1 4
1 2 1 1
1 10 11
2 3 2 2
2 10 11 12
3 10 13 12
2 4 3 1
4 11 14 15 12
$EndElements
$NodeData
anything $End at all
$EndNodeData
)";

const std::string kGmsh22 = R"($MeshFormat
2.2 0 8
$EndMeshFormat
$PhysicalNames
2
2 1 "left"
2 2 "right"
$EndPhysicalNames
$Nodes
7
90 0.5 0.5 5
10 0 0 5
11 1 0 5
12 1 1 5
13 0 1 5
14 2 0 5
15 2 1 5
$EndNodes
$Elements
4
1 1 2 1 2 10 11
2 2 2 1 3 10 11 12
3 2 2 1 3 10 13 12
4 3 2 2 4 11 14 15 12
$EndElements
)";

const std::string kAbaqus = R"(*Heading
 anything
** a comment
*Part, name=Blank
*Node, nset=All
90, 0.5, 0.5, 5.
10, 0., 0., 5.
11, 1., 0, 5.0D+00
12, 1, 1, 5
13, , 1e0, +5
14, 2, 0, 5
15, 2, 1, 5
*Element, type=T3D2, elset=bars
1, 10, 11
*Element, type=S3R,
 elset=Left
2, 10, 11, 12
3, 10, 13, 12
*Element, type=S4R
4, 11, 14,
  15, 12
*Elset, elset=Right
4,
*Elset, elset="my blank"
Left, Right
*Elset, elset=Odd, generate
1, 5, 2
*Solid Section, elset=Left, material=steel
1.0,
*End Part
*Assembly, name=A
*Instance, name=B-1, part=Blank
0., 0., 0.
*End Instance
*Node
10, 3, 3, 3
*Elset, elset=Four, instance=B-1
B-1.4
*End Assembly
*Step
*Node Output
U,
)";

FlatMesh read(const std::string& text, const std::string& set = "", const std::string& name = "part.msh") {
  return parse_blank(text, name, set);
}
FlatMesh read_inp(const std::string& text, const std::string& set = "") { return read(text, set, "part.inp"); }

std::string refuse(const std::string& text, const std::string& set = "", const std::string& name = "part.msh") {
  try {
    parse_blank(text, name, set);
  } catch (const Unreadable& error) {
    return error.what();
  }
  return "";
}
std::string refuse_inp(const std::string& text, const std::string& set = "") { return refuse(text, set, "part.inp"); }

std::string with(std::string text, const std::string& old_part, const std::string& new_part) {
  const std::size_t at = text.find(old_part);
  if (at == std::string::npos) throw std::logic_error("no '" + old_part + "' in the text");
  return text.replace(at, old_part.size(), new_part);
}

double area(const FlatMesh& mesh, std::size_t t) {
  const auto &a = mesh.points[static_cast<std::size_t>(mesh.triangles[t][0])],
             &b = mesh.points[static_cast<std::size_t>(mesh.triangles[t][1])],
             &c = mesh.points[static_cast<std::size_t>(mesh.triangles[t][2])];
  return 0.5 * ((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]));
}

void expect_two_squares(const FlatMesh& mesh) {
  const std::vector<std::array<double, 2>> points{{0, 0}, {1, 0}, {1, 1}, {0, 1}, {2, 0}, {2, 1}};
  EXPECT_EQ(mesh.points, points);  // by number, the free node dropped
  ASSERT_EQ(mesh.triangles.size(), 4u);
  for (std::size_t t = 0; t < 4; ++t) EXPECT_EQ(area(mesh, t), 0.5) << t;  // the clockwise one is turned over
}

TEST(GmshBlank, BothTextVersionsGiveTheSameMesh) {
  expect_two_squares(read(kGmsh41));
  EXPECT_EQ(read(kGmsh41).triangles, read(kGmsh22).triangles);
  EXPECT_EQ(read(kGmsh41).points, read(kGmsh22).points);
}

TEST(GmshBlank, ASetIsAPhysicalSurfaceByNameOrNumber) {
  EXPECT_EQ(read(kGmsh41, "left").triangles.size(), 2u);
  EXPECT_EQ(read(kGmsh41, "left").points.size(), 4u);
  EXPECT_EQ(read(kGmsh41, "blank").triangles.size(), 4u);  // a surface in two groups, and one turned over (-2)
  EXPECT_EQ(read(kGmsh41, "1").triangles.size(), 2u);
  EXPECT_EQ(read(kGmsh22, "right").triangles.size(), 2u);
  EXPECT_EQ(refuse(kGmsh41, "lefd"), "part.msh: has no physical surface 'lefd' with elements; did you mean 'left'?");
  EXPECT_EQ(refuse(kGmsh22, "edge"), "part.msh: has no physical surface 'edge' with elements; it has: 'left', 'right'");
}

TEST(GmshBlank, OtherKindsOfFilesAreRefusedWithACure) {
  const std::string cure = "; write it as text of version 4.1 or 2.2: gmsh OLD.msh -save -format msh41 -o NEW.msh";
  EXPECT_EQ(refuse(with(kGmsh41, "4.1 0 8", "4.1 1 8")), "part.msh:2: is a binary file" + cure);
  EXPECT_EQ(refuse(with(kGmsh41, "4.1 0 8", "4 0 8")), "part.msh:2: is of version '4'" + cure);
  EXPECT_THAT(refuse("solid cube\n"), HasSubstr("part.msh:1: is no Gmsh mesh"));
  EXPECT_THAT(refuse(""), HasSubstr("is no Gmsh mesh"));
  EXPECT_EQ(refuse(with(kGmsh22, "2 2 2 1 3 10 11 12", "2 9 2 1 3 10 11 12 13 14 15")),
            "part.msh:22: element 2 is of Gmsh's type 9, of second or higher order; mesh with -order 1");
  EXPECT_THAT(refuse(with(kGmsh22, "2 2 2 1 3 10 11 12", "2 4 2 1 3 10 11 12 13")), HasSubstr("blank.mesh.set"));
}

/// Gmsh reads words, so a line may end anywhere in a section.
TEST(GmshBlank, LinesMayEndAnywhere) {
  for (const std::string* text : {&kGmsh41, &kGmsh22}) {
    std::string broken;
    bool in_section = false, in_names = false;
    for (std::size_t at = 0; at < text->size();) {
      const std::size_t end = text->find('\n', at);
      std::string line = text->substr(at, end - at);
      if (line.starts_with('$')) in_section = !line.starts_with("$End"), in_names = line == "$PhysicalNames";
      if (in_section && !in_names && !line.starts_with('$') && !line.starts_with("anything"))
        std::replace(line.begin(), line.end(), ' ', '\n');
      broken += line + '\n';
      at = end + 1;
    }
    expect_two_squares(read(broken));
    EXPECT_EQ(read(broken, "left").triangles.size(), 2u);
  }
}

TEST(GmshBlank, AGroupWithoutElementsSaysWhy) {
  std::string all = kGmsh22;  // saved with Mesh.SaveAll: physical 0
  for (const char* tags : {"2 2 2 1 3", "3 2 2 1 3", "4 3 2 2 4"}) {
    std::string none = tags;
    none[6] = '0';
    all = with(all, tags, none);
  }
  EXPECT_THAT(refuse(all, "left"), HasSubstr("part.msh: the physical surface 'left' has no elements: the file gives no "
                                             "physical group to 3 surface elements; save it without Mesh.SaveAll"));
  const std::size_t begin = kGmsh41.find("$Entities"), end = kGmsh41.find("$Nodes");
  const std::string without = kGmsh41.substr(0, begin) + kGmsh41.substr(end);
  EXPECT_THAT(refuse(without, "left"), HasSubstr("has no elements: the file has no $Entities"));
  expect_two_squares(read(without));
  EXPECT_THAT(refuse(with(kGmsh41, "2 1 \"left\"", "2 9 \"nine\""), "nine"),
              HasSubstr("no surface with elements belongs to it"));
  EXPECT_EQ(refuse(kGmsh41, "edge"),
            "part.msh: the physical group 'edge' holds points, curves or volumes, no surface; it has: 'left', 'blank'");
}

TEST(GmshBlank, NodesInOtherSectionsAreReadOrNamed) {
  std::string parametric = with(with(kGmsh22, "$Nodes", "$ParametricNodes"), "$EndNodes", "$EndParametricNodes");
  parametric = with(with(parametric, "10 0 0 5", "10 0 0 5 2 3 0 0"), "11 1 0 5", "11 1 0 5 1 2 1");
  parametric = with(parametric, "12 1 1 5", "12 1 1 5 0 3");
  expect_two_squares(read(parametric));
  EXPECT_EQ(refuse(with(with(kGmsh22, "$Nodes", "$HighOrderNodes"), "$EndNodes", "$EndHighOrderNodes")),
            "part.msh:9: the section '$HighOrderNodes' may hold nodes or elements and is not read; save the mesh with "
            "$Nodes and $Elements");
}

TEST(GmshBlank, ADamagedFileIsRefusedWithItsLine) {
  EXPECT_EQ(refuse(with(kGmsh22, "\n7\n90", "\n8\n90")), "part.msh:18: the section ends before its last node");
  EXPECT_EQ(refuse(with(kGmsh22, "\n7\n90", "\n99999999999999999\n90")),
            "part.msh:18: the section ends before its last node");
  EXPECT_EQ(refuse(with(kGmsh22, "\n7\n90", "\n99999999999999999999\n90")),
            "part.msh:10: the number of nodes '99999999999999999999' is too large");
  EXPECT_EQ(refuse(with(kGmsh22, "10 0 0 5", "10 0 nan 5")), "part.msh:12: a coordinate 'nan' is not a finite number");
  EXPECT_EQ(refuse(with(kGmsh22, "10 0 0 5", "10 0 1e999 5")),
            "part.msh:12: a coordinate '1e999' is not a finite number");
  EXPECT_EQ(refuse(with(kGmsh22, "10 0 0 5", "10 0 0")), "part.msh:18: the section ends before its last node");
  EXPECT_EQ(refuse(with(kGmsh22, "10 0 0 5", "10 0 0 5 5")),
            "part.msh:17: the section goes on after its last node; its counts or its lines are damaged");
  EXPECT_EQ(refuse(with(kGmsh22, "$EndElements\n", "")), "part.msh:24: the section '$Elements' has no '$EndElements'");
  EXPECT_EQ(refuse(with(kGmsh22, "4 3 2 2 4 11 14 15 12", "4 3 2 2 4 11 14 15")),
            "part.msh:25: the section ends before its last corner");
}

TEST(AbaqusBlank, ReadsPartsSetsAndContinuedLines) {
  expect_two_squares(read_inp(kAbaqus));
  EXPECT_EQ(read_inp(kAbaqus, "left").triangles.size(), 2u);
  EXPECT_EQ(read_inp(kAbaqus, "RIGHT").triangles.size(), 2u);
  EXPECT_EQ(read_inp(kAbaqus, "my blank").triangles.size(), 4u);
  EXPECT_EQ(read_inp(kAbaqus, "Odd").triangles.size(), 1u);  // elements 1 (a bar), 3, 5
  EXPECT_EQ(read_inp(kAbaqus, "Four").points.size(), 4u);
}

TEST(AbaqusBlank, UnknownSetsNameTheNearestOne) {
  EXPECT_EQ(refuse_inp(kAbaqus, "rigt"), "part.inp: has no element set 'rigt'; did you mean 'Right'?");
  EXPECT_EQ(refuse_inp(kAbaqus, "ALL"), "part.inp: 'all' is a set of nodes; give a set of elements (*ELSET)");
  EXPECT_EQ(refuse_inp(with(kAbaqus, "Left, Right", "Left, Rigth"), "my blank"),
            "part.inp: has no element set 'rigth', which 'my blank' names; did you mean 'Right'?");
  EXPECT_EQ(refuse_inp(with(kAbaqus, "elset=Right\n4,", "elset=Right\n40,"), "Right"),
            "part.inp: the set 'Right' holds no shell, membrane or plane element");
}

TEST(AbaqusBlank, WhatWouldChangeTheMeshIsRefused) {
  EXPECT_THAT(refuse_inp(with(kAbaqus, "** a comment", "*System\n1,2,3")), HasSubstr("another coordinate system"));
  EXPECT_THAT(refuse_inp(with(kAbaqus, "** a comment", "*NGEN\n1,2")), HasSubstr("*ngen generates nodes"));
  EXPECT_THAT(refuse_inp(with(kAbaqus, "type=S4R", "type=S8R")),
              HasSubstr("part.inp:20: element 4 is of type 'S8R'; use shell"));
  EXPECT_EQ(read_inp(with(kAbaqus, "type=S4R", "type=S8R"), "left").triangles.size(), 2u);
  EXPECT_THAT(refuse_inp(with(kAbaqus, "2, 10, 11, 12", "2, 10, 11, 12, 13")), HasSubstr("has more than 3 corners"));
  EXPECT_THAT(refuse_inp(with(kAbaqus, "  15, 12", "  15")),
              HasSubstr("part.inp:21: a corner of the element is missing"));
  EXPECT_THAT(refuse_inp(with(kAbaqus, "1, 5, 2", "5, 1, 2")), HasSubstr("does not run upwards"));
}

TEST(AbaqusBlank, ElementsAreKnownByTheirFamily) {
  for (const char* type :
       {"S4", "S4R", "S4RT", "S4T", "s4rsw", "S4R5", "DS4", "CPS4RT", "CPE4H", "CPEG4I", "M3D4R", "SFM3D4"})
    EXPECT_EQ(read_inp(with(kAbaqus, "type=S4R", std::string("type=") + type)).triangles.size(), 4u) << type;
  for (const char* type : {"S3", "S3RT", "STRI3", "CPS3T", "M3D3", "CPE3"})
    EXPECT_EQ(read_inp(with(kAbaqus, "type=S3R", std::string("type=") + type)).triangles.size(), 4u) << type;
  for (const char* type : {"STRI65", "S8R5", "S9R5", "CPS6", "M3D8", "SC8R", "C3D8R", "SAX1"})
    EXPECT_THAT(refuse_inp(with(kAbaqus, "type=S4R", std::string("type=") + type)),
                HasSubstr(std::string("is of type '") + type + "'; use shell"));
}

TEST(AbaqusBlank, RigidElementsBelongToToolsNotToTheBlank) {
  const std::string rigid = with(kAbaqus, "type=S4R", "type=R3D4");
  EXPECT_EQ(read_inp(rigid).triangles.size(), 2u);
  EXPECT_THAT(refuse_inp(rigid, "Right"), HasSubstr("element 4 is of type 'R3D4', which is rigid, as a tool is"));
}

TEST(AbaqusBlank, WordsMayBeShortAndLinesMayEndAsTheyLike) {
  std::string text = with(kAbaqus, "*Element, type=S4R", "* ELEM , TYP = S4R");
  text = with(text, "elset=Odd, generate", "elset=Odd, gen");
  EXPECT_EQ(read_inp(text, "Odd").triangles.size(), 1u);
  for (const char* end : {"\r\n", "\r", " \t\n"}) {
    std::string other;
    for (const char c : text) other += c == '\n' ? std::string(end) : std::string(1, c);
    expect_two_squares(read_inp("\xEF\xBB\xBF" + other));
  }
  EXPECT_EQ(refuse_inp("\xFF\xFE*\0N\0"), "part.inp: is saved as UTF-16; save it as UTF-8");
  EXPECT_EQ(refuse("\xFE\xFF\0$"), "part.msh: is saved as UTF-16; save it as UTF-8");
  expect_two_squares(read("\xEF\xBB\xBF" + kGmsh41));
}

/// The instance is shifted by (1, 2, 3), then turned by 90 deg about z through (1, 0): (x, y) -> (1 - (y + 2), x).
TEST(AbaqusBlank, AnInstanceLiesWhereTheAssemblyPutsIt) {
  const auto mesh = read_inp(with(kAbaqus, "0., 0., 0.\n*End I", "1., 2., 3.\n1., 0., 0., 1., 0., 1., 90.\n*End I"));
  const auto at_home = read_inp(kAbaqus);
  ASSERT_EQ(mesh.points.size(), at_home.points.size());
  for (std::size_t i = 0; i < mesh.points.size(); ++i) {
    EXPECT_NEAR(mesh.points[i][0], -1 - at_home.points[i][1], 1e-12);
    EXPECT_NEAR(mesh.points[i][1], at_home.points[i][0], 1e-12);
  }
  EXPECT_THAT(refuse_inp(with(kAbaqus, "0., 0., 0.\n*End I", "1., 2., 3.\n1., 0., 0., 1., 0., 0., 90.\n*End I")),
              HasSubstr("part.inp:34: the axis of the instance has no length"));
  // a quarter turn about x leaves the plane z = const
  EXPECT_THAT(refuse_inp(with(kAbaqus, "0., 0., 0.\n*End I", "0., 0., 0.\n0., 0., 0., 1., 0., 0., 90.\n*End I")),
              HasSubstr("a blank is flat"));
}

/// A part of one square, an instance of it, a second one 10 mm above, and a tool.
const std::string kAssembly = R"(*PART, NAME=Square
*NODE
1, 0, 0
2, 1, 0
3, 1, 1
4, 0, 1
*ELEMENT, TYPE=S4R, ELSET=all
1, 1, 2, 3, 4
*ELSET, ELSET=empty
*END PART
*PART, NAME="Empty part"
*END PART
*ASSEMBLY, NAME=A
*INSTANCE, NAME=low, PART=Square
*END INSTANCE
*INSTANCE, NAME=high, PART=square
5, 0, 10
*END INSTANCE
*INSTANCE, NAME=own, PART="empty PART"
*NODE
1, 0, 0
2, 3, 0
3, 0, 3
*ELEMENT, TYPE=S3, ELSET=three
1, 1, 2, 3
*END INSTANCE
*ELSET, ELSET=blank, INSTANCE=high
1,
*ELSET, ELSET=other, INSTANCE=own, GENERATE
1, 1
*ELSET, ELSET=both
high.1, low.all
*END ASSEMBLY
)";

TEST(AbaqusBlank, AmongSeveralInstancesTheSetSaysWhichOne) {
  EXPECT_EQ(read_inp(kAssembly, "blank").points[0][0], 5);
  EXPECT_EQ(read_inp(kAssembly, "HIGH.all").points[0][0], 5);
  EXPECT_EQ(read_inp(kAssembly, "low").points[0][0], 0);
  EXPECT_EQ(read_inp(kAssembly, "three").triangles.size(), 1u);
  EXPECT_EQ(read_inp(kAssembly, "other").triangles.size(), 1u);
  EXPECT_EQ(refuse_inp(kAssembly),
            "part.inp: holds several meshes; give the blank's as blank.mesh.set, one of: 'low', 'high', 'own'");
  EXPECT_EQ(refuse_inp(kAssembly, "all"),
            "part.inp: holds several meshes that have a set 'all'; give the blank's as blank.mesh.set, one of: "
            "'low.all', 'high.all'");
  EXPECT_EQ(refuse_inp(kAssembly, "both"),
            "part.inp: the set 'both' holds elements of several instances ('low', 'high'); a blank is one piece");
  EXPECT_EQ(refuse_inp(kAssembly, "low.empty"),
            "part.inp: the set 'low.empty' holds no shell, membrane or plane element");
  EXPECT_EQ(refuse_inp(with(kAssembly, "PART=square", "PART=squares")),
            "part.inp:16: there is no *PART 'squares' before its instance; did you mean 'Square'?");
}

TEST(AbaqusBlank, NoSuggestionRepeatsTheQuestion) {
  const std::string lone = with(kAssembly, "*END PART\n*PART",
                                "*END PART\n*PART, NAME=lone\n*ELSET, ELSET=mine\n1\n*END PART\n*PART");
  EXPECT_EQ(refuse_inp(lone, "mine"), "part.inp: has element set 'mine' in 'lone' only; name an instance of it");
  const std::string a(70, 'a');
  EXPECT_THAT(refuse_inp(with(kAbaqus, "elset=Left", "elset=" + a + "b"), a + "c"), Not(HasSubstr("did you mean")));
  EXPECT_THAT(refuse(with(kGmsh22, "\"left\"", "\"" + a + "b\""), a + "c"), Not(HasSubstr("did you mean")));
}

/// What follow_includes() would find, by path.
struct Folder {
  std::map<std::string, std::string> files;
  std::string operator()(const std::string& path) const {
    const auto found = files.find(path);
    if (found == files.end()) throw Unreadable(path + ": there is no such file");
    return found->second;
  }
  FlatMesh read(const std::string& set = "") const {
    return parse_blank(follow_includes((*this)("d/a.inp"), "d/a.inp", *this), set);
  }
  std::string refuse() const {
    try {
      read();
    } catch (const Unreadable& error) {
      return error.what();
    }
    return "";
  }
};

TEST(AbaqusBlank, IncludedFilesAreReadWhereTheyAreNamed) {
  const Folder folder{{{"d/a.inp",
                        "*INCLUDE, INPUT=mesh\\nodes.inp\n*NODE, INPUT=more.txt\n14, 2, 0, 5\n*Element, type=S3R, "
                        "elset=Left\n2, 10, 11, 12\n*INCLUDE,\n INPUT=rest.inp\n4, 11, 14, 15, 12\n"},
                       {"d/mesh/nodes.inp", "\xEF\xBB\xBF*NODE\r\n10, 0, 0, 5\r\n*include, input=deep.inp\r\n"},
                       {"d/mesh/deep.inp", "11, 1, 0, 5\n12, 1, 1, 5"},
                       {"d/more.txt", "13, 0, 1, 5\n15, 2, 1, 5\n"},
                       {"d/rest.inp", "3, 10, 13, 12\n*ELEMENT, TYPE=S4"}}};
  expect_two_squares(folder.read());
  EXPECT_EQ(folder.read("left").triangles.size(), 2u);
  Folder broken = folder;
  broken.files["d/rest.inp"] = "\n3, 10, 33, 12\n*ELEMENT, TYPE=S4";
  EXPECT_EQ(broken.refuse(), "d/rest.inp:2: element 3 has node 33, which the file does not define");
  broken.files["d/rest.inp"] = "3, 10, 13, 12\n2, 10, 13, 12\n*ELEMENT, TYPE=S4";
  EXPECT_EQ(broken.refuse(),
            "d/rest.inp:2: element 2 is given twice, first in line 5 of d/a.inp; choose one set or export one part");
}

TEST(AbaqusBlank, IncludesThatCannotBeFollowedAreNamed) {
  EXPECT_EQ((Folder{{{"d/a.inp", "*NODE\n*INCLUDE, INPUT=b.inp\n"}}}.refuse()),
            "d/a.inp:2: includes 'b.inp', but d/b.inp: there is no such file");
  const Folder circle{{{"d/a.inp", "*INCLUDE, INPUT=b.inp\n"}, {"d/b.inp", "\n*INCLUDE, INPUT=../d/a.inp\n"}}};
  EXPECT_EQ(circle.refuse(),
            "d/b.inp:2: includes '../d/a.inp', which includes this file again");
  EXPECT_EQ((Folder{{{"d/a.inp", "*INCLUDE\n"}}}.refuse()), "d/a.inp:1: *INCLUDE has no INPUT=");
  EXPECT_THAT(refuse_inp(with(kAbaqus, "** a comment", "*Include, input=other.inp")),
              HasSubstr("part.inp:3: includes 'other.inp'"));
}

/// A file whose counts promise more than it holds, or whose sets multiply, costs no more than its length.
TEST(AbaqusBlank, SetsThatMultiplyAreNotExpanded) {
  std::string text = with(kAbaqus, "1, 5, 2", "1, 2000000000000, 1");
  EXPECT_EQ(read_inp(text, "Odd").triangles.size(), 4u);
  for (int i = 0; i < 200; ++i)
    text += "*ELSET, ELSET=s" + std::to_string(i + 1) + "\ns" + std::to_string(i) + ", s" + std::to_string(i) + ", s" +
            std::to_string(i + 1) + "\n";
  text += "*ELSET, ELSET=s0\nLeft, s200\n";
  EXPECT_EQ(read_inp(text, "s200").triangles.size(), 2u);
}

/// One quadrilateral 0-1-2-3 and what is said about it.
std::string quad(const std::string& corners) {
  return "*NODE\n1, 0, 0\n2, 4, 0\n3, 4, 3\n4, 0, 3\n5, 1, 0.5\n6, 2, 0\n*ELEMENT, TYPE=S4\n7, " + corners + "\n";
}

TEST(FlatBlank, QuadrilateralsAreSplitAlongTheirShorterDiagonal) {
  // A kite (0, 0), (4, 0), (4, 3), (1, 2): diagonals 5 and sqrt(13); its area, by the shoelace formula, is 8.5.
  const auto mesh = read_inp("*NODE\n1, 0, 0\n2, 4, 0\n3, 4, 3\n4, 1, 2\n*ELEMENT, TYPE=S4\n7, 1, 4, 3, 2\n");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  EXPECT_DOUBLE_EQ(area(mesh, 0) + area(mesh, 1), 8.5);
  for (const auto& triangle : mesh.triangles) {
    EXPECT_THAT(triangle, testing::Contains(1));
    EXPECT_THAT(triangle, testing::Contains(3));
  }
}

TEST(FlatBlank, WrongElementsAreNamed) {
  EXPECT_THAT(refuse_inp(quad("1, 2, 4, 3")), HasSubstr("part.inp:9: element 7 is not a convex quadrilateral at node"));
  EXPECT_EQ(refuse_inp(quad("1, 2, 5, 4")),
            "part.inp:9: element 7 is not a convex quadrilateral at node 5; check the order of its corners");
  EXPECT_THAT(refuse_inp(quad("1, 6, 2, 3")), HasSubstr("element 7 is not a convex quadrilateral at node 6"));
  EXPECT_EQ(refuse_inp(quad("1, 2, 1, 3")),
            "part.inp:9: element 7 has node 1 twice; an element has three different corners");
  EXPECT_EQ(refuse_inp(quad("1, 2, 2, 1")),
            "part.inp:9: element 7 has node 1 twice; an element has three different corners");
  EXPECT_EQ(refuse_inp(quad("1, 2, 33, 3")), "part.inp:9: element 7 has node 33, which the file does not define");
  EXPECT_EQ(refuse_inp(with(with(quad("1, 6, 2, 3"), "S4", "S3"), "7, 1, 6, 2, 3", "7, 1, 6, 2")),
            "part.inp:9: element 7 has no area");
  EXPECT_EQ(refuse_inp("*NODE\n1, 0, 0\n"), "part.inp: has no triangles or quadrilaterals");
}

TEST(FlatBlank, WrongNodesAreNamed) {
  EXPECT_EQ(
      refuse(with(kGmsh22, "14 2 0 5", "14 2 0 5.1")),
      "part.msh:16: node 14 lies at z = 5.1 mm, node 10 at z = 5 mm; a blank is flat and lies in a plane z = const");
  EXPECT_EQ(read(with(kGmsh22, "14 2 0 5", "14 2 0 5.0000001")).points.size(), 6u);
  EXPECT_EQ(refuse(with(kGmsh22, "14 2 0 5", "11 2 0 5")), "part.msh:16: node 11 is given twice, first in line 13");
  EXPECT_EQ(refuse(with(kGmsh22, "14 2 0 5", "14 2e7 0 5")),
            "part.msh:16: node 14 lies at 2e+07 mm, not within 1e+06 mm; coordinates are in mm");
}

TEST(FlatBlank, IsOnePieceOfAtMostTwoElementsAtASide) {
  const std::string nodes =
      "*NODE\n1, 0, 0\n2, 4, 0\n3, 4, 3\n4, 0, 3\n5, 9, 0\n6, 9, 9\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n";
  EXPECT_EQ(read_inp(nodes + "2, 1, 3, 4\n").triangles.size(), 2u);
  EXPECT_EQ(
      refuse_inp(nodes + "2, 1, 3, 4\n3, 1, 3, 6\n"),
      "part.inp:11: element 3 is the third at a side, after elements 1 and 2; a blank has at most two elements at "
      "a side");
  EXPECT_EQ(refuse_inp(nodes + "2, 1, 2, 4\n"),
            "part.inp:10: element 2 lies on top of element 1, with which it shares a side");
  EXPECT_EQ(refuse_inp(nodes + "1, 1, 3, 4\n"),
            "part.inp:10: element 1 is given twice, first in line 9; choose one set or export one part");
  EXPECT_EQ(refuse_inp(nodes + "2, 3, 5, 6\n"),  // they share a corner only
            "part.inp:10: element 2 is not connected to element 1 by sides; a blank is one piece: choose one set, or "
            "merge nodes that lie on each other");
}

TEST(Alignment, IsTheShareOfAreaWithoutSidesAlongBothFibres) {
  const auto mesh = read_inp(
      "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n4, 1, 1\n5, 2, 0\n*ELEMENT, TYPE=S3\n1, 1, 2, 3\n2, 2, 4, 3\n3, 2, 5, 4\n");
  constexpr double deg = std::numbers::pi / 180;
  EXPECT_EQ(compute_misaligned_share(mesh, 0), 0);
  EXPECT_EQ(compute_misaligned_share(mesh, 94 * deg), 0);
  EXPECT_EQ(compute_misaligned_share(mesh, 6 * deg), 1);
  EXPECT_EQ(compute_misaligned_share(mesh, 45 * deg), 1);  // diagonals along one fibre, nothing along the other
  const auto equilateral = read_inp(
      "*NODE\n1, 0, 0\n2, 1, 0\n3, 0, 1\n4, 1, 1\n5, 0.5, -0.9\n*ELEMENT, TYPE=S3\n1, 1, 2, "
      "3\n2, 2, 4, 3\n3, 1, 5, 2\n");
  EXPECT_NEAR(compute_misaligned_share(equilateral, 0), 0.45 / 1.45, 1e-15);
}

/// Damaged files are read or refused in words, and quickly.
TEST(FlatBlank, DamagedTextNeverCrashes) {
  const std::string alphabet = "0123456789 ,.$*-\n\"=eE\x01";
  std::mt19937 random(5);
  const auto pick = [&](std::size_t n) { return random() % n; };
  int refused = 0;
  for (int i = 0; i < 6000; ++i) {
    const std::string* whole[] = {&kGmsh41, &kGmsh22, &kAbaqus};
    std::string text = *whole[i % 3];
    for (std::size_t k = 0; k < 1 + pick(4); ++k) {
      const std::size_t at = pick(text.size());
      if (pick(3) == 0)
        text.erase(at, 1 + pick(30));
      else
        text[at] = alphabet[pick(alphabet.size())];
      if (text.empty()) break;
    }
    refused += !refuse(text, i % 2 ? "left" : "", i % 3 == 2 ? "part.inp" : "part.msh").empty();
  }
  EXPECT_GT(refused, 1000);
}

}  // namespace
}  // namespace interply::geometry
