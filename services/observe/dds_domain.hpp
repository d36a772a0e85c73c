/// The DDS domain of this process and one participant in it, configured in code. Internal to observe.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "observe/dds.hpp"

namespace interply::observe {

/// Configuration of the domain as Cyclone DDS reads it (XML).
/// @param address  of the interface
std::string make_domain_config(const DdsOptions& options, const std::string& address);

/// A participant; deletes itself and everything created in it. All participants of one process share its domain, which
/// lives as long as the last of them.
class Participant {
 public:
  explicit Participant(const DdsOptions& options);
  ~Participant();
  Participant(const Participant&) = delete;
  Participant& operator=(const Participant&) = delete;
  std::int32_t handle() const { return handle_; }

 private:
  struct Domain;
  static std::shared_ptr<Domain> share_domain(const DdsOptions& options);
  std::shared_ptr<Domain> domain_;
  std::int32_t handle_ = 0;
};

/// `entity` if it is one. @throws std::runtime_error "DDS cannot <action>: <reason>"
std::int32_t check_entity(std::int32_t entity, const std::string& action);

}  // namespace interply::observe
