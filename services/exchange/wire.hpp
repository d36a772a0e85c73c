/// Messages as bytes. One message is one frame, all of it little-endian:
///
///   offset 0   u32  magic "IPW" and the wire version in the highest byte
///          4   u32  length of the Protobuf header (proto/exchange.proto, message Header)
///          8        Protobuf header, zero padded to a multiple of 8
///          .   f64  arrays: Motion: position [3 x n_nodes], thickness [n_thickness]; Force: force [3 x n_nodes]
///          .   u8   payload of a Sample
///
/// Arrays travel bit for bit, NaN included: a NaN is a matter of mechanics, not of the format.
#pragma once

#include <google/protobuf/arena.h>

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

#include "exchange/link.hpp"
#include "exchange/mailbox.hpp"

namespace interply::wire {
class Header;
}

namespace interply::exchange {

/// Bytes that are no message: one sentence that says why.
class Malformed : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

/// Messages that no caller of a link sees.
struct Refusal {
  std::string sentence;
};
struct Failure {
  std::string message;
  StopReason reason = StopReason::Diverged;
};
struct Received {};  ///< answers Failure and Final
struct Stop {
  StopReason reason = StopReason::Cancelled;
  std::string message;
};

enum class MessageKind { Join, Welcome, Refusal, Motion, Force, Final, Failure, Received, Stop, Sample, Recorded };

using Bytes = std::span<const std::byte>;

/// Largest frame of a layer with `n_nodes` nodes, bytes.
std::int64_t compute_frame_limit(std::int64_t n_nodes);
/// Largest frame of a sample of so many bytes.
std::int64_t compute_sample_limit(std::int64_t payload);

/// Writes messages into one buffer that is reused: no allocation once it has seen the largest.
class Encoder {
 public:
  Encoder();
  /// The frame; valid until the next call.
  Bytes encode(const Join& join);
  Bytes encode(const Welcome& welcome, const MailOffer& mailbox = {});
  Bytes encode(const Refusal& refusal);
  Bytes encode(const Motion& motion);
  Bytes encode(const Force& force);
  Bytes encode(const Final& final);
  Bytes encode(const Failure& failure);
  Bytes encode(const Received& received);
  Bytes encode(const Stop& stop);
  Bytes encode(const Sample& sample);
  Bytes encode(const Recorded& recorded);

 private:
  wire::Header& start();
  std::byte* write(const wire::Header& header, std::size_t array_bytes);
  Bytes finish() const;

  std::array<char, 4096> block_;
  google::protobuf::Arena arena_;  ///< on `block_`, so that a header costs no allocation
  std::vector<std::byte> buffer_;
  std::size_t size_ = 0;
};

/// Reads one frame at a time. open() checks everything that can be wrong; read() only copies.
class Decoder {
 public:
  Decoder();
  /// @throws Malformed. The frame must stay in place until the last read().
  MessageKind open(Bytes frame);

  /// Of an opened Motion or Force.
  std::int64_t step() const;
  std::int64_t n_nodes() const;
  std::int64_t n_thickness() const;

  /// @pre open() returned the kind that is read. Arrays are overwritten without allocation once sized.
  void read(Join& join) const;
  void read(Welcome& welcome) const;
  /// Of a Welcome. Nothing: it has none.
  void read(MailOffer& mailbox) const;
  void read(Refusal& refusal) const;
  void read(Motion& motion) const;
  void read(Force& force) const;
  void read(Final& final) const;
  void read(Failure& failure) const;
  void read(Stop& stop) const;
  /// The payload stays in the frame.
  void read(Sample& sample) const;
  void read(Recorded& recorded) const;

 private:
  std::array<char, 4096> block_;
  google::protobuf::Arena arena_;
  const wire::Header* header_ = nullptr;  ///< in the arena
  const std::byte* arrays_ = nullptr;     ///< in the frame
  std::size_t array_bytes_ = 0;
};

}  // namespace interply::exchange
