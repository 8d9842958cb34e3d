#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "engine/gpu/buffer.hpp"
#include "engine/gpu/compute_pipeline.hpp"

namespace palpate {

/// Tells how long workgroups live, since work on another queue waits for them to end. While it lives, pipelines that
/// are made use its twins of their shaders, which note the life of their longest invocation; they must go before it.
/// Twins make passes slower.
class WorkgroupWatch {
 public:
  /// `twins`: compiled with PALPATE_WATCHED (shaders/lib/index.glsl), named "watched_" and the name of the other.
  WorkgroupWatch(Device& device, std::span<const ShaderCode* const> twins);
  ~WorkgroupWatch();
  WorkgroupWatch(const WorkgroupWatch&) = delete;
  WorkgroupWatch& operator=(const WorkgroupWatch&) = delete;

  static bool isPossible(const Device& device);

  struct Life {
    std::string pass;
    double longest_us = 0;
  };
  /// Of all that has run and ended, by pass.
  std::vector<Life> longest() const;

  struct Twin {
    const ShaderCode* code;
    DeviceAddress life;  ///< of a word
  };
  /// None where there is no such twin.
  std::optional<Twin> twinOf(const ShaderCode& code) const;

 private:
  Device& device_;
  std::span<const ShaderCode* const> twins_;
  Buffer lives_;  // a word for each twin, in ticks of the device's clock
};

}  // namespace palpate
