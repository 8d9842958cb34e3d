#include "haptics/session/gpu_proofs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/checksum.hpp"
#include "engine/gpu/device.hpp"
#include "engine/proof/gpu_proof.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr std::string_view kRight = "right";

constexpr RememberedLines::Kind kKind{.firstLine = "palpate proofs of GPUs, version 1: right, or what is wrong; of",
                                      .what = "proofs of GPUs",
                                      .valueLength = [](std::string_view line) {
                                        const std::size_t end = line.find(' ');
                                        return end == std::string_view::npos ? 0 : end;
                                      }};

// Of all shaders, as the compiler has made them.
std::uint64_t shadersChecksum() {
  static const std::uint64_t all = [] {
    Checksum sum;
    for (const ShaderCode* code : shader_code::compiled) sum.add(std::as_bytes(code->words));
    return sum.value();
  }();
  return all;
}

}  // namespace

GpuProofs::GpuProofs(std::filesystem::path file) : RememberedLines(std::move(file), kKind) {}

std::string GpuProofs::keyOf(const Device& device) {
  const VkPhysicalDeviceProperties& gpu = device.properties();
  return fmt::format("{}, {:#x} {:#x}, driver {} {:#x}, subgroups of {}, shaders {:016x}", device.name(), gpu.vendorID,
                     gpu.deviceID, static_cast<int>(device.driverId()), gpu.driverVersion, device.subgroupSize(),
                     shadersChecksum());
}

std::optional<std::string> GpuProofs::recall(const Device& device,
                                             const std::function<void(std::string_view)>& damaged) const {
  std::optional<std::string> value = RememberedLines::recall(keyOf(device), damaged);
  if (value == kRight) value->clear();
  return value;
}

void GpuProofs::remember(const Device& device, std::string_view wrong) const {
  RememberedLines::remember(keyOf(device), wrong.empty() ? kRight : wrong);
}

std::string wrongOn(const Device& device, const GpuProofs& proofs, const std::function<void(std::string_view)>& damaged,
                    const std::function<std::string()>& run) {
  if (const std::optional<std::string> known = proofs.recall(device, damaged)) return *known;
  std::string wrong = run();
  proofs.remember(device, wrong);
  return wrong;
}

std::string proveHere(const DeviceOptions& gpu) {
  const std::optional<GpuProof> proof = proveWithin(kProofWait_s, gpu);
  return proof ? proof->wrong() : std::string(kNoProof);
}

}  // namespace palpate
