#pragma once

#include "haptics/session/remembered_lines.hpp"

namespace palpate {

class Device;
struct DeviceOptions;

/// What the proofs of GPUs have shown, by GPU, driver, subgroup size and compiled shaders: once for each.
class GpuProofs : public RememberedLines {
 public:
  explicit GpuProofs(std::filesystem::path file = usualFile("proofs"));

  /// The GPU, its driver and the shaders, on one line.
  static std::string keyOf(const Device& device);
  /// A remembered proof: the names of the primitives that are wrong, with commas, or kNoProof; empty if the GPU is
  /// right.
  std::optional<std::string> recall(const Device& device, const std::function<void(std::string_view)>& damaged) const;
  /// `wrong`: as recalled.
  void remember(const Device& device, std::string_view wrong) const;
};

/// For a proof that ended without a result: the driver hangs, or ends its program.
inline constexpr std::string_view kNoProof = "no-answer";

/// The back end of a GPU calls it before its first session in real time, whose force a person may feel: returns the
/// names of the primitives that are wrong.
using ProveGpu = std::function<std::string(Device&)>;
/// Recalls the proof; otherwise `run` finds it out, and it is remembered.
std::string wrongOn(const Device& device, const GpuProofs& proofs, const std::function<void(std::string_view)>& damaged,
                    const std::function<std::string()>& run);
/// A proof in this process, within kProofWait_s, for wrongOn(). A driver that crashes ends the program.
std::string proveHere(const DeviceOptions& gpu);

}  // namespace palpate
