#include "observe/run_sink.hpp"

#include <spdlog/spdlog.h>

#include <exception>

namespace interply::observe {

std::unique_ptr<Sink> make_watch_sink(bool published, const DdsOptions& options) {
  try {
    if (published) return std::make_unique<DdsSink>(options);
  } catch (const std::exception& e) {
    spdlog::warn("nobody can watch this process: {}; the run goes on", e.what());
  }
  return std::make_unique<NullSink>();
}

}  // namespace interply::observe
