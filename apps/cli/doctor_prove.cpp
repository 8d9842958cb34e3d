#include "apps/cli/doctor_prove.hpp"

#include <chrono>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <thread>

#include "apps/cli/run_program.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/system_places.hpp"
#include "engine/core/named_values.hpp"
#include "engine/proof/gpu_proof.hpp"
#include "haptics/session/gpu_proofs.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

// For tests: PALPATE_PROOF_FAILS names a primitive that fails, or is "hang".
ProofOptions optionsHere() {
  ProofOptions options;
  const char* const fails = std::getenv("PALPATE_PROOF_FAILS");
  if (!fails) return options;
  options.fails = valueNamed(kPrimitives, fails);
  if (fails == std::string_view("hang"))
    options.proved = [](const ProvedPrimitive&) { std::this_thread::sleep_for(std::chrono::hours(1)); };
  return options;
}

// The words of SPIR-V's header: its version, and the tool that wrote it.
std::string compilerOfShaders() {
  const auto words = shader_code::proof_primitives.words;
  constexpr std::uint32_t kGlslang = 8;
  const std::uint32_t tool = words[2] >> 16, version = words[2] & 0xffff;
  return fmt::format("{} {}, SPIR-V {}.{}", tool == kGlslang ? "glslang" : fmt::format("tool {}", tool), version,
                     words[1] >> 16 & 0xff, words[1] >> 8 & 0xff);
}

Json toJson(const ProvedPrimitive& each) {
  return {{"name", nameOf(kPrimitives, each.primitive)},
          {"right", each.wrong.empty()},
          {"difference", each.wrong},
          {"run_ms", each.run_ms},
          {"compile_ms", each.compile_ms}};
}

Json toJson(const SizeProof& proof) {
  Json primitives = Json::array();
  if (proof.proof)
    for (const ProvedPrimitive& each : proof.proof->primitives) primitives.push_back(toJson(each));
  return {{"subgroup_size", proof.subgroupSize},
          {"wrong", proof.wrong()},
          {"run_ms", proof.proof ? Json(proof.proof->run_ms()) : Json(nullptr)},
          {"primitives", primitives},
          {"substitute", nullptr}};
}

void print(std::FILE* out, const Device& device, const SizeProof& proof) {
  fmt::print(out, "GPU: {}, driver {:#x}, subgroups of {}; shaders by {}\n", device.name(),
             device.properties().driverVersion, proof.subgroupSize, compilerOfShaders());
  if (!proof.proof) return;
  for (const ProvedPrimitive& each : proof.proof->primitives)
    fmt::print(out, "  {:<12}{:<7}{:>8.2f} ms, translated in {:.1f} ms{}{}\n", nameOf(kPrimitives, each.primitive),
               each.wrong.empty() ? "right" : "WRONG", each.run_ms, each.compile_ms, each.wrong.empty() ? "" : ": ",
               each.wrong);
}

std::string conclusion(std::span<const SizeProof> proofs) {
  const SizeProof& last = proofs.back();
  if (!last.proof)
    return fmt::format("The driver has not answered for {:g} s: sessions in real time use the CPU", kProofWait_s);
  if (!last.wrong().empty())
    return fmt::format("Wrong: {}. Sessions in real time use the CPU; a newer driver may be right", last.wrong());
  return fmt::format("All are right in {:.1f} ms: sessions in real time may use this GPU{}", last.proof->run_ms(),
                     proofs.size() == 1 ? "" : fmt::format(", with subgroups of {}", last.subgroupSize));
}

}  // namespace

Json gpuProof(std::FILE* out, const std::string& gpu, Validation validation) {
  const DeviceOptions options{.gpu = gpu, .validation = validation};
  const Device device(options);
  const std::vector<SizeProof> proofs = proveSizes(device, options, optionsHere());
  Json found;
  for (const SizeProof& each : proofs) {
    if (out) print(out, device, each);
    Json one = toJson(each);
    if (found.is_null())
      found = std::move(one);
    else if (each.wrong().empty())
      found["substitute"] = std::move(one);
  }
  found["gpu"] = device.name();
  found["driver_version"] = device.properties().driverVersion;
  found["shaders_by"] = compilerOfShaders();
  found["remembered"] = GpuProofs().recall(device, [](std::string_view) {}).has_value();
  if (out) fmt::print(out, "{}\n", conclusion(proofs));
  return found;
}

void endAfterProof(const Json& proof) {
  if (proof["wrong"] != kNoProof) return;
  std::fflush(nullptr);
  std::_Exit(EXIT_FAILURE);
}

std::string proveInOwnProcess(const std::string& gpu) {
  std::error_code failed;
  const std::filesystem::path folder = std::filesystem::temp_directory_path(failed);
  const auto number = std::chrono::steady_clock::now().time_since_epoch().count();
  const std::filesystem::path result = folder / fmt::format("palpate_proof_{:x}.json", number);
  std::vector<std::string> arguments{"doctor", "--prove=quietly", "--quiet", "--json", result.string()};
  if (!gpu.empty()) arguments.insert(arguments.end(), {"--gpu", gpu});
  runProgram(programFile().string(), arguments);
  if (StopBySignal::requested()) throw Error("interrupted while the GPU was proved");
  std::ostringstream text;
  text << std::ifstream(result).rdbuf();
  std::filesystem::remove(result, failed);
  Json found;
  try {
    found = Json::parse(text.str());
  } catch (const std::exception&) {  // the driver has ended the program
    return std::string(kNoProof);
  }
  if (const Json error = found.value("error", nullptr); error.isText()) throw GpuError("{}", error.get<std::string>());
  return found["proof"]["wrong"].get<std::string>();
}

}  // namespace palpate
