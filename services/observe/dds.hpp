/// Cyclone DDS as the carrier of what anyone may watch: a Sink that publishes, a subscriber that fills a Sink.
///
/// One topic per struct of frames.hpp (`proto/observe.idl`). Every run has its own DDS partition and stamps every
/// sample with its identity, so that runs on one host or network do not mix. Every writer keeps the last sample of each
/// instance (run, layer, interface, tool) for who comes late, and a few for who is slow. Who watches may lose samples
/// and never holds the run.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "observe/frames.hpp"

namespace interply::observe {

struct DdsOptions {
  std::string network = "127.0.0.1";  ///< name or IPv4 address of the interface that DDS uses, or of its network
  bool multicast = false;             ///< find participants by multicast, else by unicast on `network` alone
  int domain = 0;                     ///< DDS domain, 0 to 230
  std::string run;                    ///< identity of the run: the partition, and the stamp of every sample
  std::vector<std::string> peers;     ///< other hosts to look for participants on, IPv4 addresses
};

/// @throws std::runtime_error one sentence, if this host has no such interface or another member cannot be used
void check_network(const DdsOptions& options);

/// Publishes to everyone who watches `options.run`.
///
/// put() copies the sample, hands it to the network and returns; it neither waits for a reader nor throws. A reader that
/// is slow or hangs finds the newest 8 frames of each layer, interface and tool and the newest 1000 history rows. Safe
/// to call from several threads.
class DdsSink : public Sink {
 public:
  /// @throws std::runtime_error with a sentence if options are unusable or no participant can be created
  explicit DdsSink(const DdsOptions& options);
  /// Leaves at once: flush() first if what was put last matters.
  ~DdsSink() override;

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

/// Reads everything that is published in `options.run`.
class DdsSubscriber {
 public:
  /// @throws std::runtime_error with a sentence if options are unusable or no participant can be created
  explicit DdsSubscriber(const DdsOptions& options);
  ~DdsSubscriber();

  /// Hands samples that have arrived to `handler`, waiting at most `seconds` for the first one: the header first, then
  /// the meshes of all layers, then everything else. Samples of one layer, interface or tool come in order; between
  /// them there is no order. What cannot be of this run (stamp, sender, names, sizes: known_run.hpp) is dropped and
  /// counted, with one log line a second at most.
  /// @return number of samples handed over
  int receive(Sink& handler, double seconds);

  /// Samples dropped so far.
  std::uint64_t dropped() const;

  /// Whether anyone publishes this run at present. A participant that dies counts for up to 10 s more.
  bool has_publishers() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace interply::observe
