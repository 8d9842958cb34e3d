#pragma once

#include <cstdint>

#include "engine/gpu/vulkan.hpp"

namespace palpate {

class Device;

/// Pairs of GPU timestamps. Scopes are numbered as they are opened during recording; their times are read once the
/// commands have run.
class GpuTimer {
 public:
  static constexpr std::uint32_t kMaxScopes = 256;

  explicit GpuTimer(Device& device);
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
  std::uint32_t scopes_ = 0;
};

}  // namespace palpate
