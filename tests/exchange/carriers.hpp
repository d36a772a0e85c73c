/// One coordinator and its solvers over any carrier, and arrays whose every number tells layer and step.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <spdlog/sinks/ostream_sink.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <atomic>
#include <cstring>
#include <filesystem>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "exchange/in_process.hpp"
#include "exchange/link.hpp"
#include "exchange/zeromq.hpp"

namespace interply::exchange {

inline constexpr std::uint64_t kDigest = 0x0123456789abcdef;
inline const Welcome kWelcome{.scene_text = "blank: ...", .scene_digest = kDigest, .run = "run 7"};
inline constexpr double kPatience = 20;  ///< s; nothing in a test that passes waits this long

enum class Carrier { InProcess, SharedMemory, Ipc, Tcp };

inline std::string to_string(Carrier carrier) {
  static const char* const kNames[] = {"InProcess", "SharedMemory", "Ipc", "Tcp"};
  return kNames[static_cast<int>(carrier)];
}

/// Address that nobody else uses; tcp takes any free port.
inline std::string make_address(Carrier carrier) {
  static std::atomic<int> count{0};
  if (carrier == Carrier::Tcp) return "tcp://127.0.0.1:*";
  const auto name = "interply-test-" + std::to_string(::getpid()) + "-" + std::to_string(count++);
  return (carrier == Carrier::SharedMemory ? "shm://" : "ipc://") +
         (std::filesystem::temp_directory_path() / name).string();
}

/// A coordinator's link that can be ended, and links of solvers to it.
class Table {
 public:
  Table(Carrier carrier, std::vector<Expected> expected) {
    if (carrier == Carrier::InProcess) {
      hub_ = std::make_unique<InProcessHub>(kDigest, std::move(expected));
    } else {
      bound_ = bind_zeromq(make_address(carrier), kWelcome, std::move(expected));
      endpoint_ = get_endpoint(*bound_);
    }
  }
  CoordinatorLink& coordinator() { return hub_ ? hub_->coordinator() : *bound_; }
  std::unique_ptr<SolverLink> connect() { return hub_ ? hub_->connect() : connect_zeromq(endpoint_); }
  void end_coordinator() {
    if (hub_) hub_->close();
    bound_.reset();
  }
  const std::string& endpoint() const { return endpoint_; }

 private:
  std::unique_ptr<InProcessHub> hub_;
  std::unique_ptr<CoordinatorLink> bound_;
  std::string endpoint_;
};

inline Join make_join(const std::string& layer) {
  Join join;
  join.scene_digest = kDigest;
  join.layer = layer;
  join.pid = ::getpid();
  join.host = "here";
  return join;
}

/// Different for every layer, step, row and node.
inline double tell(int layer, std::int64_t step, Eigen::Index row, Eigen::Index node) {
  return static_cast<double>(((layer * 1000003 + step) * 3 + row) * 100000 + node);
}

inline void fill(mechanics::NodalVectors& a, Eigen::Index n, int layer, std::int64_t step) {
  a.resize(3, n);
  for (Eigen::Index r = 0; r < 3; ++r)
    for (Eigen::Index i = 0; i < n; ++i) a(r, i) = tell(layer, step, r, i);
}

inline bool is_filled(const mechanics::NodalVectors& a, Eigen::Index n, int layer, std::int64_t step) {
  mechanics::NodalVectors b;
  fill(b, n, layer, step);
  return a.cols() == n && (a == b).all();
}

inline Motion make_motion(int layer, Eigen::Index n, std::int64_t step) {
  Motion motion;
  motion.step = step;
  motion.vote = 1e-7;
  fill(motion.position, n, layer, step);
  return motion;
}

inline Force make_force(int layer, Eigen::Index n, std::int64_t step, bool last = false) {
  Force force;
  force.step = step;
  force.time = 1e-7 * static_cast<double>(step);
  force.next_dt = 1e-7;
  force.last = last;
  fill(force.force, n, layer + 100, step);
  return force;
}

template <typename Derived>
bool same_bits(const Eigen::DenseBase<Derived>& a, const Eigen::DenseBase<Derived>& b) {
  const auto& x = a.derived();
  const auto& y = b.derived();
  return x.rows() == y.rows() && x.cols() == y.cols() &&
         (x.size() == 0 || std::memcmp(x.data(), y.data(), sizeof(double) * static_cast<std::size_t>(x.size())) == 0);
}

/// Collects what is logged while it lives.
class LogCapture {
 public:
  LogCapture() : before_(spdlog::default_logger()) {
    spdlog::set_default_logger(
        std::make_shared<spdlog::logger>("test", std::make_shared<spdlog::sinks::ostream_sink_mt>(text_)));
  }
  ~LogCapture() { spdlog::set_default_logger(before_); }
  /// @pre nobody is logging
  std::string text() const { return text_.str(); }
  int count(const std::string& word) const {
    int n = 0;
    const std::string all = text();
    for (auto at = all.find(word); at != std::string::npos; at = all.find(word, at + 1)) ++n;
    return n;
  }

 private:
  std::ostringstream text_;
  std::shared_ptr<spdlog::logger> before_;
};

/// Sentence of the exception E that `call` throws; fails the test if it throws none.
template <typename E, typename Call>
std::string get_message(Call&& call) {
  try {
    call();
  } catch (const E& e) {
    return e.what();
  }
  ADD_FAILURE() << "nothing was thrown";
  return "";
}

/// The sentence with which the coordinator refuses a join; it must see no event from it.
template <typename Answer = Refused>
std::string get_refusal(Table& table, const Join& join) {
  auto link = table.connect();
  std::string said;
  std::atomic<bool> done{false};
  std::thread joining([&] {
    said = get_message<Answer>([&] { link->join(join, kPatience); });
    done = true;
  });
  while (!done) EXPECT_EQ(table.coordinator().receive(0.01).kind, Event::Kind::None);
  joining.join();
  return said;
}

/// Joins and leaves the Joined event taken.
inline std::unique_ptr<SolverLink> join_as(Table& table, const std::string& layer) {
  auto link = table.connect();
  std::thread joining([&] { link->join(make_join(layer), kPatience); });
  const Event event = table.coordinator().receive(kPatience);
  joining.join();
  EXPECT_EQ(event.kind, Event::Kind::Joined);
  return link;
}

/// Steps 0 to `last` of one solver; true if every force was its own.
inline bool advance(SolverLink& link, int layer, Eigen::Index n, std::int64_t last) {
  Force force;
  for (std::int64_t step = 0; step <= last; ++step) {
    link.send(make_motion(layer, n, step));
    link.receive(force, kPatience);
    if (force.step != step || !is_filled(force.force, n, layer + 100, step)) return false;
  }
  return true;
}

/// Answers until each of `peers` has done `last`. False if anything else happens or an array is not its own.
inline bool answer_all(CoordinatorLink& coordinator, int peers, Eigen::Index n, std::int64_t last) {
  for (int done = 0; done < peers;) {
    const Event event = coordinator.receive(kPatience);
    if (event.kind == Event::Kind::Joined) continue;
    if (event.kind != Event::Kind::Moved) return false;
    const Motion& motion = coordinator.motion(event.who);
    if (!is_filled(motion.position, n, event.who, motion.step)) return false;
    if (!coordinator.send(event.who, make_force(event.who, n, motion.step))) return false;
    if (motion.step == last) ++done;
  }
  return true;
}

}  // namespace interply::exchange
