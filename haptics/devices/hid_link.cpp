#include "haptics/devices/hid_link.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {
namespace {

constexpr auto kBetweenSearches = std::chrono::milliseconds(500);
constexpr double kSearch_s = std::chrono::duration<double>(kBetweenSearches).count(), kLongestWait_s = 30;
// The system sets the permissions of a new node a moment after creating it.
constexpr double kPatience_s = 3;
constexpr double kFirm_s = 2;  // a device that is lost sooner after it came back is searched for less often

}  // namespace

HidLink::HidLink(std::shared_ptr<HidTransport> transport, HidInfo device, HidRemark remark, std::string whileGone)
    : transport_(std::move(transport)),
      device_(std::move(device)),
      remark_(std::move(remark)),
      whileGone_(std::move(whileGone)),
      wait_s_(kSearch_s) {
  HidOpening opening = transport_->open(device_.path);
  if (!opening.connection)
    throw Error("{} at {} cannot be opened: {}; plug it in again", nameOf(device_), device_.path, opening.why);
  connection_ = std::move(opening.connection);
}

void HidLink::lose() {
  connection_.reset();
  wait_s_ = found_.elapsed_s() < kFirm_s ? std::min(2 * wait_s_, kLongestWait_s) : kSearch_s;
  complained_ = false;
  absent_ = searched_ = Stopwatch();
  remark_(fmt::format("{} was unplugged: {} until it is plugged in again", nameOf(device_), whileGone_));
}

bool HidLink::isSame(const HidInfo& other) const {
  return kindOf(other) == kindOf(device_) && other.vendorId == device_.vendorId &&
         other.productId == device_.productId && other.serial == device_.serial;
}

bool HidLink::find() {
  if (searched_.elapsed_s() < wait_s_) return false;
  searched_ = Stopwatch();
  const std::vector<HidInfo> all = transport_->enumerate();
  const auto it = std::ranges::find_if(all, [this](const HidInfo& other) { return isSame(other); });
  if (it == all.end()) {
    absent_ = Stopwatch();
    return false;
  }
  HidOpening opening = transport_->open(it->path);
  if (!opening.connection) {
    if (absent_.elapsed_s() > kPatience_s && !std::exchange(complained_, true))
      remark_(fmt::format("{} is plugged in again at {}, but cannot be opened: {}; see palpate doctor", nameOf(device_),
                          it->path, opening.why));
    return false;
  }
  device_ = *it;
  connection_ = std::move(opening.connection);
  found_ = Stopwatch();
  remark_(fmt::format("{} is back, at {}", nameOf(device_), device_.path));
  return true;
}

void HidLink::rest(const std::stop_token& stop) {
  std::unique_lock lock(restLock_);
  stopped_.wait_for(lock, stop, kBetweenSearches, [] { return false; });
}

}  // namespace palpate
