/// deploy/render_record, and the words of README.md about a record, as a person uses them.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>
#include <iterator>

#include "record/writer.hpp"
#include "sample_run.hpp"

namespace interply::record {
namespace {

using test::SampleRun;
using test::TemporaryFolder;
using testing::HasSubstr;

struct Said {
  int exit_code;
  std::string words;
};

Said run(const std::string& command) {
  FILE* pipe = popen((command + " 2>&1").c_str(), "r");
  std::string words;
  for (int c; (c = std::fgetc(pipe)) != EOF;) words += static_cast<char>(c);
  const int status = pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, words};
}

constexpr double kHalfWidth = 95;  ///< mm

class Render : public testing::Test {
 protected:
  /// A record of a formed blank whose ply has shear angles, which a sample run has not. @param frames  that are
  /// complete
  void record(const std::string& name, int frames, const std::string& kind_of_ply = "fabric") const {
    RecordWriter writer(file(name));
    const SampleRun run(3, 20);
    writer.put(run.header());
    for (int layer : {0, 1}) {
      auto mesh = run.mesh(layer);
      if (layer == 0) mesh.kind = kind_of_ply;
      mesh.reference.row(1) -= kHalfWidth;
      writer.put(mesh);
    }
    for (int k = 0; k < frames; ++k) {
      for (int layer : {0, 1}) {
        auto frame = run.layer_frame(layer, k);
        frame.position.row(1) -= kHalfWidth;
        frame.position(2, frame.position.cols() / 2) -= 40;  // the punch
        if (layer == 0 && kind_of_ply == "fabric") frame.fields[1].name = "shear_angle";
        writer.put(frame);
      }
      for (int i : {0, 1}) writer.put(run.interface_frame(i, k));
      writer.put(run.tool_frame(k));
    }
    writer.put(run.end(frames));
    writer.close();
  }
  std::string file(const std::string& name) const { return (folder_ / name).string(); }
  Said render(const std::string& record, const std::string& more = "",
              const std::string& picture = "picture.png") const {
    return run("/usr/bin/python3 " INTERPLY_SOURCE_DIR "/deploy/render_record " + file(record) + " " + file(picture) +
               " " + more);
  }
  void expect_refused(const Said& said, const std::string& sentence) const {
    EXPECT_EQ(said.exit_code, 2);
    EXPECT_THAT(said.words, testing::AllOf(testing::StartsWith("render_record: "), HasSubstr(sentence)));
    EXPECT_EQ(std::count(said.words.begin(), said.words.end(), '\n'), 1) << said.words;
    EXPECT_FALSE(std::filesystem::exists(file("picture.png")));
  }

 private:
  TemporaryFolder folder_;
};

/// A blank seen from one of its corners ends in a corner on the left; cut off, it would end in a line.
TEST_F(Render, ShowsAllOfABlank) {
  record("record.h5", 4);
  std::ofstream(file("picture.png")) << "an older picture";
  const Said said = render("record.h5", "--frame 0");
  EXPECT_EQ(said.exit_code, 0) << said.words;
  EXPECT_THAT(said.words, HasSubstr("picture.png: ply_1, frame 0, largest shear angle "));
  std::ofstream(file("measure.py")) << "import sys\nfrom matplotlib import pyplot\n"
                                       "coloured = (pyplot.imread(sys.argv[1])[80:, :, :3].min(axis=2) < 0.7)\n"
                                       "first = coloured.any(axis=0).argmax()\n"
                                       "print(first > 0 and coloured[:, first].sum() <= 3)\n";
  EXPECT_EQ(run("/usr/bin/python3 " + file("measure.py") + " " + file("picture.png")).words, "True\n");
}

TEST_F(Render, ShowsTheThinningOfSheets) {
  record("record.h5", 4);
  record("sheets.h5", 4, "metal");
  EXPECT_THAT(render("record.h5", "--layer sheet").words, HasSubstr("sheet, frame 3, largest thinning "));
  EXPECT_THAT(render("sheets.h5").words, HasSubstr("sheet, frame 3, largest thinning ")) << "no ply at all";
}

TEST_F(Render, RefusesInASentence) {
  record("record.h5", 2);
  expect_refused(render("record.h5", "--layer ply_2"), "there is no layer 'ply_2'; did you mean 'ply_1'?");
  expect_refused(render("record.h5", "--layer glass"), "there is no layer 'glass'; known: ply_1, sheet");
  expect_refused(render("record.h5", "--frame 2"), "there is no frame 2; complete are 0 to 1");
  expect_refused(render("record.h5", "--frame -1"), "there is no frame -1");
  expect_refused(render("record.h5", "", "none/picture.png"), "none/picture.png: No such file or directory");
  expect_refused(render("record.h5", "", "picture.foo"), "Format 'foo' is not supported");
  expect_refused(render("absent.h5"), "there is no file ");
  std::ofstream(file("text.h5")) << "no HDF5";
  expect_refused(render("text.h5"), "it is no HDF5 file, or damaged");
  std::filesystem::copy_file(file("record.h5"), file("half.h5"));
  std::filesystem::resize_file(file("half.h5"), std::filesystem::file_size(file("half.h5")) / 2);
  expect_refused(render("half.h5"), "it is no HDF5 file, or damaged");
  record("empty.h5", 0);
  expect_refused(render("empty.h5"), "holds no complete frame");
  ASSERT_EQ(run("/usr/bin/python3 -c 'import h5py; h5py.File(\"" + file("other.h5") + "\", \"w\")'").exit_code, 0);
  expect_refused(render("other.h5"), "is no record of interply");
  expect_refused(run("/usr/bin/python3 -S " INTERPLY_SOURCE_DIR "/deploy/render_record a b"),  // finds no packages
                 "has no h5py: install python3-h5py and run this script with /usr/bin/python3");
}

/// The first lines of Python in README.md print what they say.
TEST_F(Render, WordsOfTheReadmeWork) {
  record("record.h5", 2);
  std::ifstream readme(INTERPLY_SOURCE_DIR "/README.md");
  std::string text(std::istreambuf_iterator<char>(readme), {}), code;
  text = text.substr(text.find("    import h5py\n"));
  for (std::size_t end; text.starts_with("    "); text = text.substr(end + 1)) {
    end = text.find('\n');
    code += text.substr(4, end + 1 - 4);
  }
  for (const auto& [there, here] :
       {std::pair<std::string, std::string>{"runs/tetrahedron_fml_coarse/record.h5", file("record.h5")},
        {"ply_2", "ply_1"}}) {
    ASSERT_NE(code.find(there), std::string::npos) << code;
    code.replace(code.find(there), there.size(), here);
  }
  std::ofstream(file("read.py")) << code;
  const Said said = run("/usr/bin/python3 " + file("read.py"));
  EXPECT_EQ(said.exit_code, 0) << said.words;
  EXPECT_THAT(said.words, testing::ContainsRegex("^[0-9.]+\n$"));
}

}  // namespace
}  // namespace interply::record
