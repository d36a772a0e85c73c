#include "record/writer.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <sys/resource.h>

#include <cmath>
#include <csignal>
#include <fstream>
#include <functional>
#include <random>
#include <system_error>

#include "record/file.hpp"
#include "record/reader.hpp"
#include "record/run_folder.hpp"
#include "sample_run.hpp"

namespace interply::record {
namespace {

using test::run_check;
using test::sample_value;
using test::SampleRun;
using test::TemporaryFolder;
using testing::HasSubstr;

void put_whole_run(observe::Sink& sink, const SampleRun& run) {
  run.put_start(sink);
  const int frames = run.header().frames + 1;
  for (int k = 0; k < frames; ++k) run.put_frame(sink, k);
  for (int i = 0; i < run.header().history_capacity; ++i) sink.put(run.history_row(i));
  sink.put(run.end(frames));
}

TEST(RecordWriter, ReaderFindsEveryValueWritten) {
  const TemporaryFolder folder;
  const SampleRun run;
  {
    RecordWriter writer(folder / "record.h5");
    put_whole_run(writer, run);
    EXPECT_TRUE(writer.is_complete());
    EXPECT_EQ(writer.describe_missing(), "");
  }
  const RecordReader reader(folder / "record.h5");
  EXPECT_EQ(reader.frames_complete(), 4);
  EXPECT_EQ(reader.rows_complete(), 6);
  EXPECT_EQ(reader.read_text("status"), "done");
  EXPECT_EQ(reader.read_text("message"), "All is well.");
  EXPECT_EQ(reader.read_text("digest"), "feedbeef");
  EXPECT_EQ(reader.read_text("scene/text"), run.header().scene_text);
  EXPECT_EQ(reader.read_text("layers/sheet/kind"), "metal");
  EXPECT_EQ(reader.layers(), run.header().layers);
  EXPECT_EQ(reader.interfaces(), run.header().interfaces);
  EXPECT_THAT(reader.times(), testing::ElementsAre(0, 0.5, 1.0, 1.5));
  EXPECT_TRUE((reader.read_triangles("sheet") == run.mesh(1).triangles).all());
  for (int k = 0; k < 4; ++k) {
    EXPECT_TRUE((reader.read_position("ply_1", k) == run.layer_frame(0, k).position).all());
    const Numbers stress = reader.read_layer_field("sheet", "stress", k);
    EXPECT_EQ(stress.unit, "MPa");
    ASSERT_THAT(stress.shape, testing::ElementsAre(50, 3));
    for (int p = 0; p < 50; ++p) {
      for (int c = 0; c < 3; ++c) EXPECT_EQ(stress.values[3 * p + c], sample_value(1, 0, k, c, p));
    }
    const Numbers pressure = reader.read_interface_field("die|ply_1", "pressure", k);
    ASSERT_THAT(pressure.shape, testing::ElementsAre(25));
    for (int p = 0; p < 25; ++p) EXPECT_EQ(pressure.values[p], sample_value(11, 0, k, 0, p));
  }
  EXPECT_THAT(reader.read_history("dt").values, testing::ElementsAre(1e-7, 2e-7, 1e-7 * 3, 4e-7, 5e-7, 1e-7 * 6));
  EXPECT_THAT(reader.read_history("layer_kinetic").shape, testing::ElementsAre(6, 2));
  EXPECT_THROW(reader.read_layer_field("sheet", "stress", 4), std::runtime_error);
  EXPECT_THROW(reader.read_layer_field("sheet", "strain", 0), std::runtime_error);
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 6 done"), 0);
}

TEST(RecordWriter, EveryDatasetHasUnitAndDescription) {
  const TemporaryFolder folder;
  RecordWriter writer(folder / "record.h5");
  put_whole_run(writer, SampleRun());
  writer.close();
  EXPECT_EQ(run_check("attributes " + (folder / "record.h5").string()), 0);
}

TEST(RecordWriter, OrderOfArrivalDoesNotMatter) {
  const SampleRun run;
  for (unsigned seed = 0; seed < 20; ++seed) {
    const TemporaryFolder folder;
    RecordWriter writer(folder / "record.h5");
    // The header is first. What one participant sends stays in order, everything else may overtake.
    writer.put(run.header());
    std::vector<std::vector<std::function<void()>>> queues(7);
    queues[6] = {[&] { writer.put(run.end(4)); }};
    for (int l = 0; l < 2; ++l) queues[l].push_back([&, l] { writer.put(run.mesh(l)); });
    for (int k = 0; k < 4; ++k) {
      for (int l = 0; l < 2; ++l) queues[l].push_back([&, l, k] { writer.put(run.layer_frame(l, k)); });
      for (int i = 0; i < 2; ++i) queues[2 + i].push_back([&, i, k] { writer.put(run.interface_frame(i, k)); });
      queues[4].push_back([&, k] { writer.put(run.tool_frame(k)); });
    }
    for (int i = 0; i < 6; ++i) queues[5].push_back([&, i] { writer.put(run.history_row(i)); });
    std::mt19937 random(seed);
    while (!queues.empty()) {
      const std::size_t pick = random() % queues.size();
      queues[pick].front()();
      queues[pick].erase(queues[pick].begin());
      if (queues[pick].empty()) queues.erase(queues.begin() + static_cast<long>(pick));
    }
    EXPECT_TRUE(writer.is_complete());
    writer.close();
    ASSERT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 6 done"), 0) << "seed " << seed;
  }
}

/// No file of this process may become larger while it lives.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) : handler_(std::signal(SIGXFSZ, SIG_IGN)) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
  }
  ~FileSizeLimit() {
    setrlimit(RLIMIT_FSIZE, &before_);
    std::signal(SIGXFSZ, handler_);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;

 private:
  sighandler_t handler_;
  rlimit before_{};
};

TEST(RecordWriter, SaysHowMuchRoomARecordNeedsThatCannotBeWritten) {
  const TemporaryFolder folder;
  std::ofstream(folder / "notes.txt") << "a person's";
  const std::string file = folder / "record.h5";
  RecordWriter writer(file);
  const auto room = testing::AllOf(HasSubstr("cannot write " + file + ": File too large"),
                                   testing::ContainsRegex("takes [0-9.]+ MiB in all and [0-9.]+ MiB are free there"),
                                   HasSubstr("record.frames"), HasSubstr("--out"));
  {
    const FileSizeLimit limit(1 << 14);
    EXPECT_THAT([&] { put_whole_run(writer, SampleRun()); }, testing::ThrowsMessage<std::runtime_error>(room));
    EXPECT_THAT([&] { writer.close(); }, testing::ThrowsMessage<std::runtime_error>(room));
  }
  for (const char* name : {"record.h5", "record.h5.partial", "record.xdmf", "record.xdmf.partial"})
    EXPECT_FALSE(std::filesystem::exists(folder / name)) << name;
  EXPECT_TRUE(std::filesystem::exists(folder / "notes.txt"));
}

TEST(RecordFile, IsNotBegunWhereThereIsNoRoomForIt) {
  const TemporaryFolder folder;
  const SampleRun run;
  Layout layout{.header = run.header()};
  layout.header.frames = 2'000'000'000;  // some 30 TB
  for (int l = 0; l < 2; ++l) {
    layout.meshes[run.mesh(l).layer] = run.mesh(l);
    layout.layer_fields[run.mesh(l).layer] = shapes_of(run.layer_frame(l, 0).fields);
  }
  try {
    RecordFile(folder / "record.h5", layout);
    FAIL() << "was made";
  } catch (const std::system_error& error) {
    EXPECT_EQ(error.code(), std::errc::no_space_on_device);
  }
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RecordFile, IsAsLargeAsMeasured) {
  for (const SampleRun& run : {SampleRun(), SampleRun(30, 20, 500)}) {
    const TemporaryFolder folder;
    RecordWriter writer(folder / "record.h5");
    put_whole_run(writer, run);
    writer.close();
    Layout layout{.header = run.header()};
    for (int l = 0; l < 2; ++l) {
      layout.meshes[run.mesh(l).layer] = run.mesh(l);
      layout.layer_fields[run.mesh(l).layer] = shapes_of(run.layer_frame(l, 0).fields);
    }
    for (int i = 0; i < 2; ++i) {
      layout.interface_fields[run.header().interfaces[i]] = shapes_of(run.interface_frame(i, 0).fields);
      layout.other_fields[run.header().interfaces[i]] = shapes_of(run.interface_frame(i, 0).fields_on_other);
    }
    const auto written = static_cast<double>(std::filesystem::file_size(folder / "record.h5") +
                                             std::filesystem::file_size(folder / "record.xdmf"));
    EXPECT_NEAR(static_cast<double>(measure_record(layout)), written, 0.01 * written + 8192);
  }
}

TEST(RecordWriter, FileIsValidAtEveryInstant) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  int checked = 0;
  // What a killed writer leaves: the bytes of the file at that moment.
  const auto check_copy = [&](int frames, int rows) {
    if (!std::filesystem::exists(folder / "record.h5")) return;
    std::filesystem::copy_file(folder / "record.h5", folder / "copy.h5",
                               std::filesystem::copy_options::overwrite_existing);
    const RecordReader reader(folder / "copy.h5");
    EXPECT_EQ(reader.frames_complete(), frames);
    EXPECT_EQ(reader.rows_complete(), rows);
    EXPECT_EQ(reader.read_text("status"), "running");
    for (int k = 0; k < frames; ++k) {
      EXPECT_TRUE((reader.read_position("sheet", k) == run.layer_frame(1, k).position).all());
    }
    ++checked;
  };
  run.put_start(writer);
  for (int k = 0; k < 4; ++k) {
    writer.put(run.history_row(k));
    writer.flush(0);
    check_copy(k, k + 1);
    for (int l = 0; l < 2; ++l) {
      writer.put(run.layer_frame(l, k));
      check_copy(k, k + 1);
    }
    for (int i = 0; i < 2; ++i) {
      writer.put(run.interface_frame(i, k));
      check_copy(k, k + 1);
    }
    writer.put(run.tool_frame(k));
    check_copy(k + 1, k + 1);
  }
  EXPECT_EQ(checked, 1 + 3 * 6);
  // The record that is being written can be read in place, too.
  EXPECT_EQ(RecordReader(folder / "record.h5").frames_complete(), 4);
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 4 running"), 0);
}

