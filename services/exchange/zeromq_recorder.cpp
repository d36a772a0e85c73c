#include "exchange/zeromq.hpp"
#include "exchange/zeromq_client.hpp"

namespace interply::exchange {

namespace {

class ZeromqRecorder final : public RecorderLink {
 public:
  ZeromqRecorder(const std::string& address, double silence) : client_(address, silence) {}

  Welcome join(const Join& join, double deadline) override {
    MailOffer none;
    const Welcome welcome = client_.join(join, deadline, none);
    client_.stage = "before the end of the run";
    return welcome;
  }

  std::optional<Sample> receive(double timeout) override {
    Deadline until(timeout);
    for (;;) {
      if (const auto kind = client_.take()) {
        if (kind != MessageKind::Sample) client_.throw_lost("sent something else than a sample");
        client_.message().read(sample_);
        return sample_;
      }
      if (until.passed()) return {};
      client_.wait(until);
    }
  }

  void send(const Recorded& recorded) override { client_.send(recorded); }

  void send_failure(StopReason reason, const std::string& message) override {
    client_.send_failure({message, reason});
  }

 private:
  ZeromqClient client_;
  Sample sample_;
};

}  // namespace

std::unique_ptr<RecorderLink> connect_recorder(const std::string& address, double silence) {
  return std::make_unique<ZeromqRecorder>(address, silence);
}

}  // namespace interply::exchange
