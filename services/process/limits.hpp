/// What the machine lets a process have, asked for before work begins: libraries abort when it is missing later.
#pragma once

#include <cstdint>

namespace interply::process {

/// @throws std::runtime_error if so many files cannot be open at once (ulimit -n); a soft limit is raised as needed
void require_descriptors(int needed);

/// @throws std::runtime_error if the process may not have so much address space, bytes (ulimit -v)
void require_address_space(std::int64_t needed);

}  // namespace interply::process