TEST(RecordWriter, SizeOfTheFileNeverChanges) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  run.put_frame(writer, 0);
  const auto size = std::filesystem::file_size(folder / "record.h5");
  for (int k = 1; k < 4; ++k) run.put_frame(writer, k);
  for (int i = 0; i < 6; ++i) writer.put(run.history_row(i));
  writer.put(run.end(4));
  writer.close();
  EXPECT_EQ(std::filesystem::file_size(folder / "record.h5"), size);
}

TEST(RecordWriter, EarlyEndLeavesNaN) {
  const TemporaryFolder folder;
  const SampleRun run(6);
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  for (int k = 0; k < 2; ++k) run.put_frame(writer, k);
  writer.put(run.history_row(0));
  writer.put(observe::RunEnd{"diverged", "Element 3 of ply_1 is inverted.", "", 2});
  EXPECT_TRUE(writer.is_complete());
  writer.close();
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 2 1 diverged"), 0);
  const RecordReader reader(folder / "record.h5");
  EXPECT_EQ(reader.read_text("digest"), "");
  const Numbers position = reader.read("layers/ply_1/position");
  EXPECT_THAT(position.shape, testing::ElementsAre(7, 25, 3));
  EXPECT_TRUE(std::isnan(position.values.back()));
}

TEST(RecordWriter, EndBeforeTheFirstFrameIsRecorded) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  writer.put(run.header());
  writer.put(run.mesh(0));
  writer.put(run.layer_frame(0, 0));
  writer.put(observe::RunEnd{"lost", "sheet did not join.", "", 0});
  writer.close();
  const RecordReader reader(folder / "record.h5");
  EXPECT_EQ(reader.read_text("status"), "lost");
  EXPECT_EQ(reader.read_text("message"), "sheet did not join.");
  EXPECT_EQ(reader.frames_complete(), 0);
  EXPECT_TRUE((reader.read_triangles("ply_1") == run.mesh(0).triangles).all());
}

