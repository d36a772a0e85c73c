/// How the mechanics says that a run cannot go on.
#pragma once

#include <stdexcept>
#include <string>

namespace interply::mechanics {

/// Mechanics diverged: names layer, element, time, quantity and a likely cure. The process exits with 3.
class Divergence : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace interply::mechanics
