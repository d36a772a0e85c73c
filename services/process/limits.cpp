#include "process/limits.hpp"

#include <sys/resource.h>

#include <stdexcept>
#include <string>

namespace interply::process {

void require_descriptors(int needed) {
  rlimit limit{};
  const auto wanted = static_cast<rlim_t>(needed);
  if (::getrlimit(RLIMIT_NOFILE, &limit) != 0 || limit.rlim_cur >= wanted) return;
  if (limit.rlim_max < wanted)
    throw std::runtime_error("only " + std::to_string(limit.rlim_max) + " files may be open at once and this process needs " +
                             std::to_string(needed) + ": raise the limit (ulimit -n)");
  limit.rlim_cur = wanted;
  ::setrlimit(RLIMIT_NOFILE, &limit);
}

void require_address_space(std::int64_t needed) {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  if (limit.rlim_cur < static_cast<rlim_t>(needed))
    throw std::runtime_error("only " + std::to_string(limit.rlim_cur >> 20) +
                             " MiB of address space are allowed and this process needs " +
                             std::to_string(needed >> 20) + ": raise the limit (ulimit -v)");
}

}  // namespace interply::process
