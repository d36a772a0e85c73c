#include "exchange/mailbox.hpp"

#include <spdlog/spdlog.h>

#include <exception>
#include <random>

#include "exchange/shared_mail.hpp"
#include "exchange/socket_mail.hpp"
#include "exchange/zeromq_socket.hpp"

namespace interply::exchange {

std::uint64_t make_token() {
  std::random_device random;
  return static_cast<std::uint64_t>(random()) << 32 | random();
}

std::unique_ptr<MailRoom> make_mail_room(const std::string& endpoint, const std::vector<Expected>& expected) try {
  if (is_shared_memory(endpoint)) return std::make_unique<SharedMailRoom>(expected);
  if (is_tcp(endpoint)) return std::make_unique<SocketMailRoom>(endpoint, expected);
  return nullptr;
} catch (const std::exception& reason) {
  spdlog::warn("no {} ({}): positions and forces travel as messages",
               is_tcp(endpoint) ? "sockets for arrays" : "shared memory", reason.what());
  return nullptr;
}

std::unique_ptr<Mailbox> open_mailbox(const std::string& address, const MailOffer& offer, int connection) {
  const auto* memory = std::get_if<MemoryOffer>(&offer);
  const auto* socket = std::get_if<SocketOffer>(&offer);
  try {
    if (memory && is_shared_memory(address)) return std::make_unique<SharedMailbox>(*memory);
    if (socket) return std::make_unique<SocketMailbox>(connection, *socket);
  } catch (const std::exception& reason) {
    spdlog::warn("the coordinator's {} cannot be used ({}): positions and forces travel as messages",
                 memory ? "shared memory" : "port for arrays", reason.what());
  }
  return nullptr;
}

}  // namespace interply::exchange
