/// Hosts with a network between them, each a network namespace of this one.
#include <gtest/gtest.h>
#include <sched.h>

#include <chrono>
#include <cstdlib>
#include <memory>
#include <thread>

#include "child.hpp"
#include "collector.hpp"
#include "record/sample_run.hpp"

namespace interply::observe {
namespace {

using test::Child;
using test::SampleRun;

bool do_command(const std::string& command) { return std::system((command + " > /dev/null 2>&1").c_str()) == 0; }

/// Puts this process into a network of its own. @return whether it may
bool enter_own_network() { return unshare(CLONE_NEWNET) == 0 && do_command("ip link set lo up"); }

/// Waits until this network has the interface and gives it an address. @return whether it has
bool set_up(const std::string& interface, const std::string& address) {
  for (int i = 0; i < 200; ++i) {
    if (do_command("ip addr add " + address + "/24 dev " + interface))
      return do_command("ip link set " + interface + " multicast off up");
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

constexpr const char* kNotPermitted = "network namespaces are not permitted here, or there is no `ip`";

TEST(Hosts, WithoutMulticastAWatcherFindsThePublisherThatItNames) {
  DdsOptions options = make_options("hosts");
  options.network = "10.99.7.0";
  Child publisher([&](const Child::Voice& voice) {
    if (!enter_own_network()) return voice.say("not permitted");
    voice.say("ready");
    if (!set_up("left", "10.99.7.1")) return voice.say("no interface");
    DdsSink sink(options);
    const SampleRun run;
    run.put_start(sink);
    for (int k = 0;; k = (k + 1) % 4) {
      run.put_frame(sink, k);
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  Child watcher([&](const Child::Voice& voice) {
    if (!enter_own_network()) return voice.say("not permitted");
    voice.say("ready");
    if (!set_up("right", "10.99.7.2")) return voice.say("no interface");
    options.peers = {"10.99.7.1"};
    options.network = "right";
    DdsSubscriber subscriber(options);
    Collector got;
    receive_until(subscriber, got, [&] { return got.layer_frames.size() >= 2; });
    voice.say(std::to_string(got.headers.size()) + " header, " + std::to_string(got.meshes.size()) + " meshes, " +
              (got.layer_frames.empty() ? "no " : "") + "frames");
  });
  if (publisher.hear(10) != "ready" || watcher.hear(10) != "ready") GTEST_SKIP() << kNotPermitted;
  ASSERT_TRUE(do_command("ip link add left netns " + std::to_string(publisher.pid()) +
                         " type veth peer name right netns " + std::to_string(watcher.pid())));
  EXPECT_EQ(watcher.hear(20), "1 header, 2 meshes, frames");
}

/// A participant on an interface that is cut by `cut` before it closes. @return what it says last
std::string close_after(const std::string& cut) {
  DdsOptions options = make_options("down");
  options.network = "here";
  Child participant([&](const Child::Voice& voice) {
    if (!enter_own_network() || !do_command("ip link add here type veth peer name there"))
      return voice.say("not permitted");
    if (!set_up("here", "10.99.8.1") || !do_command("ip link set there up")) return voice.say("no interface");
    const SampleRun run;
    auto sink = std::make_unique<DdsSink>(options);
    auto subscriber = std::make_unique<DdsSubscriber>(options);
    run.put_start(*sink);
    Collector got;
    receive_until(*subscriber, got, [&] { return got.meshes.size() == 2; });
    if (!do_command(cut)) return voice.say("not cut");
    run.put_frame(*sink, 0);
    voice.say("cut");
    sink.reset();
    subscriber.reset();
    voice.say("closed");
  });
  const std::string first = participant.hear(20);
  return first == "cut" ? participant.hear(2) : first;
}

TEST(Hosts, ParticipantsCloseWithinTwoSecondsWhenTheNetworkIsGone) {
  for (const char* cut : {"ip link set here down", "ip addr flush dev here", "ip link set lo down"}) {
    const std::string end = close_after(cut);
    if (end == "not permitted") GTEST_SKIP() << kNotPermitted;
    EXPECT_EQ(end, "closed") << cut;
  }
}

}  // namespace
}  // namespace interply::observe
