/// The words of `interply bench`.
#pragma once

#include <CLI/App.hpp>
#include <ostream>

#include "launch/bench_exchange.hpp"
#include "launch/bench_stack.hpp"

namespace interply::launch {

struct BenchOptions {
  BenchExchangeOptions exchange;
  BenchStackOptions stack;
  BenchStarOptions star;
};

/// Adds `bench exchange | stack` and the two commands with which a star starts its processes.
CLI::App* add_bench(CLI::App& app, BenchOptions& options);

/// Runs what was parsed; without `exchange` or `stack`, both shortly.
/// @throws BadArgument
int bench_command(const CLI::App& bench, const BenchOptions& options, std::ostream& out);

}  // namespace interply::launch
