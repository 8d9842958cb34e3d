#include "engine/gpu/workgroup_watch.hpp"

#include <string_view>

#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr std::string_view kPrefix = "watched_";

std::string_view plainName(const ShaderCode& twin) { return std::string_view(twin.name).substr(kPrefix.size()); }

}  // namespace

WorkgroupWatch::WorkgroupWatch(Device& device, std::span<const ShaderCode* const> twins)
    : device_(device),
      twins_(twins),
      lives_(Buffer::of<std::uint32_t>(device, twins.size(), Memory::device, "workgroup lives")) {
  PALPATE_CHECK(isPossible(device));
  upload(device, device.throughputQueue(), lives_, std::vector<std::uint32_t>(twins.size(), 0));
  device_.pipelines().watchBy(this);
}

WorkgroupWatch::~WorkgroupWatch() { device_.pipelines().watchBy(nullptr); }

bool WorkgroupWatch::isPossible(const Device& device) { return device.hasClock(); }

std::vector<WorkgroupWatch::Life> WorkgroupWatch::longest() const {
  const auto ticks = download<std::uint32_t>(device_, device_.throughputQueue(), lives_, twins_.size());
  std::vector<Life> lives;
  for (std::size_t i = 0; i < twins_.size(); ++i)
    if (ticks[i] > 0)
      lives.push_back({std::string(plainName(*twins_[i])), 1e-3 * ticks[i] * device_.timestampPeriod_ns()});
  return lives;
}

std::optional<WorkgroupWatch::Twin> WorkgroupWatch::twinOf(const ShaderCode& code) const {
  for (std::size_t i = 0; i < twins_.size(); ++i)
    if (plainName(*twins_[i]) == code.name) return Twin{twins_[i], lives_.address() + i * sizeof(std::uint32_t)};
  return std::nullopt;
}

}  // namespace palpate