TEST(RecordWriter, ClosedBeforeTheEndSaysInterrupted) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  run.put_frame(writer, 0);
  writer.close();
  EXPECT_EQ(RecordReader(folder / "record.h5").read_text("status"), "interrupted");
}

TEST(RecordWriter, ReplacesARecordWhenToldToAndNothingElseEver) {
  const TemporaryFolder folder;
  std::ofstream(folder / "record.h5") << "precious";
  for (const bool overwrite : {false, true})
    EXPECT_THROW(RecordWriter(folder / "record.h5", overwrite), FolderRefused);
  EXPECT_EQ(std::filesystem::file_size(folder / "record.h5"), 8u);
  std::filesystem::remove(folder / "record.h5");

  const SampleRun run;
  put_whole_run(*std::make_unique<RecordWriter>(folder / "record.h5"), run);
  EXPECT_THROW(RecordWriter(folder / "record.h5"), FolderRefused);
  RecordWriter writer(folder / "record.h5", true);
  EXPECT_EQ(RecordReader(folder / "record.h5").frames_complete(), 4) << "it stays until the next run begins";
  run.put_start(writer);
  run.put_frame(writer, 0);
  EXPECT_EQ(RecordReader(folder / "record.h5").frames_complete(), 1);
}

/// Nothing that belongs to a run can be left out, and nothing else can reach a record: the run is told.
TEST(RecordWriter, RefusesWhatDoesNotFitAndNamesIt) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  const auto refusal = [&](const auto& value) -> std::string {
    try {
      writer.put(value);
    } catch (const Misfit& misfit) {
      return misfit.what();
    }
    return "nothing was thrown";
  };
  EXPECT_THAT(refusal(run.mesh(0)), HasSubstr("before the header"));
  writer.put(run.header());
  EXPECT_THAT(refusal(run.header()), HasSubstr("a second header"));
  observe::LayerMesh other = run.mesh(0);
  other.layer = "stranger";
  EXPECT_THAT(refusal(other), HasSubstr("'stranger' is not part of this run"));
  for (int l = 0; l < 2; ++l) writer.put(run.mesh(l));
  EXPECT_THAT(refusal(run.mesh(1)), HasSubstr("a second mesh of layer 'sheet'"));
  for (int k = 0; k < 2; ++k) run.put_frame(writer, k);

  observe::LayerFrame stranger = run.layer_frame(0, 2);
  stranger.layer = "stranger";
  EXPECT_THAT(refusal(stranger), HasSubstr("layer 'stranger' does not fit: not part of this run"));
  observe::ToolFrame negative = run.tool_frame(2);
  negative.frame = -1;
  EXPECT_THAT(refusal(negative), HasSubstr("frame -1 of tool 'punch' does not fit: not in [0, 3]"));
  observe::LayerFrame beyond = run.layer_frame(0, 2);
  beyond.frame = 4;
  EXPECT_THAT(refusal(beyond), HasSubstr("not in [0, 3]"));
  EXPECT_THAT(refusal(run.layer_frame(0, 1)), HasSubstr("frame 1 of layer 'ply_1' does not fit: already recorded"));
  writer.put(run.layer_frame(0, 2));
  observe::ToolFrame late = run.tool_frame(2);
  late.step = 7;
  EXPECT_THAT(refusal(late), HasSubstr("of step 7 where the others have step 200"));
  observe::LayerFrame smaller = run.layer_frame(1, 2);
  smaller.position.conservativeResize(3, 7);
  EXPECT_THAT(refusal(smaller), HasSubstr("'sheet' has 7 positions for 36 nodes"));
  observe::InterfaceFrame shorter = run.interface_frame(0, 2);
  shorter.fields.pop_back();
  EXPECT_THAT(refusal(shorter), HasSubstr("has 1 fields where its first frame had 2"));
  EXPECT_EQ(writer.frames_complete(), 2);
}

