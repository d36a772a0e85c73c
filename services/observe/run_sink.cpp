#include "observe/run_sink.hpp"

#include <spdlog/spdlog.h>

#include <stdexcept>

namespace interply::observe {

std::unique_ptr<Sink> make_watch_sink(bool published, const DdsOptions& options) try {
  if (!published) return std::make_unique<NullSink>();
  return std::make_unique<DdsSink>(options);
} catch (const std::runtime_error& e) {
  spdlog::warn("run {} cannot be watched: {}; it goes on", options.run, e.what());
  return std::make_unique<NullSink>();
}

std::unique_ptr<Sink> make_run_sink(bool recorded, const DdsOptions& options, double deadline) {
  if (!recorded) return std::make_unique<NullSink>();
  auto sink = std::make_unique<DdsSink>(options);
  if (!sink->wait_for_reader(deadline))
    throw std::runtime_error("no recorder for run " + options.run + " appeared within " +
                             std::to_string(static_cast<int>(deadline)) + " s; start interply-recorder --run " +
                             options.run + " --out DIR, or run without a record (record.frames: 0)");
  return sink;
}

}  // namespace interply::observe
