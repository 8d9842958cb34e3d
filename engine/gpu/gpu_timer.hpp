#pragma once

#include <cstdint>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// Pairs of GPU timestamps. Scopes are numbered as they are opened during recording; their times are read once the
/// commands have run. Where a queue family keeps no time, every time is 0.
class GpuTimer {
 public:
  static constexpr std::uint32_t kMaxScopes = 256;

  GpuTimer(Device& device, std::uint32_t queueFamily);
  ~GpuTimer();
  GpuTimer(const GpuTimer&) = delete;
  GpuTimer& operator=(const GpuTimer&) = delete;

  void reset(VkCommandBuffer commands);
  std::uint32_t open(VkCommandBuffer commands);
  void close(VkCommandBuffer commands, std::uint32_t scope);
  /// 0 when the scope has not run yet.
  double time_us(std::uint32_t scope) const;

 private:
  Device& device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint64_t ticksMask_;  // the bits of a timestamp that this queue family counts in; 0: none
  std::uint32_t scopes_ = 0;
};

}  // namespace palpate
