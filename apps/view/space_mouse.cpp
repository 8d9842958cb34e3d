#include "apps/view/space_mouse.hpp"

#include <algorithm>
#include <utility>

#include "engine/core/error.hpp"
#include "haptics/devices/hid_choice.hpp"

namespace palpate {

SpaceMouse::SpaceMouse() {
  const auto transport = hidapiTransport();
  std::vector<HidCandidate> found = hidCandidates(*transport);
  std::erase_if(found, [](const HidCandidate& one) { return one.kind != HidKind::spaceMouse; });
  if (found.empty()) return;
  const auto usable = std::ranges::find_if(found, &HidCandidate::usable);
  if (usable == found.end()) {
    const HidCandidate& one = found.front();
    remark(fmt::format("{} cannot be used: {}; {}", one.name, one.whyNot, one.mend));
    return;
  }
  try {
    listener_ = std::make_unique<HidListener>(
        transport, usable->info, [this](std::string_view sentence) { remark(sentence); }, "nothing moves");
    remark(fmt::format("{} moves the model; its first button holds the stylus", usable->name));
  } catch (const Error& error) {  // e.g. unplugged at this moment
    remark(error.what());
  }
}

std::optional<PushEvent> SpaceMouse::changed() {
  if (!listener_) return std::nullopt;
  const HidMotion& motion = listener_->now().motion;
  const PushEvent now{motion.push, motion.turn, motion.buttons};
  if (now == last_) return std::nullopt;
  return last_ = now;
}

std::vector<std::string> SpaceMouse::takeRemarks() {
  const std::scoped_lock lock(lock_);
  return std::exchange(remarks_, {});
}

void SpaceMouse::remark(std::string_view sentence) {
  const std::scoped_lock lock(lock_);
  remarks_.emplace_back(sentence);
}

}  // namespace palpate