TEST(RecordWriter, RowsBeyondTheHistoryAreLeftOutAndSettled) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  for (int k = 0; k < 4; ++k) run.put_frame(writer, k);
  for (int i = 0; i < 9; ++i) writer.put(run.history_row(i));
  writer.flush(0);
  EXPECT_EQ(writer.rows_settled(), 9);
  writer.put(run.end(4));
  writer.close();
  EXPECT_EQ(run_check("values " + (folder / "record.h5").string() + " 4 6 done"), 0);
}

TEST(RecordWriter, ARunIsNotDoneWhileFramesAreMissing) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  run.put_frame(writer, 0);
  writer.put(run.layer_frame(0, 1));
  writer.put(run.end(4));
  writer.close();
  const RecordReader reader(folder / "record.h5");
  EXPECT_EQ(reader.read_text("status"), "lost");
  EXPECT_EQ(reader.read_text("digest"), "");
  EXPECT_THAT(reader.read_text("message"), HasSubstr("frame 1 of layer 'sheet'"));
}

TEST(RecordWriter, KeepsASceneThatIsThereAndWritesTheSummary) {
  const TemporaryFolder folder;
  const SampleRun run;
  std::ofstream(folder / "scene.yaml") << "a person's own";
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  run.put_frame(writer, 0);
  observe::RunEnd end = run.end(1);
  end.summary = "{}";
  writer.put(end);
  writer.close();
  std::string line;
  ASSERT_TRUE(std::getline(std::ifstream(folder / "scene.yaml"), line));
  EXPECT_EQ(line, "a person's own");
  ASSERT_TRUE(std::getline(std::ifstream(folder / "summary.json"), line));
  EXPECT_EQ(line, "{}");
}

