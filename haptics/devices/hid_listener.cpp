#include "haptics/devices/hid_listener.hpp"

#include <algorithm>
#include <array>

#include "engine/core/start_thread.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {
namespace {

constexpr double kDeadCap = 0.06, kDeadStick = 0.15;
constexpr int kPatience_ms = 50;  // of a read: how late the listener notices a stop
// A held cap reports continuously; silence for this long means that its release was missed.
constexpr double kReportTimeout_s = 0.5;

bool isPad(const HidInfo& device) { return kindOf(device) == HidKind::dualSense; }

}  // namespace

DVec3 shaped(const DVec3& push, double deadShare) noexcept {
  const double length = glm::length(push);
  if (!(length > deadShare)) return DVec3(0);
  const double share = (std::min(length, 1.0) - deadShare) / (1 - deadShare);
  return share * share * (push / length);
}

HidListener::HidListener(std::shared_ptr<HidTransport> transport, const HidInfo& device, HidRemark remark,
                         std::string whileGone)
    : take_(isPad(device) ? takeDualSenseReport : takeSpaceMouseReport),
      deadShare_(isPad(device) ? kDeadStick : kDeadCap),
      link_(std::move(transport), device, std::move(remark), std::move(whileGone)),
      listener_(startThread([this](const std::stop_token& stop) { listen(stop); })) {}

const HidPush& HidListener::now() noexcept {
  if (const auto report = latest_.load()) last_ = *report;
  return last_;
}

void HidListener::listen(const std::stop_token& stop) {
  std::array<std::uint8_t, 128> report;
  HidMotion motion;
  Stopwatch heard;
  const auto publish = [&](bool plugged) {
    latest_.store({{shaped(motion.push, deadShare_), shaped(motion.turn, deadShare_), motion.buttons}, plugged});
  };
  while (!stop.stop_requested()) {
    HidConnection* connection = link_.connection();
    if (!connection) {
      if (link_.find())
        publish(true);
      else
        link_.rest(stop);
      continue;
    }
    const auto bytes = connection->read(report, kPatience_ms);
    if (!bytes) {
      motion = {};
      publish(false);
      link_.lose();
    } else if (*bytes > 0 && take_({report.data(), std::min(*bytes, report.size())}, motion)) {
      heard = Stopwatch();
      publish(true);
    } else if (heard.elapsed_s() > kReportTimeout_s && (motion.push != DVec3(0) || motion.turn != DVec3(0))) {
      motion.push = motion.turn = DVec3(0);
      publish(true);
    }
  }
}

}  // namespace palpate
