#include "observe/dds.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <optional>

#include "collector.hpp"
#include "record/sample_run.hpp"

namespace interply::observe {
namespace {

using test::SampleRun;

void expect_equal(const std::vector<Field>& a, const std::vector<Field>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].unit, b[i].unit);
    EXPECT_EQ(a[i].description, b[i].description);
    EXPECT_EQ(a[i].nodal, b[i].nodal);
    EXPECT_EQ(a[i].components, b[i].components);
    EXPECT_EQ(a[i].values, b[i].values);
  }
}

void expect_equal(const LayerFrame& a, const LayerFrame& b) {
  EXPECT_EQ(a.layer, b.layer);
  EXPECT_EQ(a.frame, b.frame);
  EXPECT_EQ(a.step, b.step);
  EXPECT_EQ(a.time, b.time);
  EXPECT_TRUE((a.position == b.position).all());
  expect_equal(a.fields, b.fields);
}

TEST(DdsSink, CarriesEveryStructUnchanged) {
  const DdsOptions options = make_options("every");
  DdsSubscriber subscriber(options);
  DdsSink sink(options);
  const SampleRun run;
  run.put_start(sink);
  for (int k = 0; k < 4; ++k) run.put_frame(sink, k);
  for (int i = 0; i < 6; ++i) sink.put(run.history_row(i));
  sink.put(run.end(4));
  Collector got;
  receive_until(subscriber, got, [&] {
    return !got.headers.empty() && got.meshes.size() == 2 && got.layer_frames.size() == 8 &&
           got.interface_frames.size() == 8 && got.tool_frames.size() == 4 && got.rows.size() == 6 && !got.ends.empty();
  });
  EXPECT_TRUE(sink.flush(10));

  ASSERT_EQ(got.headers.size(), 1u);
  const RunHeader& header = got.headers[0];
  EXPECT_EQ(header.run, options.run);
  EXPECT_EQ(header.scene_text, run.header().scene_text);
  EXPECT_EQ(header.version, "0.1.0");
  EXPECT_EQ(header.scene_digest, "0123456789abcdef");
  EXPECT_EQ(header.layers, run.header().layers);
  EXPECT_EQ(header.interfaces, run.header().interfaces);
  EXPECT_EQ(header.tools, run.header().tools);
  EXPECT_EQ(header.interface_nodes_of, run.header().interface_nodes_of);
  EXPECT_EQ(header.interface_others, run.header().interface_others);
  ASSERT_EQ(header.tool_surfaces.size(), 1u);
  EXPECT_TRUE((header.tool_surfaces[0].nodes == SampleRun::make_wedge().nodes).all());
  EXPECT_TRUE((header.tool_surfaces[0].triangles == SampleRun::make_wedge().triangles).all());
  EXPECT_EQ(header.frames, 3);
  EXPECT_EQ(header.history_capacity, 6);
  EXPECT_EQ(header.nodes, run.header().nodes);
  EXPECT_EQ(header.elements, run.header().elements);
  ASSERT_EQ(got.meshes.size(), 2u);
  for (const LayerMesh& mesh : got.meshes) {
    const LayerMesh& sent = run.mesh(mesh.layer == "ply_1" ? 0 : 1);
    EXPECT_EQ(mesh.layer, sent.layer);
    EXPECT_EQ(mesh.kind, sent.kind);
    EXPECT_EQ(mesh.thickness, sent.thickness);
    EXPECT_TRUE((mesh.reference == sent.reference).all());
    EXPECT_TRUE((mesh.triangles == sent.triangles).all());
  }
  std::vector<int> next(2, 0);
  for (const LayerFrame& f : got.layer_frames) {
    const int layer = f.layer == "ply_1" ? 0 : 1;
    expect_equal(f, run.layer_frame(layer, next[layer]++));
  }
  std::vector<int> next_interface(2, 0);
  for (const InterfaceFrame& f : got.interface_frames) {
    const int i = f.interface == "ply_1|sheet" ? 0 : 1;
    const InterfaceFrame sent = run.interface_frame(i, next_interface[i]++);
    EXPECT_EQ(f.interface, sent.interface);
    EXPECT_EQ(f.nodes_of, sent.nodes_of);
    EXPECT_EQ(f.frame, sent.frame);
    EXPECT_EQ(f.step, sent.step);
    EXPECT_EQ(f.time, sent.time);
    expect_equal(f.fields, sent.fields);
    expect_equal(f.fields_on_other, sent.fields_on_other);
  }
  for (int k = 0; k < 4; ++k) {
    const ToolFrame sent = run.tool_frame(k);
    EXPECT_EQ(got.tool_frames[k].tool, "punch");
    EXPECT_EQ(got.tool_frames[k].frame, k);
    EXPECT_EQ(got.tool_frames[k].step, sent.step);
    EXPECT_EQ(got.tool_frames[k].time, sent.time);
    EXPECT_EQ(got.tool_frames[k].position, sent.position);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(got.tool_frames[k].force[c], sent.force[c]);
    for (int c = 0; c < 3; ++c) EXPECT_EQ(got.tool_frames[k].moment[c], sent.moment[c]);
  }
  for (int i = 0; i < 6; ++i) {
    const HistoryRow sent = run.history_row(i), &row = got.rows[i];
    EXPECT_EQ(row.step, sent.step);
    for (const auto member :
         {&HistoryRow::time, &HistoryRow::dt, &HistoryRow::stroke, &HistoryRow::kinetic, &HistoryRow::internal,
          &HistoryRow::contact, &HistoryRow::friction, &HistoryRow::damping, &HistoryRow::thinning,
          &HistoryRow::external, &HistoryRow::residual, &HistoryRow::punch_force, &HistoryRow::blank_holder_force,
          &HistoryRow::blank_holder_target, &HistoryRow::peak_penetration, &HistoryRow::contact_vote,
          &HistoryRow::coordinator_step_seconds, &HistoryRow::coordinator_wait_seconds}) {
      EXPECT_EQ(row.*member, sent.*member);
    }
    for (const auto member :
         {&HistoryRow::layer_kinetic, &HistoryRow::layer_internal, &HistoryRow::layer_residual, &HistoryRow::votes,
          &HistoryRow::step_seconds, &HistoryRow::wait_seconds, &HistoryRow::interface_residual,
          &HistoryRow::interface_friction}) {
      EXPECT_EQ(row.*member, sent.*member);
    }
  }
  EXPECT_EQ(got.ends.at(0).status, "done");
  EXPECT_EQ(got.ends.at(0).message, "All is well.");
  EXPECT_EQ(got.ends.at(0).digest, "feedbeef");
  EXPECT_EQ(got.ends.at(0).frames_complete, 4);
  EXPECT_EQ(got.ends.at(0).summary, run.end(4).summary);
}

