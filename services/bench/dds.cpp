/// The star over Cyclone DDS: reliable, keep last; over UDP on loopback, or through iceoryx's shared memory (the
/// daemon iox-roudi must run). The peers write one topic, each in an instance of its own; each reads a topic of its
/// own.
#include <dds/dds.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "bench/carriers.hpp"
#include "dds_sample.h"

namespace interply::bench {
namespace {

using Sample = interply_bench_Sample;
constexpr int kDomain = 42;  ///< apart from runs, whose default is 0

/// Large packets and buffers: what helps Cyclone DDS with arrays on one host.
std::string make_config(bool shared_memory) {
  return fmt::format(
      R"(<General><Interfaces><NetworkInterface address="127.0.0.1" multicast="false"/></Interfaces>)"
      R"(<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>)"
      R"(<FragmentSize>65000B</FragmentSize></General>)"
      R"(<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>)"
      R"(<Peers><Peer Address="127.0.0.1"/></Peers></Discovery>)"
      R"(<Internal><SocketReceiveBufferSize max="8MB"/><Watermarks><WhcHigh>64MB</WhcHigh>)"
      R"(<WhcHighInit>64MB</WhcHighInit></Watermarks></Internal>)"
      R"(<SharedMemory><Enable>{}</Enable></SharedMemory>)",
      shared_memory);
}

dds_entity_t check(dds_entity_t entity, const char* action) {
  if (entity < 0) throw std::runtime_error(fmt::format("DDS cannot {}: {}", action, dds_strretcode(entity)));
  return entity;
}

/// One participant in its own domain.
class Participant {
 public:
  explicit Participant(bool shared_memory)
      : domain_(check(dds_create_domain(kDomain, make_config(shared_memory).c_str()), "open its domain")),
        participant_(check(dds_create_participant(kDomain, nullptr, nullptr), "join its domain")) {}
  ~Participant() { dds_delete(domain_); }
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;

  dds_entity_t make_writer(const std::string& topic) const {
    return make(topic, "write", 1,
                [&](dds_entity_t t, const dds_qos_t* q) { return dds_create_writer(participant_, t, q, nullptr); });
  }
  /// @param writers  whose samples wait for the reader at the same time: iceoryx keeps so many of a topic, not of a
  /// peer
  dds_entity_t make_reader(const std::string& topic, int writers) const {
    return make(topic, "read", writers,
                [&](dds_entity_t t, const dds_qos_t* q) { return dds_create_reader(participant_, t, q, nullptr); });
  }
  dds_entity_t make_waitset(dds_entity_t reader) const {
    check(dds_set_status_mask(reader, DDS_DATA_AVAILABLE_STATUS), "watch a topic");
    const dds_entity_t waitset = check(dds_create_waitset(participant_), "wait");
    check(dds_waitset_attach(waitset, reader, 0), "wait");
    return waitset;
  }

 private:
  template <typename Create>
  dds_entity_t make(const std::string& topic, const char* action, int depth, const Create& create) const {
    dds_qos_t* qos = dds_create_qos();
    dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, DDS_SECS(10));
    dds_qset_history(qos, DDS_HISTORY_KEEP_LAST, depth);
    const dds_entity_t t = dds_create_topic(participant_, &interply_bench_Sample_desc, topic.c_str(), qos, nullptr);
    const dds_entity_t entity = t < 0 ? t : create(t, qos);
    dds_delete_qos(qos);
    return check(entity, action);
  }

