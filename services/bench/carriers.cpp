#include "bench/carriers.hpp"

namespace interply::bench {

const std::vector<Carrier>& list_carriers() {
  static const std::vector<Carrier> carriers = {
      {"raw-unix", "raw-unix", make_unix_hub, connect_unix},
      {"raw-tcp", "raw-tcp", make_tcp_hub, connect_tcp},
      {"raw-memory", "raw-memory", make_memory_hub, connect_memory},
      {"in-process", "raw-memory", make_in_process_hub, nullptr},
      {"shared-memory", "raw-memory", make_shared_memory_hub, connect_link},
      {"zeromq-ipc", "raw-unix", make_zeromq_ipc_hub, connect_link},
      {"tcp", "raw-tcp", make_sockets_hub, connect_link},
      {"zeromq-tcp", "raw-tcp", make_zeromq_tcp_hub, connect_link},
      {"dds-udp", "raw-tcp", make_dds_udp_hub, connect_dds_udp},
      {"dds-memory", "raw-memory", make_dds_memory_hub, connect_dds_memory, true},
  };
  return carriers;
}

}  // namespace interply::bench
