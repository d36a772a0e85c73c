#include "exchange/wire.hpp"

#include <fmt/format.h>

#include <bit>
#include <cstring>

#include "exchange.pb.h"

namespace interply::exchange {

static_assert(std::endian::native == std::endian::little && sizeof(double) == 8, "arrays travel as they lie in memory");

namespace {

constexpr std::uint32_t kMagic = 0x575049;  // "IPW"
constexpr std::uint32_t kWireVersion = 2;
constexpr std::size_t kPrefix = 8;
constexpr std::size_t kHeaderLimit = 1 << 20;

constexpr std::size_t round_up(std::size_t n) { return (n + 7) / 8 * 8; }

google::protobuf::ArenaOptions on_block(std::array<char, 4096>& block) {
  google::protobuf::ArenaOptions options;
  options.initial_block = block.data();
  options.initial_block_size = block.size();
  return options;
}

template <typename Array>
std::byte* put(std::byte* to, const Array& a) {
  const std::size_t bytes = sizeof(*a.data()) * static_cast<std::size_t>(a.size());
  if (bytes > 0) std::memcpy(to, a.data(), bytes);
  return to + bytes;
}

template <typename Array>
const std::byte* get(const std::byte* from, Array& a) {
  const std::size_t bytes = sizeof(double) * static_cast<std::size_t>(a.size());
  if (bytes > 0) std::memcpy(a.data(), from, bytes);
  return from + bytes;
}

void put(wire::Energies& to, const LayerEnergies& e) {
  to.set_kinetic(e.kinetic);
  to.set_internal(e.internal);
  to.set_internal_work(e.internal_work);
  to.set_contact_work(e.contact_work);
}

LayerEnergies get(const wire::Energies& e) {
  return {.kinetic = e.kinetic(),
          .internal = e.internal(),
          .internal_work = e.internal_work(),
          .contact_work = e.contact_work()};
}

wire::Stop::Reason to_wire(StopReason reason) {
  return static_cast<wire::Stop::Reason>(static_cast<int>(reason) + 1);
}

bool is_known(wire::Stop::Reason reason) { return reason >= wire::Stop::DIVERGED && reason <= wire::Stop::FAILED; }

StopReason from_wire(wire::Stop::Reason reason) { return static_cast<StopReason>(static_cast<int>(reason) - 1); }

/// Checks that exactly the announced doubles follow the header; careful with counts that would overflow.
void check_arrays(std::int64_t n_nodes, std::int64_t n_thickness, std::size_t bytes) {
  if (n_nodes < 0 || (n_thickness != 0 && n_thickness != n_nodes))
    throw Malformed(fmt::format("message announces {} nodes with {} thicknesses", n_nodes, n_thickness));
  const std::size_t per_node = n_thickness > 0 ? 4 * sizeof(double) : 3 * sizeof(double);
  if (bytes % per_node != 0 || bytes / per_node != static_cast<std::size_t>(n_nodes))
    throw Malformed(
        fmt::format("message announces {} nodes of {} bytes but carries {} bytes of arrays", n_nodes, per_node, bytes));
}

}  // namespace

std::int64_t compute_frame_limit(std::int64_t n_nodes) {
  return static_cast<std::int64_t>(kPrefix + kHeaderLimit) + 32 * n_nodes;
}

std::int64_t compute_sample_limit(std::int64_t payload) {
  return static_cast<std::int64_t>(kPrefix + kHeaderLimit) + payload;
}

Encoder::Encoder() : arena_(on_block(block_)) {}

wire::Header& Encoder::start() {
  arena_.Reset();
  return *google::protobuf::Arena::CreateMessage<wire::Header>(&arena_);
}

std::byte* Encoder::write(const wire::Header& header, std::size_t array_bytes) {
  const std::size_t length = header.ByteSizeLong();
  if (length > kHeaderLimit) throw std::length_error(fmt::format("message header of {} bytes is too long", length));
  const std::size_t arrays = kPrefix + round_up(length);
  size_ = arrays + array_bytes;
  if (buffer_.size() < size_) buffer_.resize(size_);
  const std::uint32_t prefix[2] = {kMagic | kWireVersion << 24, static_cast<std::uint32_t>(length)};
  std::memcpy(buffer_.data(), prefix, kPrefix);
  header.SerializeWithCachedSizesToArray(reinterpret_cast<std::uint8_t*>(buffer_.data() + kPrefix));
  std::memset(buffer_.data() + kPrefix + length, 0, arrays - kPrefix - length);
  return buffer_.data() + arrays;
}

Bytes Encoder::finish() const { return {buffer_.data(), size_}; }

Bytes Encoder::encode(const Join& join) {
  auto& header = start();
  auto& to = *header.mutable_join();
  to.set_version(join.version);
  to.set_scene_digest(join.scene_digest);
  to.set_layer(join.layer);
  to.set_pid(join.pid);
  to.set_host(join.host);
  to.set_kind(join.kind);
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Welcome& welcome, const MailOffer& mailbox) {
  auto& header = start();
  auto& to = *header.mutable_welcome();
  to.set_scene_text(welcome.scene_text);
  to.set_scene_digest(welcome.scene_digest);
  to.set_run(welcome.run);
  if (const auto* memory = std::get_if<MemoryOffer>(&mailbox)) {
    auto& offer = *to.mutable_memory();
    offer.set_pid(memory->pid);
    offer.set_memory(memory->memory);
    offer.set_coordinator_bell(memory->coordinator_bell);
    offer.set_solver_bell(memory->solver_bell);
    offer.set_token(memory->token);
    offer.set_offset(memory->offset);
    offer.set_n_nodes(memory->n_nodes);
  } else if (const auto* socket = std::get_if<SocketOffer>(&mailbox)) {
    auto& offer = *to.mutable_socket();
    offer.set_port(socket->port);
    offer.set_token(socket->token);
    offer.set_n_nodes(socket->n_nodes);
  }
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Refusal& refusal) {
  auto& header = start();
  header.mutable_refusal()->set_sentence(refusal.sentence);
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Motion& motion) {
  auto& header = start();
  auto& to = *header.mutable_motion();
  to.set_step(motion.step);
  to.set_vote(motion.vote);
  put(*to.mutable_energies(), motion.energies);
  to.set_step_seconds(motion.step_seconds);
  to.set_wait_seconds(motion.wait_seconds);
  to.set_n_nodes(motion.position.cols());
  to.set_n_thickness(motion.thickness.size());
  const auto doubles = static_cast<std::size_t>(motion.position.size() + motion.thickness.size());
  put(put(write(header, sizeof(double) * doubles), motion.position), motion.thickness);
  return finish();
}

Bytes Encoder::encode(const Force& force) {
  auto& header = start();
  auto& to = *header.mutable_force();
  to.set_step(force.step);
  to.set_time(force.time);
  to.set_next_dt(force.next_dt);
  to.set_frame(force.frame);
  to.set_last(force.last);
  to.set_n_nodes(force.force.cols());
  put(write(header, sizeof(double) * static_cast<std::size_t>(force.force.size())), force.force);
  return finish();
}

Bytes Encoder::encode(const Final& final) {
  auto& header = start();
  auto& to = *header.mutable_final();
  to.set_digest(final.digest);
  put(*to.mutable_energies(), final.energies);
  for (const SummaryItem& item : final.summary) {
    auto& entry = *to.add_summary();
    entry.set_name(item.name);
    entry.set_unit(item.unit);
    entry.set_value(item.value);
  }
  for (const OutsideTrust& passed : final.outside_trust) {
    auto& entry = *to.add_outside_trust();
    entry.set_quantity(passed.quantity);
    entry.set_unit(passed.unit);
    entry.set_meaning(passed.meaning);
    entry.set_limit(passed.limit);
    entry.set_worst(passed.worst);
    entry.set_share(passed.share);
    entry.set_x(passed.x);
    entry.set_y(passed.y);
    entry.set_first_time(passed.first_time);
  }
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Failure& failure) {
  auto& header = start();
  header.mutable_failure()->set_message(failure.message);
  header.mutable_failure()->set_reason(to_wire(failure.reason));
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Received&) {
  auto& header = start();
  header.mutable_received();
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Stop& stop) {
  auto& header = start();
  auto& to = *header.mutable_stop();
  to.set_reason(to_wire(stop.reason));
  to.set_message(stop.message);
  write(header, 0);
  return finish();
}

Bytes Encoder::encode(const Sample& sample) {
  auto& header = start();
  auto& to = *header.mutable_sample();
  to.set_layer(sample.layer);
  to.set_frame(sample.frame);
  put(write(header, sample.payload.size()), sample.payload);
  return finish();
}

Bytes Encoder::encode(const Recorded& recorded) {
  auto& header = start();
  auto& to = *header.mutable_recorded();
  to.set_frames(recorded.frames);
  to.set_rows(recorded.rows);
  to.set_closed(recorded.closed);
  write(header, 0);
  return finish();
}

Decoder::Decoder() : arena_(on_block(block_)) {}

MessageKind Decoder::open(Bytes frame) {
  std::uint32_t prefix[2];
  if (frame.size() < kPrefix) throw Malformed(fmt::format("message of {} bytes is too short", frame.size()));
  std::memcpy(prefix, frame.data(), kPrefix);
  if ((prefix[0] & 0xffffff) != kMagic) throw Malformed("message does not start as an interply message");
  if (prefix[0] >> 24 != kWireVersion)
    throw Malformed(
        fmt::format("message has wire version {}, this build of interply speaks {}: use one build for all "
                    "processes",
                    prefix[0] >> 24, kWireVersion));
  const std::size_t length = prefix[1];
  if (length > kHeaderLimit || kPrefix + round_up(length) > frame.size())
    throw Malformed(fmt::format("message of {} bytes announces a header of {} bytes", frame.size(), length));
  arena_.Reset();
  auto* header = google::protobuf::Arena::CreateMessage<wire::Header>(&arena_);
  header_ = header;
  if (!header->ParseFromArray(frame.data() + kPrefix, static_cast<int>(length)))
    throw Malformed(fmt::format("message has an unreadable header of {} bytes", length));
  arrays_ = frame.data() + kPrefix + round_up(length);
  array_bytes_ = frame.size() - kPrefix - round_up(length);
  if (!header->has_sample()) check_arrays(n_nodes(), n_thickness(), array_bytes_);
  switch (header->kind_case()) {
    case wire::Header::kJoin:
      return MessageKind::Join;
    case wire::Header::kWelcome:
      return MessageKind::Welcome;
    case wire::Header::kRefusal:
      return MessageKind::Refusal;
    case wire::Header::kMotion:
      return MessageKind::Motion;
    case wire::Header::kForce:
      return MessageKind::Force;
    case wire::Header::kFinal:
      return MessageKind::Final;
    case wire::Header::kFailure:
      if (!is_known(header->failure().reason()))
        throw Malformed(fmt::format("failure has the unknown reason {}", int{header->failure().reason()}));
      return MessageKind::Failure;
    case wire::Header::kReceived:
      return MessageKind::Received;
    case wire::Header::kStop:
      if (!is_known(header->stop().reason()))
        throw Malformed(fmt::format("stop message has the unknown reason {}", int{header->stop().reason()}));
      return MessageKind::Stop;
    case wire::Header::kSample:
      return MessageKind::Sample;
    case wire::Header::kRecorded:
      return MessageKind::Recorded;
    case wire::Header::KIND_NOT_SET:
      break;
  }
  throw Malformed("message is of no known kind");
}

std::int64_t Decoder::step() const {
  return header_->has_motion() ? header_->motion().step() : header_->force().step();
}

std::int64_t Decoder::n_nodes() const {
  return header_->has_motion() ? header_->motion().n_nodes() : header_->force().n_nodes();
}

std::int64_t Decoder::n_thickness() const { return header_->motion().n_thickness(); }

void Decoder::read(Join& join) const {
  const auto& from = header_->join();
  join.version = from.version();
  join.scene_digest = from.scene_digest();
  join.layer = from.layer();
  join.pid = from.pid();
  join.host = from.host();
  join.kind = from.kind();
}

void Decoder::read(Welcome& welcome) const {
  const auto& from = header_->welcome();
  welcome.scene_text = from.scene_text();
  welcome.scene_digest = from.scene_digest();
  welcome.run = from.run();
}

void Decoder::read(MailOffer& mailbox) const {
  mailbox = {};
  const auto& from = header_->welcome();
  if (from.has_memory())
    mailbox = MemoryOffer{.pid = from.memory().pid(),
                          .memory = from.memory().memory(),
                          .coordinator_bell = from.memory().coordinator_bell(),
                          .solver_bell = from.memory().solver_bell(),
                          .token = from.memory().token(),
                          .offset = from.memory().offset(),
                          .n_nodes = from.memory().n_nodes()};
  else if (from.has_socket())
    mailbox =
        SocketOffer{.port = from.socket().port(), .token = from.socket().token(), .n_nodes = from.socket().n_nodes()};
}

void Decoder::read(Refusal& refusal) const { refusal.sentence = header_->refusal().sentence(); }

void Decoder::read(Motion& motion) const {
  const auto& from = header_->motion();
  motion.step = from.step();
  motion.vote = from.vote();
  motion.energies = get(from.energies());
  motion.step_seconds = from.step_seconds();
  motion.wait_seconds = from.wait_seconds();
  motion.position.resize(3, from.n_nodes());
  motion.thickness.resize(from.n_thickness());
  get(get(arrays_, motion.position), motion.thickness);
}

void Decoder::read(Force& force) const {
  const auto& from = header_->force();
  force.step = from.step();
  force.time = from.time();
  force.next_dt = from.next_dt();
  force.frame = from.frame();
  force.last = from.last();
  force.force.resize(3, from.n_nodes());
  get(arrays_, force.force);
}

void Decoder::read(Final& final) const {
  const auto& from = header_->final();
  final.digest = from.digest();
  final.energies = get(from.energies());
  final.summary.clear();
  for (const auto& item : from.summary()) final.summary.push_back({item.name(), item.unit(), item.value()});
  final.outside_trust.clear();
  for (const auto& entry : from.outside_trust())
    final.outside_trust.push_back({.quantity = entry.quantity(),
                                   .unit = entry.unit(),
                                   .meaning = entry.meaning(),
                                   .limit = entry.limit(),
                                   .worst = entry.worst(),
                                   .share = entry.share(),
                                   .x = entry.x(),
                                   .y = entry.y(),
                                   .first_time = entry.first_time()});
}

void Decoder::read(Failure& failure) const {
  failure.message = header_->failure().message();
  failure.reason = from_wire(header_->failure().reason());
}

void Decoder::read(Stop& stop) const {
  stop.reason = from_wire(header_->stop().reason());
  stop.message = header_->stop().message();
}

void Decoder::read(Sample& sample) const {
  sample.layer = header_->sample().layer();
  sample.frame = header_->sample().frame();
  sample.payload = {arrays_, array_bytes_};
}

void Decoder::read(Recorded& recorded) const {
  const auto& from = header_->recorded();
  recorded.frames = from.frames();
  recorded.rows = from.rows();
  recorded.closed = from.closed();
}

}  // namespace interply::exchange
