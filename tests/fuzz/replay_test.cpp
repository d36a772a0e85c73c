/// Every file of the corpora through its target, without a fuzzer: what was once found stays fixed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <iterator>
#include <string>
#include <vector>

#include "paths.hpp"

extern "C" {
int fuzz_scene(const std::uint8_t* data, std::size_t size);
int fuzz_law(const std::uint8_t* data, std::size_t size);
int fuzz_point(const std::uint8_t* data, std::size_t size);
int fuzz_gmsh(const std::uint8_t* data, std::size_t size);
int fuzz_abaqus(const std::uint8_t* data, std::size_t size);
int fuzz_stl(const std::uint8_t* data, std::size_t size);
}

namespace {

void replay(const std::string& name, int (*target)(const std::uint8_t*, std::size_t)) {
  const auto folder = std::filesystem::path(INTERPLY_SOURCE_DIR) / "tests/fuzz/corpus" / name;
  std::vector<std::filesystem::path> files(std::filesystem::directory_iterator(folder), {});
  ASSERT_FALSE(files.empty()) << folder;
  std::sort(files.begin(), files.end());
  for (const auto& file : files) {
    std::ifstream in(file, std::ios::binary);
    const std::string text{std::istreambuf_iterator<char>(in), {}};
    std::cout << file.filename() << std::endl;  // a target that fails ends the process: this was the file
    target(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  }
}

TEST(Corpus, SceneReaderAcceptsOrRefusesInSentences) { replay("scene", fuzz_scene); }
TEST(Corpus, LawReaderAcceptsOrRefusesInSentences) { replay("law", fuzz_law); }
TEST(Corpus, PathReaderAnswersFiniteNumbersOrRefusesInASentence) { replay("point", fuzz_point); }
TEST(Corpus, GmshReaderGivesABlankOrRefusesInASentence) { replay("gmsh", fuzz_gmsh); }
TEST(Corpus, AbaqusReaderGivesABlankOrRefusesInASentence) { replay("abaqus", fuzz_abaqus); }
TEST(Corpus, StlReaderGivesAToolOrRefusesInASentence) { replay("stl", fuzz_stl); }

}  // namespace
