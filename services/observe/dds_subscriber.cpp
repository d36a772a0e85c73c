#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstring>
#include <map>
#include <type_traits>

#include "observe/dds.hpp"
#include "observe/dds_domain.hpp"
#include "observe/dds_wire.hpp"
#include "observe/known_run.hpp"
#include "observe/quiet_log.hpp"

namespace interply::observe {
namespace {

/// Samples taken from a reader, given back at the end.
class Loan {
 public:
  static constexpr int kMost = 16;
  explicit Loan(dds_entity_t reader) : reader_(reader) {
    count_ = std::max(0, dds_take(reader, samples_.data(), info_.data(), kMost, kMost));
  }
  ~Loan() {
    if (count_ > 0) dds_return_loan(reader_, samples_.data(), count_);
  }
  Loan(const Loan&) = delete;
  Loan& operator=(const Loan&) = delete;
  int count() const { return count_; }
  bool has_data(int i) const { return info_[i].valid_data; }
  dds_instance_handle_t writer(int i) const { return info_[i].publication_handle; }
  template <typename T>
  const T& sample(int i) const {
    return *static_cast<const T*>(samples_[i]);
  }

 private:
  dds_entity_t reader_;
  int count_ = 0;
  std::array<void*, kMost> samples_{};
  std::array<dds_sample_info_t, kMost> info_{};
};

/// Which participant each writer belongs to. A writer that has gone is still known.
class Senders {
 public:
  void learn(dds_entity_t reader) {
    std::array<dds_instance_handle_t, 256> writers;
    const int n = dds_get_matched_publications(reader, writers.data(), writers.size());
    for (int i = 0; i < std::min<int>(n, writers.size()); ++i) {
      if (!known_.contains(writers[i])) learn(reader, writers[i]);
    }
  }
  Sender find(dds_instance_handle_t writer) const {
    const auto found = known_.find(writer);
    return found == known_.end() ? Sender{} : found->second;
  }

 private:
  static constexpr std::size_t kMost = 10000;
  void learn(dds_entity_t reader, dds_instance_handle_t writer) {
    dds_builtintopic_endpoint_t* endpoint = dds_get_matched_publication_data(reader, writer);
    if (!endpoint) return;
    if (known_.size() >= kMost) known_.clear();
    std::memcpy(known_[writer].data(), endpoint->participant_key.v, sizeof(Sender));
    dds_builtintopic_free_endpoint(endpoint);
  }
  std::map<dds_instance_handle_t, Sender> known_;
};

}  // namespace

struct DdsSubscriber::Impl {
  explicit Impl(const DdsOptions& options) : participant(options), known(options.run) {
    const Qos partition = make_partition_qos(options.run);
    const dds_entity_t subscriber =
        check_entity(dds_create_subscriber(participant.handle(), partition.get(), nullptr), "create a subscriber");
    waitset = check_entity(dds_create_waitset(participant.handle()), "create a waitset");
    for_each_topic([&]<typename T>() {
      const Qos qos = make_reader_qos(Wire<T>::depth);
      const dds_entity_t topic =
          check_entity(dds_create_topic(participant.handle(), Wire<T>::descriptor, Wire<T>::name, nullptr, nullptr),
                       std::string("create topic ") + Wire<T>::name);
      const dds_entity_t reader = check_entity(dds_create_reader(subscriber, topic, qos.get(), nullptr),
                                               std::string("create a reader of ") + Wire<T>::name);
      readers[topic_index<T>()] = reader;
    });
    watch<RunHeader>();
  }

  /// Lets a sample of T end the waiting.
  template <typename T>
  void watch() {
    const int i = topic_index<T>();
    if (watched[i]) return;
    watched[i] = true;
    const dds_entity_t arrived =
        check_entity(dds_create_readcondition(readers[i], DDS_ANY_STATE), "watch a reader");
    check_entity(dds_waitset_attach(waitset, arrived, i), "watch a reader");
  }

  template <typename T>
  bool is_due() const {
    if constexpr (std::is_same_v<T, RunHeader>) return true;
    return std::is_same_v<T, LayerMesh> ? known.has_header() : known.has_meshes();
  }

  /// @return number of samples handed over
  template <typename T>
  int take(Sink& handler) {
    if (!is_due<T>()) return 0;
    watch<T>();
    int n = 0;
    for (int loans = 0; loans < kMostLoans; ++loans) {
      const Loan loan(readers[topic_index<T>()]);
      for (int i = 0; i < loan.count(); ++i) {
        if (loan.has_data(i)) n += hand_over<T>(loan.sample<typename Wire<T>::Type>(i), loan.writer(i), handler);
      }
      if (loan.count() < Loan::kMost) break;
    }
    return n;
  }

  /// @return whether the sample was the run's and has been handed over
  template <typename T>
  bool hand_over(const typename Wire<T>::Type& sample, dds_instance_handle_t writer, Sink& handler) {
    T value;
    try {
      value = decode(sample);
      known.admit(value, sample.run, senders.find(writer));
    } catch (const std::runtime_error& e) {
      ++dropped;
      log.warn(fmt::format("{} sample(s) dropped so far, the last one of {}: {}", dropped.load(), Wire<T>::name,
                           e.what()));
      return false;
    }
    handler.put(value);
    return true;
  }

  static constexpr int kMostLoans = 256;  ///< in one receive(): a flood does not hold it
  Participant participant;
  dds_entity_t waitset = 0;
  std::array<dds_entity_t, kTopics> readers{};
  std::array<bool, kTopics> watched{};
  Senders senders;
  KnownRun known;
  QuietLog log;
  std::atomic<std::uint64_t> dropped = 0;
};

DdsSubscriber::DdsSubscriber(const DdsOptions& options) : impl_(std::make_unique<Impl>(options)) {}
DdsSubscriber::~DdsSubscriber() = default;

int DdsSubscriber::receive(Sink& handler, double seconds) {
  dds_waitset_wait(impl_->waitset, nullptr, 0, static_cast<dds_duration_t>(seconds * 1e9));
  for (const dds_entity_t reader : impl_->readers) impl_->senders.learn(reader);
  int n = 0;
  for_each_topic([&]<typename T>() { n += impl_->take<T>(handler); });
  return n;
}

std::uint64_t DdsSubscriber::dropped() const { return impl_->dropped; }

bool DdsSubscriber::has_publishers() const {
  return dds_get_matched_publications(impl_->readers[topic_index<RunEnd>()], nullptr, 0) > 0;
}

}  // namespace interply::observe
