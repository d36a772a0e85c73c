/// The links of exchange, as a run uses them.
#include <unistd.h>

#include <stdexcept>
#include <vector>

#include "bench/carriers.hpp"
#include "exchange/in_process.hpp"
#include "exchange/zeromq.hpp"

namespace interply::bench {
namespace {

constexpr double kPatience = 20;  ///< s that a peer waits; the hub gives up earlier

std::vector<exchange::Expected> list_expected(const StarSize& size) {
  std::vector<exchange::Expected> expected;
  for (int p = 0; p < size.peers; ++p) expected.push_back({"layer_" + std::to_string(p), size.nodes});
  return expected;
}

class LinkPeer final : public Peer {
 public:
  LinkPeer(const StarSize& size, int peer, std::unique_ptr<exchange::SolverLink> link) : link_(std::move(link)) {
    motion_.position.setZero(3, size.nodes);
    force_.force.setZero(3, size.nodes);
    link_->join({.layer = list_expected(size)[static_cast<std::size_t>(peer)].layer, .pid = ::getpid(), .host = "here"},
                kPatience);
  }
  double* motion() override { return motion_.position.data(); }
  const double* force() override { return force_.force.data(); }
  bool exchange(std::int64_t step) override {
    motion_.step = step;
    link_->send(motion_);
    link_->receive(force_, kPatience);
    return force_.last;
  }
  void finish() override { link_->send(exchange::Final{}); }

 private:
  std::unique_ptr<exchange::SolverLink> link_;
  exchange::Motion motion_;
  exchange::Force force_;
};

/// The hub over a coordinator's link, which the kinds below own.
class LinkHub : public Hub {
 public:
  LinkHub(const StarSize& size, Watch watch)
      : size_(size), watch_(std::move(watch)), force_(static_cast<std::size_t>(size.peers)) {
    for (auto& f : force_) f.force.setZero(3, size.nodes);
  }
  void accept() override { await(exchange::Event::Kind::Joined); }
  void gather(std::int64_t) override { await(exchange::Event::Kind::Moved); }
  const double* motion(int peer) override { return link().motion(peer).position.data(); }
  double* force(int peer) override { return force_[static_cast<std::size_t>(peer)].force.data(); }
  void scatter(std::int64_t step, bool last) override {
    for (int p = 0; p < size_.peers; ++p) {
      exchange::Force& force = force_[static_cast<std::size_t>(p)];
      force.step = step;
      force.last = last;
      if (!link().send(p, force)) throw std::runtime_error("a peer has left");
    }
  }
  void finish() override { await(exchange::Event::Kind::Ended); }

 protected:
  virtual exchange::CoordinatorLink& link() = 0;
  const StarSize size_;

 private:
  /// One event of this kind from every peer. Motions of quick peers may come while others still join.
  void await(exchange::Event::Kind kind) {
    int& counted = seen_[static_cast<int>(kind)];
    while (counted < size_.peers) {
      const exchange::Event event = link().receive(kSlice);
      if (event.kind == exchange::Event::Kind::None) {
        watch_();
      } else if (event.kind == exchange::Event::Kind::Failed || event.kind == exchange::Event::Kind::Suspect ||
                 event.kind == exchange::Event::Kind::Cancelled) {
        throw std::runtime_error(event.message);
      } else {
        ++seen_[static_cast<int>(event.kind)];
      }
    }
    counted = 0;
  }

  Watch watch_;
  std::vector<exchange::Force> force_;
  int seen_[8] = {};
};

class InProcessStar final : public LinkHub {
 public:
  InProcessStar(const StarSize& size, const Watch& watch) : LinkHub(size, watch), hub_(0, list_expected(size)) {}
  std::unique_ptr<Peer> connect_thread(int peer) override {
    return std::make_unique<LinkPeer>(size_, peer, hub_.connect());
  }

 private:
  exchange::CoordinatorLink& link() override { return hub_.coordinator(); }
  exchange::InProcessHub hub_;
};

class BoundStar final : public LinkHub {
 public:
  BoundStar(const StarSize& size, const Watch& watch, std::unique_ptr<exchange::CoordinatorLink> bound,
            std::string address)
      : LinkHub(size, watch), bound_(std::move(bound)), address_(std::move(address)) {}
  std::string address() const override { return address_; }

 private:
  exchange::CoordinatorLink& link() override { return *bound_; }
  std::unique_ptr<exchange::CoordinatorLink> bound_;
  std::string address_;
};

std::unique_ptr<Hub> make_bound_hub(const StarSize& size, const std::string& address, const Watch& watch,
                                    exchange::ArraysBy arrays = exchange::ArraysBy::Mailbox) {
  auto bound = exchange::bind_zeromq(address, {}, list_expected(size), arrays);
  std::string endpoint = exchange::get_endpoint(*bound);
  return std::make_unique<BoundStar>(size, watch, std::move(bound), std::move(endpoint));
}

}  // namespace

std::unique_ptr<Hub> make_in_process_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return std::make_unique<InProcessStar>(size, watch);
}
std::unique_ptr<Hub> make_shared_memory_hub(const StarSize& size, const std::string& folder, const Watch& watch) {
  return make_bound_hub(size, "shm://" + folder + "/link", watch);
}
std::unique_ptr<Hub> make_zeromq_ipc_hub(const StarSize& size, const std::string& folder, const Watch& watch) {
  return make_bound_hub(size, "ipc://" + folder + "/link", watch);
}
std::unique_ptr<Hub> make_zeromq_tcp_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return make_bound_hub(size, "tcp://127.0.0.1:*", watch, exchange::ArraysBy::Messages);
}
std::unique_ptr<Hub> make_sockets_hub(const StarSize& size, const std::string&, const Watch& watch) {
  return make_bound_hub(size, "tcp://127.0.0.1:*", watch);
}
std::unique_ptr<Peer> connect_link(const StarSize& size, int peer, const std::string& address, const Watch&) {
  return std::make_unique<LinkPeer>(size, peer, exchange::connect_zeromq(address));
}

}  // namespace interply::bench