TEST(DdsSink, FramesOfManyMegabytesArriveIntact) {
  const DdsOptions options = make_options("large");
  DdsSubscriber subscriber(options);
  DdsSink sink(options);
  const SampleRun run(5, 200);  // 40 000 nodes, 79 202 elements: 6.4 MB per frame
  run.put_start(sink);
  Collector got;
  for (std::size_t k = 0; k < 6; ++k) {
    sink.put(run.layer_frame(0, static_cast<int>(k)));
    receive_until(subscriber, got, [&] { return got.layer_frames.size() == k + 1; });
  }
  ASSERT_EQ(got.layer_frames.size(), 6u);
  for (int k = 0; k < 6; ++k) expect_equal(got.layer_frames[k], run.layer_frame(0, k));
  EXPECT_TRUE(sink.flush(10));
}

TEST(DdsSink, NothingIsLostFromTheFirstSampleOn) {
  const SampleRun run(0, 3, 500);
  for (int attempt = 0; attempt < 5; ++attempt) {
    const DdsOptions options = make_options("first" + std::to_string(attempt));
    DdsSink sink(options);
    DdsSubscriber subscriber(options);
    run.put_start(sink);
    for (int i = 0; i < 500; ++i) sink.put(run.history_row(i));
    Collector got;
    receive_until(subscriber, got, [&] { return got.rows.size() == 500; });
    ASSERT_EQ(got.rows.size(), 500u);
    for (int i = 0; i < 500; ++i) EXPECT_EQ(got.rows[i].step, 10 * i);
  }
}

