#include "geometry/stl.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "support/tool_surfaces.hpp"

namespace {

using namespace interply;
using geometry::parse_stl;
using geometry::Surface;
using test::Soup;

double compute_volume(const Surface& s) {
  double volume = 0;
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    const auto x = [&](int k) { return mechanics::at(s.vertices, s.triangles(k, t)); };
    volume += x(0).dot(x(1).cross(x(2))) / 6;
  }
  return volume;
}

std::string refuse(const std::string& content) {
  try {
    parse_stl(content, "tool.stl");
  } catch (const geometry::Unreadable& error) {
    return error.what();
  }
  return "";
}

const Soup kBox = test::make_box({3, 2, 1});
Soup without_last_triangle(Soup soup) {
  soup.resize(soup.size() - 3);
  return soup;
}

TEST(Stl, BoxIsWatertightWithEightVerticesInBothFormats) {
  for (const std::string& content : {test::to_binary_stl(kBox), test::to_ascii_stl(kBox)}) {
    const Surface box = parse_stl(content, "box.stl");
    EXPECT_EQ(box.vertices.cols(), 8);
    EXPECT_EQ(box.triangles.cols(), 12);
    EXPECT_TRUE(box.is_watertight());
    EXPECT_EQ(box.collapsed, 0);
    EXPECT_NEAR(compute_volume(box), 48, 1e-12);
  }
}

TEST(Stl, NeighboursShareTheirSide) {
  const Surface s = parse_stl(test::to_ascii_stl(test::make_punch(100, 50, 15, 40, 6)), "punch.stl");
  EXPECT_TRUE(s.is_watertight());
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t) {
    for (int k = 0; k < 3; ++k) {
      const int other = s.neighbours(k, t);
      ASSERT_GE(other, 0);
      int shared = 0;
      for (int i = 0; i < 3; ++i)
        shared += s.triangles(i, other) == s.triangles((k + 1) % 3, t) &&
                  s.triangles((i + 1) % 3, other) == s.triangles(k, t) && s.neighbours(i, other) == t;
      EXPECT_EQ(shared, 1);
    }
  }
}

/// Rounded base of area A and perimeter P: pyramid and prism offset by r, by their mixed volumes (Steiner's formula).
TEST(Stl, PunchHasTheVolumeOfTheOffsetBody) {
  const double e = 100, r = 15, top = 40;
  double error[2];
  for (int i = 0; i < 2; ++i) {
    const int m = 8 << i;
    const Surface s = parse_stl(test::to_ascii_stl(test::make_punch(e, 50, r, top, m)), "punch.stl");
    const double prism = top * (std::sqrt(3.0) / 4 * e * e + 3 * e * r + M_PI * r * r);
    const Surface longer = parse_stl(test::to_ascii_stl(test::make_punch(e, 50, r, 2 * top, m)), "punch.stl");
    error[i] = compute_volume(longer) - compute_volume(s) - prism;
  }
  EXPECT_LT(std::abs(error[1]), 1e-3 * 40 * 10000);
  EXPECT_NEAR(error[0] / error[1], 4, 0.1);  // chords: second order
}

TEST(Stl, OpenSidesAreCounted) {
  const Surface open = parse_stl(test::to_binary_stl(without_last_triangle(kBox)), "box.stl");
  EXPECT_FALSE(open.is_watertight());
  EXPECT_EQ(open.open_sides, 3);
}

TEST(Stl, ClosedPartsAreTurnedOutwardsEachByItself) {
  Soup two = kBox;
  for (const mechanics::Vector3& x : kBox) two.push_back(x + mechanics::Vector3(20, 0, 0));
  for (std::size_t i = 0; i < kBox.size(); i += 3) std::swap(two[i], two[i + 1]);
  const Surface s = parse_stl(test::to_binary_stl(two), "boxes.stl");
  EXPECT_NEAR(compute_volume(s), 96, 1e-9);
  EXPECT_TRUE(s.is_watertight());
  for (Eigen::Index t = 0; t < s.triangles.cols(); ++t)
    for (int k = 0; k < 3; ++k) {  // neighbours were turned along
      const int a = s.triangles(k, t), b = s.triangles((k + 1) % 3, t), other = s.neighbours(k, t);
      EXPECT_EQ((s.triangles.col(other) == a).count() + (s.triangles.col(other) == b).count(), 2);
    }
}

TEST(Stl, CornersWithinTheWeldingDistanceAreOneVertex) {
  const double diagonal = 2 * std::sqrt(14.0);
  Soup soup = kBox;
  for (std::size_t i = 0; i < soup.size(); ++i) soup[i].x() += (i % 2 ? 4e-7 : -4e-7) * diagonal;
  EXPECT_EQ(parse_stl(test::to_ascii_stl(soup), "box.stl").vertices.cols(), 8);
  for (std::size_t i = 0; i < soup.size(); ++i) soup[i].x() += (i % 2 ? 1e-5 : -1e-5) * diagonal;
  EXPECT_FALSE(parse_stl(test::to_ascii_stl(soup), "box.stl").is_watertight());
}

TEST(Stl, TrianglesWithACornerTwiceAreDroppedAndCounted) {
  Soup soup = kBox;
  soup.insert(soup.end(), {kBox[0], kBox[1], kBox[1]});
  const Surface s = parse_stl(test::to_binary_stl(soup), "box.stl");
  EXPECT_EQ(s.collapsed, 1);
  EXPECT_TRUE(s.is_watertight());
}

