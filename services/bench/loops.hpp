/// The two ends of the measured loop, the same for every carrier.
///
/// Each step a peer changes one number of its motion; the hub checks it, and answers by changing one of the force,
/// which the peer checks: what is timed is the exchange of the whole arrays, and it is seen at every step that they
/// arrived. After kWarmUp steps the measurement begins; after the last one both ends compare digests of both arrays.
#pragma once

#include <cstdint>
#include <vector>

#include "bench/star.hpp"

namespace interply::bench {

inline constexpr std::int64_t kWarmUp = 32;  ///< steps before the measurement

struct PeerReport {
  double cpu = 0;                       ///< s of its process during the measurement
  std::uint64_t motion = 0, force = 0;  ///< digests of both arrays at the end
};
struct HubReport {
  std::int64_t steps = 0;        ///< measured
  double wall = 0, cpu = 0;      ///< s; cpu of its process
  std::uint64_t digest = 0;      ///< of all motions after the warm-up: depends on the star's size alone
  std::vector<PeerReport> ends;  ///< digests of both arrays at the end, by peer; no cpu
};

/// CPU time of this process, s.
double read_process_cpu();

/// @param step  where the loop is, for whoever watches its waits
/// @throws std::runtime_error if what arrived is not what was sent
PeerReport run_peer(Peer& peer, int index, const StarSize& size, std::int64_t& step);
/// Measures for `seconds`, at least ten steps.
HubReport run_hub(Hub& hub, const StarSize& size, double seconds, std::int64_t& step);

}  // namespace interply::bench