  dds_entity_t domain_, participant_;
};

void put(dds_entity_t writer, int peer, std::int64_t step, bool last, std::vector<double>& values) {
  Sample sample{};
  sample.peer = peer;
  sample.step = step;
  sample.last = last;
  sample.values._buffer = values.data();
  sample.values._length = sample.values._maximum = static_cast<std::uint32_t>(values.size());
  check(dds_write(writer, &sample), "write a sample");
}

/// Takes all samples that are here, waiting for the first, and hands them to `use`.
template <typename Use>
void take(dds_entity_t reader, dds_entity_t waitset, const Watch& watch, const Use& use) {
  constexpr int kMost = 16;
  void* samples[kMost] = {};
  dds_sample_info_t infos[kMost];
  int n;
  while ((n = check(dds_take(reader, samples, infos, kMost, kMost), "take samples")) == 0)
    if (dds_waitset_wait(waitset, nullptr, 0, static_cast<dds_duration_t>(1e9 * kSlice)) == 0) watch();
  for (int i = 0; i < n; ++i)
    if (infos[i].valid_data) use(*static_cast<const Sample*>(samples[i]));
  dds_return_loan(reader, samples, n);
}

/// Copies the array of a sample that must be of this step.
void keep(const Sample& sample, std::int64_t step, std::vector<double>& values) {
  if (sample.step != step || sample.values._length != values.size())
    throw std::runtime_error("a sample of another step or size has arrived");
  std::copy_n(sample.values._buffer, values.size(), values.begin());
}

void wait_for_writers(dds_entity_t reader, std::uint32_t n, const Watch& watch) {
  dds_subscription_matched_status_t status{};
  for (int i = 1; dds_get_subscription_matched_status(reader, &status) == 0 && status.current_count < n; ++i) {
    dds_sleepfor(DDS_MSECS(2));
    if (i % 50 == 0) watch();
  }
}
void wait_for_reader(dds_entity_t writer, const Watch& watch) {
  dds_publication_matched_status_t status{};
  for (int i = 1; dds_get_publication_matched_status(writer, &status) == 0 && status.current_count < 1; ++i) {
    dds_sleepfor(DDS_MSECS(2));
    if (i % 50 == 0) watch();
  }
}

/// iox-roudi connects publishers and subscribers every 100 ms, and DDS does not wait for it.
void wait_for_roudi(bool shared_memory) {
  if (shared_memory) dds_sleepfor(DDS_MSECS(500));
}

std::string name_motion(const std::string& address) { return "bench_motion_" + address; }
std::string name_force(const std::string& address, int peer) { return fmt::format("bench_force_{}_{}", address, peer); }

class DdsHub final : public Hub {
 public:
  DdsHub(const StarSize& size, bool shared_memory, Watch watch)
      : size_(size),
        shared_memory_(shared_memory),
        watch_(std::move(watch)),
        participant_(shared_memory),
        reader_(participant_.make_reader(name_motion(address()), size.peers)),
        waitset_(participant_.make_waitset(reader_)),
        motion_(static_cast<std::size_t>(size.peers), std::vector<double>(size.values())),
        force_(motion_) {
    for (int p = 0; p < size.peers; ++p) writers_.push_back(participant_.make_writer(name_force(address(), p)));
  }
  std::string address() const override { return std::to_string(::getpid()); }
  void accept() override {
    for (const dds_entity_t writer : writers_) wait_for_reader(writer, watch_);
    wait_for_writers(reader_, static_cast<std::uint32_t>(size_.peers), watch_);
    wait_for_roudi(shared_memory_);
  }
  void gather(std::int64_t step) override {
    for (int missing = size_.peers; missing > 0;)
      take(reader_, waitset_, watch_, [&](const Sample& sample) {
        keep(sample, step, motion_.at(static_cast<std::size_t>(sample.peer)));
        --missing;
      });
  }
  const double* motion(int peer) override { return motion_[static_cast<std::size_t>(peer)].data(); }
  double* force(int peer) override { return force_[static_cast<std::size_t>(peer)].data(); }
  void scatter(std::int64_t step, bool last) override {
    for (int p = 0; p < size_.peers; ++p)
      put(writers_[static_cast<std::size_t>(p)], p, step, last, force_[static_cast<std::size_t>(p)]);
  }
  void finish() override {  // nobody has missed the last force
    for (const dds_entity_t writer : writers_) dds_wait_for_acks(writer, DDS_SECS(2));
  }

 private:
  StarSize size_;
  bool shared_memory_;
  Watch watch_;
  Participant participant_;
  dds_entity_t reader_, waitset_;
  std::vector<dds_entity_t> writers_;
  std::vector<std::vector<double>> motion_, force_;
};

class DdsPeer final : public Peer {
 public:
  DdsPeer(const StarSize& size, int peer, const std::string& address, bool shared_memory, Watch watch)
      : peer_(peer),
        watch_(std::move(watch)),
        participant_(shared_memory),
        writer_(participant_.make_writer(name_motion(address))),
        reader_(participant_.make_reader(name_force(address, peer), 1)),
        waitset_(participant_.make_waitset(reader_)),
        motion_(size.values()),
        force_(size.values()) {
    wait_for_reader(writer_, watch_);
    wait_for_writers(reader_, 1, watch_);
    wait_for_roudi(shared_memory);
  }
  double* motion() override { return motion_.data(); }
  const double* force() override { return force_.data(); }
  bool exchange(std::int64_t step) override {
    put(writer_, peer_, step, false, motion_);
    bool answered = false, last = false;
    while (!answered)
      take(reader_, waitset_, watch_, [&](const Sample& sample) {
        keep(sample, step, force_);
        last = sample.last;
        answered = true;
      });
    return last;
  }

 private:
  int peer_;
  Watch watch_;
  Participant participant_;
  dds_entity_t writer_, reader_, waitset_;
  std::vector<double> motion_, force_;
};

}  // namespace

std::unique_ptr<Hub> make_dds_udp_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return std::make_unique<DdsHub>(size, false, watch);
}
std::unique_ptr<Hub> make_dds_memory_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return std::make_unique<DdsHub>(size, true, watch);
}
std::unique_ptr<Peer> connect_dds_udp(const StarSize& size, int peer, const std::string& address, const Watch& watch) {
  return std::make_unique<DdsPeer>(size, peer, address, false, watch);
}
std::unique_ptr<Peer> connect_dds_memory(const StarSize& size, int peer, const std::string& address,
                                         const Watch& watch) {
  return std::make_unique<DdsPeer>(size, peer, address, true, watch);
}

}  // namespace interply::bench