TEST(RecordWriter, RefusesNamesThatCollideInTheFile) {
  EXPECT_EQ(to_path_name("ply_1|ply_2"), "ply_1|ply_2");
  EXPECT_EQ(to_path_name("a/b c:d"), "a_b_c_d");
  EXPECT_EQ(to_path_name(".."), "_");
  const TemporaryFolder folder;
  Layout layout;
  layout.header.tools = {"a/b", "a_b"};
  EXPECT_THROW(RecordFile(folder / "record.h5", layout), std::runtime_error);
  EXPECT_TRUE(std::filesystem::is_empty(folder.path()));
}

TEST(RecordWriter, FailureToMakeTheFileLeavesNothingBehind) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  observe::LayerFrame bad = run.layer_frame(0, 0);
  bad.fields[0].values.resize(3 * 7);
  try {
    writer.put(bad);
    FAIL();
  } catch (const std::runtime_error& e) {
    EXPECT_THAT(e.what(), testing::HasSubstr("field 'stress' of 'ply_1' has 7 values for 32 elements"));
  }
  EXPECT_FALSE(std::filesystem::exists(folder / "record.h5"));
  EXPECT_FALSE(std::filesystem::exists(folder / "record.h5.partial"));
}

TEST(Xdmf, SidecarDescribesEveryFrameGridAndField) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  for (int k = 0; k < 4; ++k) {
    run.put_frame(writer, k);
    EXPECT_EQ(run_check("xdmf " + (folder / "record.xdmf").string() + " " + std::to_string(k + 1)), 0);
  }
}

TEST(Xdmf, VtkShowsEveryFrameGridAndField) {
  const TemporaryFolder folder;
  const SampleRun run;
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  for (int k = 0; k < 4; ++k) run.put_frame(writer, k);
  EXPECT_EQ(run_check("vtk " + (folder / "record.xdmf").string() + " 4"), 0);
}

TEST(Xdmf, SidecarHasItsSizeFromTheStartAndIsWellFormedAtEveryInstant) {
  const TemporaryFolder folder;
  const SampleRun run(12);
  RecordWriter writer(folder / "record.h5");
  run.put_start(writer);
  run.put_frame(writer, 0);
  const auto size = std::filesystem::file_size(folder / "record.xdmf");
  for (int k = 1; k < 13; ++k) run.put_frame(writer, k);
  EXPECT_EQ(std::filesystem::file_size(folder / "record.xdmf"), size);
  EXPECT_EQ(run_check("xdmf " + (folder / "record.xdmf").string() + " 13"), 0);
}

/// Two hyphens would end the comment that hides a frame which is not there yet.
TEST(Xdmf, NamesWithHyphensAreNames) {
  const TemporaryFolder folder;
  observe::RunHeader header;
  header.layers = {"a--b-"};
  observe::LayerMesh mesh = SampleRun().mesh(0);
  mesh.layer = "a--b-";
  observe::LayerFrame frame = SampleRun().layer_frame(0, 0);
  frame.layer = "a--b-";
  header.frames = 2;
  RecordWriter writer(folder / "record.h5");
  writer.put(header);
  writer.put(mesh);
  for (int k = 0; k < 2; ++k) {
    frame.frame = k;
    writer.put(frame);
    EXPECT_EQ(run_check("well_formed " + (folder / "record.xdmf").string()), 0);
  }
}

}  // namespace
}  // namespace interply::record
