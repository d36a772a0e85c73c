/// `interply init`: a scene to begin with.
#pragma once

#include <iosfwd>
#include <string>

namespace interply::launch {

enum class SceneKind { Laminate, Plies, Sheet };

struct InitOptions {
  std::string name;  ///< of the scene; the file is NAME.yaml
  SceneKind kind = SceneKind::Laminate;
};

/// Writes the file and says what to do with it; one that is there stays. Returns the exit code.
int init_command(const InitOptions& options, std::ostream& out);

}  // namespace interply::launch
