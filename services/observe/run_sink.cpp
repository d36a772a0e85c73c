#include "observe/run_sink.hpp"

namespace interply::observe {

std::unique_ptr<Sink> make_watch_sink(bool published, const DdsOptions& options) {
  if (!published) return std::make_unique<NullSink>();
  return std::make_unique<DdsSink>(options);
}

}  // namespace interply::observe
