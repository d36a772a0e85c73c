#include "exchange/zeromq_client.hpp"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>

namespace interply::exchange {

namespace {

constexpr double kFailureDelivery = 2;  ///< s to wait until a failure has arrived

}  // namespace

Welcome ZeromqClient::join(const Join& join, double deadline, MailOffer& offer) {
  send(join);
  Welcome welcome;
  Refusal refusal;
  switch (next(deadline)) {
    case MessageKind::Welcome:
      decoder_.read(welcome);
      decoder_.read(offer);
      return welcome;
    case MessageKind::Refusal:
      decoder_.read(refusal);
      throw Refused(refusal.sentence);
    case MessageKind::Stop:
      throw_stopped();
    default:
      throw CoordinatorLost(fmt::format("the coordinator at {} answered a join with something else", address_));
  }
}

void ZeromqClient::transmit(Bytes frame) {
  if (!socket_.send(frame))
    throw CoordinatorLost(
        fmt::format("cannot send to the coordinator at {} {}: {}", address_, where(), std::strerror(errno)));
}

std::optional<MessageKind> ZeromqClient::take() {
  note_news();
  if (!socket_.receive()) {
    if (lost_) throw_lost("closed the connection");
    return {};
  }
  if (descriptor_ < 0) descriptor_ = socket_.descriptor();
  try {
    return decoder_.open(socket_.frame());
  } catch (const Malformed& malformed) {
    throw CoordinatorLost(fmt::format("the coordinator at {} is not understood: {}", address_, malformed.what()));
  }
}

MessageKind ZeromqClient::next(double deadline) {
  Deadline until(deadline);
  for (;;) {
    if (const auto kind = take()) return *kind;
    if (until.passed()) throw_silent(deadline);
    wait(until);
  }
}

void ZeromqClient::send_failure(const Failure& failure) {
  try {
    send(failure);
    Deadline until(kFailureDelivery);
    while (!until.passed()) {
      const MessageKind kind = next(kFailureDelivery);
      if (kind == MessageKind::Received || kind == MessageKind::Stop) return;
    }
  } catch (const CoordinatorLost&) {
    // nobody is left to be told
  }
}

/// A connection that once stood and ends, or is silent for too long, is lost for good.
void ZeromqClient::note_news() {
  while (const auto news = socket_.next_news()) {
    if (news->connected)
      connected_ = true;
    else if (connected_)
      lost_ = true;
  }
  if (socket_.find_silent({&descriptor_, 1}) >= 0) lost_ = true;
}

void ZeromqClient::throw_stopped() const {
  Stop stop;
  decoder_.read(stop);
  throw Stopped(stop.reason, stop.message);
}

void ZeromqClient::throw_lost(const std::string& what) const {
  throw CoordinatorLost(fmt::format("the coordinator at {} {} {}", address_, what, where()));
}

void ZeromqClient::throw_silent(double deadline) const {
  throw CoordinatorLost(fmt::format("no answer from the coordinator at {} for {:g} s {}", address_, deadline, where()));
}

std::string ZeromqClient::where() const { return step < 0 ? stage : fmt::format("at step {}", step); }

}  // namespace interply::exchange
