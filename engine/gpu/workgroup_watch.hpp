#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/core/clock.hpp"
#include "engine/gpu/buffer.hpp"
#include "engine/gpu/compute_pipeline.hpp"

namespace palpate {

/// Measures the lifetime of workgroups, since work on another queue waits for them to end. While it lives, newly made
/// pipelines use the twins of their shaders, which record the lifetime of their longest invocation; those pipelines
/// must be destroyed before it. Twins make passes slower.
class WorkgroupWatch {
 public:
  /// `twins`: compiled with PALPATE_WATCHED (shaders/lib/index.glsl), named "watched_" plus the name of the original;
  /// one of them is gpu/read_clock.comp.
  WorkgroupWatch(Device& device, std::span<const ShaderCode* const> twins);
  ~WorkgroupWatch();
  WorkgroupWatch(const WorkgroupWatch&) = delete;
  WorkgroupWatch& operator=(const WorkgroupWatch&) = delete;

  static bool isPossible(const Device& device);

  struct Life {
    std::string pass;
    double longest_us = 0;
  };
  /// Longest life among all completed invocations, by pass. Waits until the watch has lived for a tenth of a second.
  std::vector<Life> longest() const;

  struct Twin {
    const ShaderCode* code;
    DeviceAddress life;  ///< address of a word
  };
  /// Empty if the shader has no twin.
  std::optional<Twin> twinOf(const ShaderCode& code) const;

 private:
  std::uint64_t readClock() const;
  double tick_ns() const;

  Device& device_;
  std::span<const ShaderCode* const> twins_;
  Buffer lives_;  // a word for each twin, in ticks of the device's clock
  Buffer ticks_;
  ComputePipeline clock_;
  // The clock's period is measured, since VK_KHR_shader_clock states none: timestampPeriod is that of timestamps only.
  std::uint64_t firstTick_ = 0;
  Stopwatch sinceFirst_;
};

}  // namespace palpate
