#pragma once

#include <memory>

#include "engine/proof/gpu_proof.hpp"
#include "haptics/session/remembered_lines.hpp"

namespace palpate {

/// What the proofs of GPUs have shown, by GPU, driver, subgroup size and compiled shaders: once for each.
class GpuProofs : public RememberedLines {
 public:
  explicit GpuProofs(std::filesystem::path file = usualFile("proofs"));

  /// A remembered proof: the names of the primitives that are wrong, with commas, or kNoProof; empty if the GPU is
  /// right.
  std::optional<std::string> recall(const Device& device, const std::function<void(std::string_view)>& damaged) const;
  /// `wrong`: as recalled, with subgroups of that size.
  void remember(const Device& device, std::uint32_t subgroupSize, std::string_view wrong) const;
  /// The subgroup size with which a device of the same GPU is right, if this one has shown to be wrong.
  std::optional<std::uint32_t> substitute(const Device& device) const;

 private:
  static std::string keyOf(const Device& device, std::uint32_t subgroupSize);
};

/// For a proof that ended without a result: the driver hangs, or ends its program.
inline constexpr std::string_view kNoProof = "no-answer";

/// The GPU for sessions: with the subgroup size that is known to be right, if the best one is known to be wrong.
std::unique_ptr<Device> openProven(const DeviceOptions& options);

/// A proof of the device's GPU with each of its subgroup sizes until one is right, each remembered; none after one that
/// hangs. Throws what Device and proveGpu() throw.
struct SizeProof {
  std::uint32_t subgroupSize = 0;
  std::optional<GpuProof> proof;  ///< empty: the driver has not answered for kProofWait_s

  /// As remembered.
  std::string wrong() const { return proof ? proof->wrong() : std::string(kNoProof); }
};
std::vector<SizeProof> proveSizes(const Device& device, const DeviceOptions& options, const ProofOptions& proof = {});

/// The back end of a GPU calls it before its first session in real time, whose force a person may feel: returns the
/// names of the primitives that are wrong.
using ProveGpu = std::function<std::string(Device&)>;
/// Recalls the proof; otherwise `run` finds it out, and it is remembered.
std::string wrongOn(const Device& device, const GpuProofs& proofs, const std::function<void(std::string_view)>& damaged,
                    const std::function<std::string()>& run);

}  // namespace palpate
