/// Cyclone DDS as the carrier of what anyone may watch: a Sink that publishes, a subscriber that fills a Sink.
///
/// One topic per struct of frames.hpp (`proto/observe.idl`), all reliable. Every run has its own DDS partition, so that
/// runs on one host or network do not mix. Every writer keeps the last sample of each instance (run, layer, interface,
/// tool) for late readers; until a reader has acknowledged them, frames and history rows are all kept.
#pragma once

#include <memory>
#include <string>

#include "observe/frames.hpp"

namespace interply::observe {

struct DdsOptions {
  std::string network = "127.0.0.1";  ///< address or name of the interface that DDS uses
  bool multicast = false;             ///< find participants by multicast, else by unicast on `network` alone
  int domain = 0;                     ///< DDS domain, 0 to 230
  std::string run;                    ///< unique name of the run: the partition
};

/// Publishes to everyone who watches `options.run`.
///
/// put() copies the sample and returns. If readers have left more than 64 MB of one topic unacknowledged it waits at
/// most 20 ms, then drops the sample and says so in the log (the first, second, fourth ... of a topic). It never
/// throws. put(RunEnd) first waits up to 2 s for the history rows to be received, so that a reader knows them all by
/// then. Safe to call from several threads.
class DdsSink : public Sink {
 public:
  /// @throws std::runtime_error with a sentence if options are unusable or no participant can be created
  explicit DdsSink(const DdsOptions& options);
  /// Leaves at once: flush() first if what was put last matters.
  ~DdsSink() override;

  /// Waits until a recorder (Role::Recorder) reads all topics, or `seconds` have passed: false. What is put afterwards
  /// is not lost to that recorder.
  bool wait_for_reader(double seconds);

  void put(const RunHeader&) override;
  void put(const LayerMesh&) override;
  void put(const LayerFrame&) override;
  void put(const InterfaceFrame&) override;
  void put(const ToolFrame&) override;
  void put(const HistoryRow&) override;
  void put(const RunEnd&) override;
  bool flush(double seconds) override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Who reads: a run waits for its recorder, never for others.
enum class Role { Recorder, Monitor };

/// Reads everything that is published in `options.run`.
class DdsSubscriber {
 public:
  /// @throws std::runtime_error with a sentence if options are unusable or no participant can be created
  explicit DdsSubscriber(const DdsOptions& options, Role role = Role::Monitor);
  ~DdsSubscriber();

  /// Hands all samples that have arrived to `handler`, waiting at most `seconds` for the first one. Samples of one
  /// layer, interface or tool come in order; between topics and participants there is no order, except that RunEnd
  /// comes after the history rows put before it. A malformed sample is skipped with one log line.
  /// @return number of samples handed over
  int receive(Sink& handler, double seconds);

  /// Whether anyone publishes this run at present. A participant that dies counts for up to 10 s more.
  bool has_publishers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace interply::observe
