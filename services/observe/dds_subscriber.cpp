#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "observe/dds.hpp"
#include "observe/dds_domain.hpp"
#include "observe/dds_wire.hpp"

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

/// @return whether the sample was well-formed and has been handed over
template <typename T>
bool hand_over(const typename Wire<T>::Type& sample, Sink& handler) {
  T value;
  try {
    value = decode(sample);
  } catch (const std::runtime_error& e) {
    spdlog::warn("a sample of {} is malformed and skipped: {}", Wire<T>::name, e.what());
    return false;
  }
  handler.put(value);
  return true;
}

template <typename T>
int take_all(dds_entity_t reader, Sink& handler) {
  int n = 0;
  while (true) {
    const Loan loan(reader);
    for (int i = 0; i < loan.count(); ++i) {
      if (loan.has_data(i)) n += hand_over<T>(loan.sample<typename Wire<T>::Type>(i), handler);
    }
    if (loan.count() < Loan::kMost) return n;
  }
}

}  // namespace

struct DdsSubscriber::Impl {
  Impl(const DdsOptions& options, Role role) : participant(options) {
    const Qos partition = make_partition_qos(options.run);
    const dds_entity_t subscriber =
        check_entity(dds_create_subscriber(participant.handle(), partition.get(), nullptr), "create a subscriber");
    waitset = check_entity(dds_create_waitset(participant.handle()), "create a waitset");
    for_each_topic([&]<typename T>() {
      const Qos qos = make_qos(Wire<T>::lasting);
      if (role == Role::Recorder) dds_qset_userdata(qos.get(), kRecorderMark, std::strlen(kRecorderMark));
      const dds_entity_t topic =
          check_entity(dds_create_topic(participant.handle(), Wire<T>::descriptor, Wire<T>::name, nullptr, nullptr),
                       std::string("create topic ") + Wire<T>::name);
      const dds_entity_t reader = check_entity(dds_create_reader(subscriber, topic, qos.get(), nullptr),
                                               std::string("create a reader of ") + Wire<T>::name);
      const dds_entity_t arrived = check_entity(dds_create_readcondition(reader, DDS_ANY_STATE), "watch a reader");
      check_entity(dds_waitset_attach(waitset, arrived, topic_index<T>()), "watch a reader");
      readers[topic_index<T>()] = reader;
    });
  }

  Participant participant;
  dds_entity_t waitset = 0;
  std::array<dds_entity_t, kTopics> readers{};
};

DdsSubscriber::DdsSubscriber(const DdsOptions& options, Role role) : impl_(std::make_unique<Impl>(options, role)) {}
DdsSubscriber::~DdsSubscriber() = default;

int DdsSubscriber::receive(Sink& handler, double seconds) {
  dds_waitset_wait(impl_->waitset, nullptr, 0, static_cast<dds_duration_t>(seconds * 1e9));
  int n = 0;
  for_each_topic([&]<typename T>() { n += take_all<T>(impl_->readers[topic_index<T>()], handler); });
  return n;
}

bool DdsSubscriber::has_publishers() const {
  return dds_get_matched_publications(impl_->readers[topic_index<RunEnd>()], nullptr, 0) > 0;
}

}  // namespace interply::observe
