#pragma once

#include <cstdint>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// Pairs of GPU timestamps. Scopes are numbered in the order of recording; their times can be read once the commands
/// have run. If a queue family has no timestamps, every time is 0.
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
  /// 0 if the scope has not run yet.
  double time_us(std::uint32_t scope) const;

 private:
  Device& device_;
  VkQueryPool pool_ = VK_NULL_HANDLE;
  std::uint64_t ticksMask_;  // the valid bits of this queue family's timestamps; 0: none
  std::uint32_t scopes_ = 0;
};

}  // namespace palpate
