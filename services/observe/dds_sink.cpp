#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <string>

#include "observe/dds.hpp"
#include "observe/dds_domain.hpp"
#include "observe/dds_wire.hpp"
#include "observe/quiet_log.hpp"

namespace interply::observe {
namespace {

using Clock = std::chrono::steady_clock;

double seconds_until(Clock::time_point deadline) {
  return std::max(0.0, std::chrono::duration<double>(deadline - Clock::now()).count());
}
Clock::time_point after(double seconds) {
  return Clock::now() + std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(seconds));
}
dds_duration_t to_dds(double seconds) { return static_cast<dds_duration_t>(seconds * 1e9); }

}  // namespace

struct DdsSink::Impl {
  explicit Impl(const DdsOptions& options) : run(options.run), participant(options) {
    const Qos partition = make_partition_qos(run);
    const dds_entity_t publisher =
        check_entity(dds_create_publisher(participant.handle(), partition.get(), nullptr), "create a publisher");
    for_each_topic([&]<typename T>() {
      const Qos qos = make_writer_qos(Wire<T>::depth);
      const dds_entity_t topic =
          check_entity(dds_create_topic(participant.handle(), Wire<T>::descriptor, Wire<T>::name, nullptr, nullptr),
                       std::string("create topic ") + Wire<T>::name);
      writers[topic_index<T>()] = check_entity(dds_create_writer(publisher, topic, qos.get(), nullptr),
                                               std::string("create a writer of ") + Wire<T>::name);
    });
  }

  template <typename T>
  void write(const T& a) {
    const Encoded<T> encoded = encode(a, run);
    const dds_return_t result = dds_write(writers[topic_index<T>()], &encoded.sample);
    if (result != DDS_RETCODE_OK) {
      log.warn(fmt::format("a sample of {} is not published: {}; the run goes on", Wire<T>::name,
                           dds_strretcode(result)));
    }
  }

  std::string run;
  Participant participant;
  std::array<dds_entity_t, kTopics> writers{};
  QuietLog log;
};

DdsSink::DdsSink(const DdsOptions& options) : impl_(std::make_unique<Impl>(options)) {}
DdsSink::~DdsSink() = default;

void DdsSink::put(const RunHeader& a) { impl_->write(a); }
void DdsSink::put(const LayerMesh& a) { impl_->write(a); }
void DdsSink::put(const LayerFrame& a) { impl_->write(a); }
void DdsSink::put(const InterfaceFrame& a) { impl_->write(a); }
void DdsSink::put(const ToolFrame& a) { impl_->write(a); }
void DdsSink::put(const HistoryRow& a) { impl_->write(a); }
void DdsSink::put(const RunEnd& a) { impl_->write(a); }

bool DdsSink::flush(double seconds) {
  const Clock::time_point deadline = after(seconds);
  bool all = true;
  for (const dds_entity_t writer : impl_->writers) {
    all &= dds_wait_for_acks(writer, to_dds(seconds_until(deadline))) == DDS_RETCODE_OK;
  }
  return all;
}

}  // namespace interply::observe
