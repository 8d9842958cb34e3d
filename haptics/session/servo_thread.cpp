#include "haptics/session/servo_thread.hpp"

namespace palpate {

ServoThread::ServoThread(Session& session, std::span<const OpenHand> hands, const Options& options)
    : feed_(hands.size()), thread_([this, &session, all = std::vector<OpenHand>(hands.begin(), hands.end()), options] {
        run(session, all, options);
      }) {}

void ServoThread::run(Session& session, const std::vector<OpenHand>& hands, const Options& options) {
  try {
    const ServoResult result = session.run(hands, {.rate_Hz = options.rate_Hz,
                                                   .endless = true,
                                                   .stop = &stop_,
                                                   .forcesOn = options.forcesOn,
                                                   .recorder = &feed_,
                                                   .realtime = true,
                                                   .law = options.law});
    deviceFailed_ = result.deviceFailed;
    if (result.deviceFailed) fault_ = result.fault;
    if (result.queryLost) fault_ = session.machine() + " was lost; earlier results are kept";
  } catch (const std::exception& error) {
    fault_ = error.what();
  }
  ended_ = true;
}

void ServoThread::stop() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

}  // namespace palpate