TEST(Stl, SeveralSolidsAndCapitalLettersAreRead) {
  std::string text = test::to_ascii_stl(kBox);
  for (char& c : text) c = static_cast<char>(std::toupper(c));
  Soup moved = kBox;
  for (auto& x : moved) x.z() += 10;
  EXPECT_EQ(parse_stl(text + test::to_ascii_stl(moved), "boxes.stl").triangles.cols(), 24);
}

std::string replace_all(std::string text, const std::string& old_part, const std::string& new_part) {
  for (std::size_t at = 0; (at = text.find(old_part, at)) != text.npos; at += new_part.size())
    text.replace(at, old_part.size(), new_part);
  return text;
}

void expect_box(const std::string& content, const std::string& what) {
  const Surface s = parse_stl(content, "box.stl");
  EXPECT_EQ(s.triangles.cols(), 12) << what;
  EXPECT_TRUE(s.is_watertight()) << what;
  EXPECT_NEAR(compute_volume(s), 48, 1e-12) << what;
}

TEST(Stl, TextIsReadHoweverItIsSpacedAndSpelled) {
  const std::string text = test::to_ascii_stl(kBox);
  expect_box("\xEF\xBB\xBF" + text, "byte order mark");
  expect_box(" \n\t\n" + text, "blanks first");
  expect_box(replace_all(text, "\n", "\r\n"), "CR LF");
  expect_box(replace_all(text, "\n", "\r"), "CR");
  expect_box(replace_all(text, " ", "\t  "), "tabs");
  expect_box(replace_all(text, "end", "end "), "end loop, end facet, end solid");
  expect_box(replace_all(text, " 1\n", " 1.0D+00\n"), "Fortran");
  EXPECT_EQ(refuse("solid a\rfacet normal 0 0 1\router loop\rvertex 0 0 one\r"), "tool.stl:4: 'one' is not a number");
  EXPECT_EQ(refuse("solid a\r\nfacet normal 0 0 1\r\nouter loop\r\nvertex 0 0 one\r\n"),
            "tool.stl:4: 'one' is not a number");
}

TEST(Stl, BytesAfterTheLastTriangleAreCountedAndNotRead) {
  std::string binary = test::to_binary_stl(kBox);
  EXPECT_EQ(parse_stl(binary, "box.stl").bytes_after, 0u);
  expect_box(binary + "made by hand", "a remark at the end");
  EXPECT_EQ(parse_stl(binary + "made by hand", "box.stl").bytes_after, 12u);
  binary.replace(0, 9, "solid box");
  expect_box(binary + '\0', "solid and a byte more");
  EXPECT_EQ(parse_stl(binary + '\0', "box.stl").bytes_after, 1u);
}

TEST(Stl, UnusableSurfacesAreRefusedWithTheCure) {
  Soup soup = kBox;
  soup.insert(soup.end(), {kBox[0], kBox[1], kBox[2] + mechanics::Vector3(0, 0, 5)});
  EXPECT_EQ(
      refuse(test::to_binary_stl(soup)),
      "tool.stl: the side from (-3, 2, 1) to (-3, -2, -1) belongs to more than two triangles; export one solid or "
      "one skin without inner walls");
  soup = kBox;
  std::swap(soup[0], soup[1]);
  EXPECT_THAT(refuse(test::to_binary_stl(soup)), ::testing::HasSubstr("face opposite ways; make the normals"));
  soup = without_last_triangle(kBox);
  soup.resize(3);
  soup.insert(soup.end(), {soup[1], soup[0], soup[2]});
  EXPECT_THAT(refuse(test::to_binary_stl(soup)), ::testing::HasSubstr("holds a closed part without a volume"));
  EXPECT_EQ(refuse(test::to_binary_stl({kBox[0], kBox[0], kBox[1]})), "tool.stl: holds no triangle with an area");
  EXPECT_EQ(refuse(test::to_binary_stl({})), "tool.stl: holds no triangle with an area");
}

TEST(Stl, BrokenFilesAreRefusedWithTheirPlace) {
  EXPECT_EQ(refuse(""), "tool.stl: is no STL file: as a text it does not begin with 'solid'");
  const std::string binary = test::to_binary_stl(kBox);
  EXPECT_EQ(
      refuse(binary.substr(0, 600)),
      "tool.stl: is no STL file, or is cut off: a binary one of 12 triangles has 684 bytes, not 600; export it again");
  std::string named = binary.substr(0, 600);
  named.replace(0, 9, "solid box");  // many programs write this into the header of a binary file
  EXPECT_EQ(refuse(named), refuse(binary.substr(0, 600)));
  EXPECT_EQ(refuse("mesh of a tool\n"), "tool.stl: is no STL file: as a text it does not begin with 'solid'");
  EXPECT_EQ(refuse("\xFF\xFEs"), "tool.stl: is saved as UTF-16; save it as UTF-8");
  const std::string text = test::to_ascii_stl(kBox);
  EXPECT_EQ(refuse(text.substr(0, text.find("endsolid"))),
            "tool.stl:86: 'facet or endsolid' is expected instead of the end of the file");
  EXPECT_EQ(refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 one\n"), "tool.stl:4: 'one' is not a number");
  EXPECT_EQ(refuse("solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 inf\n"),
            "tool.stl: line 4: a coordinate is not within 1e6 mm; an STL holds no unit and is read as mm");
  EXPECT_EQ(refuse("solid a\nfacet normal 0 0 1\nouter\x01loop\n"),
            "tool.stl:3: 'outer' is expected instead of 'outer?loop'");
}

}  // namespace
