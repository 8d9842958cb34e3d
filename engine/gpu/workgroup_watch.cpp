#include "engine/gpu/workgroup_watch.hpp"

#include <algorithm>
#include <chrono>
#include <string_view>
#include <thread>

#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"

namespace palpate {

namespace {

constexpr std::string_view kPrefix = "watched_";

std::string_view plainName(const ShaderCode& twin) { return std::string_view(twin.name).substr(kPrefix.size()); }

const ShaderCode& clockIn(std::span<const ShaderCode* const> twins) {
  const auto found =
      std::ranges::find(twins, "gpu_read_clock", [](const ShaderCode* twin) { return plainName(*twin); });
  PALPATE_CHECK(found != twins.end());
  return **found;
}

}  // namespace

WorkgroupWatch::WorkgroupWatch(Device& device, std::span<const ShaderCode* const> twins)
    : device_(device),
      twins_(twins),
      lives_(Buffer::of<std::uint32_t>(device, twins.size(), Memory::device, "workgroup lives")),
      ticks_(Buffer::of<std::uint32_t>(device, 2, Memory::device, "clock")),
      clock_(device, clockIn(twins), {.workgroupSize = 32, .pushBytes = sizeof(DeviceAddress)}) {
  PALPATE_CHECK(isPossible(device));
  upload(device, device.throughputQueue(), lives_, std::vector<std::uint32_t>(twins.size(), 0));
  device_.pipelines().watchBy(this);
  firstTick_ = readClock();
  sinceFirst_ = {};
}

WorkgroupWatch::~WorkgroupWatch() { device_.pipelines().watchBy(nullptr); }

bool WorkgroupWatch::isPossible(const Device& device) { return device.hasClock(); }

std::uint64_t WorkgroupWatch::readClock() const {
  CommandList list(device_, device_.throughputQueue(), "clock");
  list.begin();
  list.dispatch(clock_, 1, ticks_.address());
  list.end();
  device_.throughputQueue().run(list);
  const auto ticks = download<std::uint32_t>(device_, device_.throughputQueue(), ticks_, 2);
  return std::uint64_t{ticks[1]} << 32 | ticks[0];
}

double WorkgroupWatch::tick_ns() const {
  constexpr double kMinSpan_s = 0.1;  // a submission's delay differs by less than a thousandth of that
  if (const double left_s = kMinSpan_s - sinceFirst_.elapsed_s(); left_s > 0)
    std::this_thread::sleep_for(std::chrono::duration<double>(left_s));
  const std::uint64_t tick = readClock();
  return 1e9 * sinceFirst_.elapsed_s() / static_cast<double>(tick - firstTick_);
}

std::vector<WorkgroupWatch::Life> WorkgroupWatch::longest() const {
  const double tick_ns = this->tick_ns();
  const auto ticks = download<std::uint32_t>(device_, device_.throughputQueue(), lives_, twins_.size());
  std::vector<Life> lives;
  for (std::size_t i = 0; i < twins_.size(); ++i)
    if (ticks[i] > 0) lives.push_back({std::string(plainName(*twins_[i])), 1e-3 * ticks[i] * tick_ns});
  return lives;
}

std::optional<WorkgroupWatch::Twin> WorkgroupWatch::twinOf(const ShaderCode& code) const {
  for (std::size_t i = 0; i < twins_.size(); ++i)
    if (plainName(*twins_[i]) == code.name) return Twin{twins_[i], lives_.address() + i * sizeof(std::uint32_t)};
  return std::nullopt;
}

}  // namespace palpate
