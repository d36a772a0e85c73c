/// `interply bench exchange`: what a step of the star exchange costs over every carrier, in wall and CPU time.
#pragma once

#include <ostream>
#include <string>
#include <vector>

namespace interply::launch {

struct BenchExchangeOptions {
  std::vector<int> peers{1, 5};               ///< solvers
  std::vector<int> nodes{1000, 5041, 20000};  ///< per solver; 5041 is the full blank with 4 mm elements
  std::vector<std::string> carriers;          ///< empty: all
  double seconds = 1;                         ///< measured per carrier and size, divided among the rounds
  int rounds = 5;                             ///< each measures all carriers in turn, so that noise meets all alike
};

/// Medians over the rounds, one row per carrier and size. Exit code kFailed if a carrier delivered something else than
/// the others; a carrier that this machine cannot have (no iox-roudi) has a row that says so.
/// @throws BadArgument for a carrier that there is not
int bench_exchange_command(const BenchExchangeOptions& options, std::ostream& out);

/// The processes of one star; started by the command above.
struct BenchStarOptions {
  std::string carrier, folder, address;
  int peers = 1, nodes = 1, peer = 0;
  double seconds = 0;
};
int bench_hub_command(const BenchStarOptions& options);
int bench_peer_command(const BenchStarOptions& options);

}  // namespace interply::launch
