// Proves a GPU: its driver runs the primitives of which every pass is made, and their results are compared with known
// ones. What breaks on an unknown driver are sums, sizes and compiled code, not missing features.
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace palpate {

class Device;
struct DeviceOptions;

/// What every pass is made of.
enum class Primitive { sum, ballot, shuffle, barrier, atomic, hostWrite, indirect, sort };
inline constexpr std::array<std::pair<std::string_view, Primitive>, 8> kPrimitives{
    {{"sum", Primitive::sum},               // of a workgroup and of a subgroup, before each invocation and in all
     {"ballot", Primitive::ballot},         // and votes
     {"shuffle", Primitive::shuffle},       // between the invocations of a subgroup
     {"barrier", Primitive::barrier},       // of a workgroup and of a subgroup, and the size of a subgroup
     {"atomic", Primitive::atomic},         // in a buffer and in shared memory
     {"host-write", Primitive::hostWrite},  // seen by the next submission of the same list, and its answer by the host
     {"indirect", Primitive::indirect},     // a dispatch whose size an earlier pass has counted
     {"sort", Primitive::sort}}};           // stable, of pairs

/// One of them, after its run.
struct ProvedPrimitive {
  Primitive primitive = {};
  std::string wrong;                  ///< first result that differs, in words; empty: it is right
  double compile_ms = 0, run_ms = 0;  ///< making its pipelines, and everything else
};

struct GpuProof {
  std::uint32_t subgroupSize = 0;
  std::vector<ProvedPrimitive> primitives;
  /// The names of those that are wrong, with commas and without spaces; empty: the GPU is right.
  std::string wrong() const;
  double run_ms() const;
};

struct ProofOptions {
  std::optional<Primitive> fails;  ///< for tests: this one fails
  /// Called after each primitive.
  std::function<void(const ProvedPrimitive&)> proved = {};
  /// Called before (true) and after the driver translates shaders, which may take long; several threads do so at once.
  std::function<void(bool)> compiles = {};
};

/// Runs all primitives on the device's latency queue. Throws GpuError, and DeviceLost, as any work does.
GpuProof proveGpu(Device& device, const ProofOptions& options = {});

/// The same on a device of its own and on a thread of its own: a driver may hang. Empty once no primitive has ended for
/// `wait_s`, the translation of shaders aside; the thread is then left alone with the driver.
std::optional<GpuProof> proveWithin(double wait_s, const DeviceOptions& gpu, const ProofOptions& options = {});
inline constexpr double kProofWait_s = 2;

}  // namespace palpate
