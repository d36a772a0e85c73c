#include "observe/dds_domain.hpp"

#include <dds/dds.h>
#include <spdlog/fmt/fmt.h>

#include <cctype>
#include <map>
#include <mutex>
#include <stdexcept>

namespace interply::observe {
namespace {

constexpr const char* kAddressCharacters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.:%-_";

void check(const DdsOptions& options) {
  if (options.domain < 0 || options.domain > 230) {
    throw std::runtime_error(fmt::format("observe.domain: {} is not in [0, 230]", options.domain));
  }
  if (options.network.empty() || options.network.find_first_not_of(kAddressCharacters) != std::string::npos) {
    throw std::runtime_error(
        fmt::format("observe.network: '{}' is not the address of a network interface", options.network));
  }
  if (options.run.empty() || options.run.find_first_of("*?[]") != std::string::npos) {
    throw std::runtime_error(
        fmt::format("run name '{}' cannot be used: it must not be empty or contain any of * ? [ ]", options.run));
  }
}

}  // namespace

std::int32_t check_entity(std::int32_t entity, const std::string& action) {
  if (entity < 0) throw std::runtime_error(fmt::format("DDS cannot {}: {}", action, dds_strretcode(entity)));
  return entity;
}

std::string make_domain_config(const DdsOptions& options) {
  check(options);
  const std::string peers =
      options.multicast ? "" : fmt::format(R"(<Peers><Peer Address="{}"/></Peers>)", options.network);
  return fmt::format(
      R"(<General><Interfaces><NetworkInterface address="{0}" multicast="{1}"/></Interfaces>)"
      R"(<AllowMulticast>{1}</AllowMulticast></General>)"
      R"(<Discovery><ParticipantIndex>auto</ParticipantIndex><MaxAutoParticipantIndex>120</MaxAutoParticipantIndex>{2})"
      R"(</Discovery>)"
      R"(<Internal><SocketReceiveBufferSize max="8MB"/><WriterLingerDuration>100ms</WriterLingerDuration>)"
      R"(<Watermarks><WhcHigh>64MB</WhcHigh><WhcHighInit>64MB</WhcHighInit></Watermarks></Internal>)",
      options.network, options.multicast ? "true" : "false", peers);
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
  const std::string config = make_domain_config(options);
  std::shared_ptr<Domain> domain = domains[options.domain].lock();
  if (!domain) {
    domain = std::make_shared<Domain>();
    domain->config = config;
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
      fmt::format("join domain {} on {} (is that an interface of this host?)", options.domain, options.network));
}

Participant::~Participant() { dds_delete(handle_); }

}  // namespace interply::observe
