/// The link between processes. No zmq headers here. The address chooses the carrier of Motion and Force:
///
///     shm://path        shared memory (mailbox.hpp): processes of one user on one host; the fastest
///     ipc://path        messages over a Unix socket: one host
///     tcp://host:port   sockets of their own (socket_mail.hpp), at the next port: any hosts
///
/// Everything else travels as messages over ZeroMQ, `shm` having the socket of `ipc` at the same path. A solver that
/// says `ipc`, or cannot reach the memory (another user, another container) or the second port (a firewall), takes part
/// with messages among the others. Same bits on every way.
///
/// A solver or recorder is a DEALER, the coordinator a ROUTER; a message is one frame (wire.hpp). Each connection has an identity
/// of its own, which becomes a participant by an accepted Join and can never be taken over. A solver connects as often
/// as it takes until it has joined and never again after that: whoever loses its connection has lost its place, so
/// nothing stale can arrive. Deaths are noticed at once because the kernel closes the connection of a dead process; a
/// stopped or hanging one keeps its connection and is found by the deadlines of whoever waits. Over TCP a cut link, a host
/// that is gone and a stopped process are also found by their silence: who only computes still gives signs of life. On
/// one host nothing cuts a link, and whoever was stopped together with all others (Ctrl-Z) is silent without being lost.
#pragma once

#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "exchange/link.hpp"

namespace interply::exchange {

inline constexpr double kNoLimit = std::numeric_limits<double>::infinity();

/// A solver's end. The coordinator may bind later; join() waits for it.
/// @param silence  over TCP: s without a sign of life of the coordinator after which it counts as lost
/// @throws BadAddress (address.hpp)
std::unique_ptr<SolverLink> connect_zeromq(const std::string& address, double silence = kNoLimit);

/// A recorder's end, likewise.
std::unique_ptr<RecorderLink> connect_recorder(const std::string& address, double silence = kNoLimit);

/// What Motion and Force may travel by.
enum class ArraysBy {
  Mailbox,  ///< what the address has to offer
  Messages  ///< like everything else
};

/// The coordinator's end, bound to exactly what `address` says ("tcp://127.0.0.1:*" takes a free port).
/// @param welcome   what everyone accepted is told; a Join must know no scene or the one of `welcome.scene_digest`
/// @param recorder  a recorder takes part, too
/// @param silence   over TCP: s without a sign of life of a participant after which it counts as lost
/// @throws std::runtime_error if the address cannot be bound
std::unique_ptr<CoordinatorLink> bind_zeromq(const std::string& address, Welcome welcome,
                                             std::vector<Expected> expected, ArraysBy arrays = ArraysBy::Mailbox,
                                             bool recorder = false, double silence = kNoLimit);

/// What a link of bind_zeromq() is really bound to, e.g. "tcp://127.0.0.1:40123".
/// @throws std::bad_cast for any other link
std::string get_endpoint(const CoordinatorLink& link);

}  // namespace interply::exchange
