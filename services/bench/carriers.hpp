/// The carriers that the exchange benchmark compares.
#pragma once

#include <string>
#include <vector>

#include "bench/star.hpp"

namespace interply::bench {

struct Carrier {
  std::string name;
  std::string reference;  ///< the raw carrier that moves bytes in the same way
  /// @param folder  empty folder for sockets, removed by the caller
  std::unique_ptr<Hub> (*make_hub)(const StarSize&, const std::string& folder, const Watch&);
  /// Connects a peer's process. Null: the peers are threads (Hub::connect_thread).
  std::unique_ptr<Peer> (*connect)(const StarSize&, int peer, const std::string& address, const Watch&);
  bool wants_roudi = false;  ///< needs the shared-memory daemon of iceoryx, iox-roudi
};

/// Raw references first.
const std::vector<Carrier>& list_carriers();

// By source file.
std::unique_ptr<Hub> make_unix_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_tcp_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Peer> connect_unix(const StarSize&, int peer, const std::string& address, const Watch&);
std::unique_ptr<Peer> connect_tcp(const StarSize&, int peer, const std::string& address, const Watch&);

std::unique_ptr<Hub> make_memory_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Peer> connect_memory(const StarSize&, int peer, const std::string& address, const Watch&);

std::unique_ptr<Hub> make_in_process_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_shared_memory_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_zeromq_ipc_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_zeromq_tcp_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_sockets_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Peer> connect_link(const StarSize&, int peer, const std::string& address, const Watch&);

std::unique_ptr<Hub> make_dds_udp_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Hub> make_dds_memory_hub(const StarSize&, const std::string& folder, const Watch&);
std::unique_ptr<Peer> connect_dds_udp(const StarSize&, int peer, const std::string& address, const Watch&);
std::unique_ptr<Peer> connect_dds_memory(const StarSize&, int peer, const std::string& address, const Watch&);

}  // namespace interply::bench
