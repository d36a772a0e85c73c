#include "bench/loops.hpp"

#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <stdexcept>

#include "mechanics/digest.hpp"

namespace interply::bench {
namespace {

constexpr std::int64_t kFewest = 10;

/// The number that peer `index` changes in step `step`, and where it lies; scattered over the array.
double make_stamp(int index, std::int64_t step) {
  return static_cast<double>(index + 1) * 1e8 + static_cast<double>(step);
}
std::size_t find_place(std::int64_t step, const StarSize& size) {
  return static_cast<std::size_t>(step) * 7919 % size.values();
}
double answer(double stamp) { return 0.5 * stamp; }

void check(double found, double expected, const char* what, std::int64_t step) {
  if (found != expected)
    throw std::runtime_error(fmt::format("{} of step {} holds {} instead of {}", what, step, found, expected));
}

std::uint64_t compute_digest(const double* values, const StarSize& size) {
  mechanics::Digest digest;
  digest.add(values, sizeof(double) * size.values());
  return digest.value();
}

std::uint64_t compute_digest_of_all(Hub& hub, const StarSize& size) {
  mechanics::Digest digest;
  for (int p = 0; p < size.peers; ++p) digest.add(hub.motion(p), sizeof(double) * size.values());
  return digest.value();
}

}  // namespace

double read_process_cpu() {
  timespec now{};
  ::clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

PeerReport run_peer(Peer& peer, int index, const StarSize& size, std::int64_t& step) {
  double start = 0;
  bool last = false;
  for (std::size_t i = 0; i < size.values(); ++i) peer.motion()[i] = index + 1e-6 * static_cast<double>(i);
  for (step = 0; !last; ++step) {
    const std::size_t place = find_place(step, size);
    peer.motion()[place] = make_stamp(index, step);
    last = peer.exchange(step);
    check(peer.force()[place], answer(make_stamp(index, step)), "a force", step);
    if (step + 1 == kWarmUp) start = read_process_cpu();
  }
  const double cpu = read_process_cpu() - start;
  peer.finish();
  return {cpu, compute_digest(peer.motion(), size), compute_digest(peer.force(), size)};
}

HubReport run_hub(Hub& hub, const StarSize& size, double seconds, std::int64_t& step) {
  using Clock = std::chrono::steady_clock;
  HubReport report;
  Clock::time_point start;
  hub.accept();
  bool last = false;
  for (step = 0; !last; ++step) {
    hub.gather(step);
    const std::size_t place = find_place(step, size);
    for (int p = 0; p < size.peers; ++p) {
      check(hub.motion(p)[place], make_stamp(p, step), "a motion", step);
      hub.force(p)[place] = answer(make_stamp(p, step));
    }
    report.steps = step + 1 - kWarmUp;
    last = report.steps >= kFewest && std::chrono::duration<double>(Clock::now() - start).count() >= seconds;
    hub.scatter(step, last);
    if (report.steps == 0) {
      report.digest = compute_digest_of_all(hub, size);
      start = Clock::now();
      report.cpu = -read_process_cpu();
    }
  }
  report.wall = std::chrono::duration<double>(Clock::now() - start).count();
  report.cpu += read_process_cpu();
  hub.finish();
  for (int p = 0; p < size.peers; ++p)
    report.ends.push_back({0, compute_digest(hub.motion(p), size), compute_digest(hub.force(p), size)});
  return report;
}

}  // namespace interply::bench