TEST(DdsSink, RunsInOneDomainDoNotMix) {
  const DdsOptions one = make_options("one"), two = make_options("two");
  DdsSubscriber read_one(one), read_two(two);
  DdsSink write_one(one), write_two(two);
  const SampleRun run(9);
  run.put_start(write_one);
  run.put_start(write_two);
  for (int k = 0; k < 4; ++k) write_one.put(run.tool_frame(k));
  for (int k = 5; k < 8; ++k) write_two.put(run.tool_frame(k));
  Collector got_one, got_two;
  receive_until(read_one, got_one, [&] { return got_one.tool_frames.size() >= 4; });
  receive_until(read_two, got_two, [&] { return got_two.tool_frames.size() >= 3; });
  EXPECT_EQ(read_one.receive(got_one, 0.3) + read_two.receive(got_two, 0.3), 0);
  ASSERT_EQ(got_one.tool_frames.size(), 4u);
  ASSERT_EQ(got_two.tool_frames.size(), 3u);
  for (int k = 0; k < 4; ++k) EXPECT_EQ(got_one.tool_frames[k].frame, k);
  for (int k = 0; k < 3; ++k) EXPECT_EQ(got_two.tool_frames[k].frame, k + 5);
}

TEST(DdsSink, LateMonitorGetsHeaderMeshesLastFramesAndEnd) {
  const DdsOptions options = make_options("late");
  DdsSink sink(options);
  const SampleRun run;
  run.put_start(sink);
  for (int k = 0; k < 4; ++k) run.put_frame(sink, k);
  sink.put(run.end(4));
  DdsSubscriber monitor(options);
  Collector got;
  receive_until(monitor, got, [&] {
    return got.headers.size() == 1 && got.meshes.size() == 2 && got.ends.size() == 1 && got.layer_frames.size() == 2 &&
           got.interface_frames.size() == 2 && got.tool_frames.size() == 1;
  });
  EXPECT_EQ(got.headers.size(), 1u);
  EXPECT_EQ(got.meshes.size(), 2u);
  EXPECT_EQ(got.ends.size(), 1u);
  ASSERT_EQ(got.layer_frames.size(), 2u);
  EXPECT_EQ(got.layer_frames[0].frame, 3);
}

TEST(DdsSink, SubscriberKnowsWhetherAnyonePublishes) {
  const DdsOptions options = make_options("publishers");
  DdsSubscriber subscriber(options);
  EXPECT_FALSE(subscriber.has_publishers());
  std::optional<DdsSink> sink(options);
  SampleRun().put_start(*sink);
  Collector got;
  receive_until(subscriber, got, [&] { return got.meshes.size() == 2; });
  EXPECT_TRUE(subscriber.has_publishers());
  sink.reset();
  EXPECT_FALSE(subscriber.has_publishers());
}

TEST(DdsOptions, UnusableOnesAreRefusedWithASentence) {
  const auto refusal = [](const DdsOptions& options) -> std::string {
    try {
      const DdsSink sink(options);
      return "accepted";
    } catch (const std::runtime_error& e) {
      return e.what();
    }
  };
  DdsOptions options = make_options("bad");
  options.run = "a*";
  EXPECT_THAT(refusal(options), testing::HasSubstr("run name 'a*'"));
  options = make_options("bad");
  options.domain = 231;
  EXPECT_EQ(refusal(options), "observe.domain: 231 is not in [0, 230]");
  options = make_options("bad");
  options.network = "127.0.0.1\"/><x";
  EXPECT_THAT(refusal(options), testing::HasSubstr("is no network interface of this host"));
  options = make_options("bad");
  options.peers = {"10.0.0"};
  EXPECT_EQ(refusal(options), "peer '10.0.0' is no IPv4 address");
}

}  // namespace
}  // namespace interply::observe
