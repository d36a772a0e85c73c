#include "observe/dds_domain.hpp"

#include <arpa/inet.h>
#include <dds/dds.h>
#include <dds/ddsrt/log.h>
#include <spdlog/fmt/fmt.h>

#include <map>
#include <mutex>
#include <stdexcept>
#include <string_view>

#include "observe/dds_bind.hpp"
#include "observe/network.hpp"
#include "observe/quiet_log.hpp"
#include "process/words.hpp"

namespace interply::observe {
namespace {

/// Longest sample that is sent or received, as Cyclone DDS writes sizes: a frame of a million nodes fits.
constexpr const char* kLongestSample = "256MB";

void check_values(const DdsOptions& options) {
  if (options.domain < 0 || options.domain > 230) {
    throw std::runtime_error(fmt::format("observe.domain: {} is not in [0, 230]", options.domain));
  }
  for (const std::string& peer : options.peers) {
    if (in_addr address{}; inet_pton(AF_INET, peer.c_str(), &address) != 1) {
      throw std::runtime_error(fmt::format("peer '{}' is no IPv4 address", process::to_line(peer)));
    }
  }
  if (options.run.empty() || options.run.find_first_of("*?[]") != std::string::npos) {
    throw std::runtime_error(
        fmt::format("run name '{}' cannot be used: it must not be empty or contain any of * ? [ ]", options.run));
  }
}

/// What Cyclone DDS has to say; strangers' packets can make it say much.
void log_line(void*, const dds_log_data_t* line) {
  static QuietLog log;
  log.warn(fmt::format("DDS: {}", std::string_view(line->message, line->size)));
}

}  // namespace

std::int32_t check_entity(std::int32_t entity, const std::string& action) {
  if (entity < 0) throw std::runtime_error(fmt::format("DDS cannot {}: {}", action, dds_strretcode(entity)));
  return entity;
}

void check_network(const DdsOptions& options) {
  check_values(options);
  find_interface(options.network);
}

std::string make_domain_config(const DdsOptions& options, const std::string& address) {
  std::string peers = options.multicast ? "" : fmt::format(R"(<Peer Address="{}"/>)", address);
  for (const std::string& peer : options.peers) peers += fmt::format(R"(<Peer Address="{}"/>)", peer);
  // One receive thread, since one thread per socket ends only by a packet to itself: never, once the interface is down.
  return fmt::format(
      R"(<General><Interfaces><NetworkInterface address="{0}" multicast="{1}"/></Interfaces>)"
      R"(<AllowMulticast>{1}</AllowMulticast></General>)"
      R"(<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>)"
      R"(<SPDPInterval>2s</SPDPInterval><Peers>{2}</Peers></Discovery>)"
      R"(<Internal><MultipleReceiveThreads>false</MultipleReceiveThreads><MaxSampleSize>{3}</MaxSampleSize>)"
      R"(<SocketReceiveBufferSize max="8MB"/><WriterLingerDuration>100ms</WriterLingerDuration>)"
      R"(<Watermarks><WhcHigh>1GB</WhcHigh><WhcHighInit>1GB</WhcHighInit></Watermarks></Internal>)",
      address, options.multicast ? "true" : "false", peers, kLongestSample);
}

struct Participant::Domain {
  dds_entity_t handle = 0;
  std::string config;
  ~Domain() {
    if (handle > 0) dds_delete(handle);
  }
};

std::shared_ptr<Participant::Domain> Participant::share_domain(const DdsOptions& options) {
  static std::mutex mutex;
  static std::map<int, std::weak_ptr<Domain>> domains;
  const std::lock_guard lock(mutex);
  check_values(options);
  const std::string address = find_interface(options.network).address;
  const std::string config = make_domain_config(options, address);
  std::shared_ptr<Domain> domain = domains[options.domain].lock();
  if (!domain) {
    domain = std::make_shared<Domain>();
    domain->config = config;
    dds_set_log_sink(log_line, nullptr);
    const BindTo narrow(address);
    domain->handle = check_entity(dds_create_domain(static_cast<dds_domainid_t>(options.domain), config.c_str()),
                                  fmt::format("open domain {} on {}", options.domain, options.network));
    domains[options.domain] = domain;
  }
  if (domain->config != config) {
    throw std::runtime_error(fmt::format(
        "DDS domain {} is already open in this process with another network or multicast setting", options.domain));
  }
  return domain;
}

Participant::Participant(const DdsOptions& options) : domain_(share_domain(options)) {
  handle_ = check_entity(
      dds_create_participant(static_cast<dds_domainid_t>(options.domain), nullptr, nullptr),
      fmt::format("join domain {} on {}", options.domain, options.network));
}

Participant::~Participant() { dds_delete(handle_); }

}  // namespace interply::observe
