#include "haptics/session/gpu_proofs.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "engine/core/checksum.hpp"
#include "engine/gpu/device.hpp"
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

std::string GpuProofs::keyOf(const Device& device, std::uint32_t subgroupSize) {
  const VkPhysicalDeviceProperties& gpu = device.properties();
  return fmt::format("{}, {:#x} {:#x}, driver {} {:#x}, subgroups of {}, shaders {:016x}", device.name(), gpu.vendorID,
                     gpu.deviceID, static_cast<int>(device.driverId()), gpu.driverVersion, subgroupSize,
                     shadersChecksum());
}

std::optional<std::string> GpuProofs::recall(const Device& device,
                                             const std::function<void(std::string_view)>& damaged) const {
  std::optional<std::string> value = RememberedLines::recall(keyOf(device, device.subgroupSize()), damaged);
  if (value == kRight) value->clear();
  return value;
}

void GpuProofs::remember(const Device& device, std::uint32_t subgroupSize, std::string_view wrong) const {
  RememberedLines::remember(keyOf(device, subgroupSize), wrong.empty() ? kRight : wrong);
}

std::optional<std::uint32_t> GpuProofs::substitute(const Device& device) const {
  const auto known = [&](std::uint32_t size) { return RememberedLines::recall(keyOf(device, size), [](auto) {}); };
  const auto own = known(device.subgroupSize());
  if (!own || own == kRight) return std::nullopt;
  for (const std::uint32_t size : device.subgroupSizes())
    if (known(size) == kRight) return size;
  return std::nullopt;
}

std::unique_ptr<Device> openProven(const DeviceOptions& options) {
  auto device = std::make_unique<Device>(options);
  const auto size = GpuProofs().substitute(*device);
  if (!size) return device;
  device.reset();
  DeviceOptions other = options;
  other.subgroupSize = *size;
  return std::make_unique<Device>(other);
}

std::vector<SizeProof> proveSizes(const Device& device, const DeviceOptions& options, const ProofOptions& proof) {
  std::vector<SizeProof> proofs;
  for (const std::uint32_t size : device.subgroupSizes()) {
    DeviceOptions one = options;
    one.subgroupSize = size;
    proofs.push_back({size, proveWithin(kProofWait_s, one, proof)});
    GpuProofs().remember(device, size, proofs.back().wrong());
    if (!proofs.back().proof || proofs.back().wrong().empty()) break;
  }
  return proofs;
}

std::string wrongOn(const Device& device, const GpuProofs& proofs, const std::function<void(std::string_view)>& damaged,
                    const std::function<std::string()>& run) {
  if (const std::optional<std::string> known = proofs.recall(device, damaged)) return *known;
  std::string wrong = run();
  proofs.remember(device, device.subgroupSize(), wrong);
  return wrong;
}

}  // namespace palpate
