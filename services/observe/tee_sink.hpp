/// Two sinks as one: the record of a run and whoever watches it.
#pragma once

#include <memory>
#include <utility>

#include "observe/frames.hpp"

namespace interply::observe {

class TeeSink : public Sink {
 public:
  TeeSink(std::unique_ptr<Sink> record, std::unique_ptr<Sink> watchers)
      : record_(std::move(record)), watchers_(std::move(watchers)) {}
  void put(const RunHeader& a) override { put_both(a); }
  void put(const LayerMesh& a) override { put_both(a); }
  void put(const LayerFrame& a) override { put_both(a); }
  void put(const InterfaceFrame& a) override { put_both(a); }
  void put(const ToolFrame& a) override { put_both(a); }
  void put(const HistoryRow& a) override { put_both(a); }
  void put(const RunEnd& a) override { put_both(a); }
  bool flush(double seconds) override { return record_->flush(seconds) & watchers_->flush(seconds); }
  std::string failure() const override { return record_->failure(); }

 private:
  template <typename T>
  void put_both(const T& a) {
    record_->put(a);
    watchers_->put(a);
  }
  std::unique_ptr<Sink> record_, watchers_;
};

}  // namespace interply::observe
