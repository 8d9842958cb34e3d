#include "apps/cli/doctor_prove.hpp"

#include <array>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <numbers>
#include <sstream>
#include <thread>

#include "apps/cli/run_program.hpp"
#include "apps/cli/stop_by_signal.hpp"
#include "apps/cli/system_places.hpp"
#include "engine/cloud/analytic_shape.hpp"
#include "engine/core/clock.hpp"
#include "engine/core/named_values.hpp"
#include "engine/proof/gpu_proof.hpp"
#include "haptics/pace_check.hpp"
#include "haptics/session/gpu_proofs.hpp"
#include "haptics/session/tick_time.hpp"
#include "shaders/compiled.hpp"

namespace palpate {

namespace {

constexpr double kRate_Hz = 1000, kServo_s = 0.5, kStroke_s = 0.2;
constexpr double kStart_s = 2;  // no GPU begins later, so that its measurement ends within three seconds
constexpr std::size_t kPoints = 1'000'000;
constexpr std::array<std::size_t, 2> kTouched{100, 1000};

Model sphere() {
  constexpr double kSize_mm = 100;
  const auto shape = makeShape("sphere", kSize_mm, DVec3(0));
  const double spacing = kSize_mm * std::sqrt(std::numbers::pi / kPoints);
  return {.cloud = sampleShape(*shape, {.count = kPoints}), .scale = {1}, .spacing = spacing, .wideSpacing = spacing};
}

Json servo(std::FILE* out) {
  const PaceCheck check = checkPace(kRate_Hz, kServo_s);
  const double reached_Hz = static_cast<double>(check.ticks) / kServo_s;
  fmt::print(out, "  servo loop at {:g} Hz: reaches {:.0f} Hz, {} of {} ticks missed{}\n", kRate_Hz, reached_Hz,
             check.missed, check.ticks + check.missed, check.realtimePriority ? "" : " (no real-time priority)");
  return {{"rate_Hz", kRate_Hz}, {"reached_Hz", reached_Hz}, {"missed_ticks", check.missed}};
}

struct SpeedScene {
  Model model = sphere();
  std::vector<SurfaceSpot> places = sculptingPlaces(model, kCoarsePoints);
  std::vector<Stroke> strokes{reaching(kTouched[0]), reaching(kTouched[1])};

  Stroke reaching(std::size_t touched) const {
    return strokeThatReaches(touched, BrushKind::push, model, places.front(), kRate_Hz);
  }
};

Json edits(std::FILE* out, Context& context, const std::string& backend, const SpeedScene& scene, bool hasTime) {
  Json measured{{"backend", backend}, {"edits", Json::array()}, {"reason", ""}};
  std::string machine = backend;
  try {
    if (!hasTime) throw Error("not measured: no time left");
    const BackendKind& kind = context.backends().named(backend);
    machine = kind.machine(context.threads());
    const std::vector<Summary> times = tickTimes({.kind = kind,
                                                  .config = {.brush = scene.strokes.front().brush},
                                                  .model = scene.model,
                                                  .places = scene.places,
                                                  .strokes = scene.strokes,
                                                  .threads = context.threads(),
                                                  .duration_s = kStroke_s});
    for (std::size_t i = 0; i < times.size(); ++i) {
      fmt::print(out, "  {:>16}", fmt::format("{:.0f} / {:.0f}", times[i].p50, times[i].p99));
      measured["edits"].push_back(
          {{"touched", kTouched[i]}, {"p50_us", times[i].p50}, {"p99_us", times[i].p99}, {"ticks", times[i].count}});
    }
    fmt::print(out, "   {}\n", machine);
  } catch (const Error& error) {
    measured["reason"] = error.what();
    fmt::print(out, "  {}: {}\n", machine, error.what());
  }
  measured["machine"] = machine;
  return measured;
}

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

Json machineSpeed(std::FILE* out, Context& context) {
  const Stopwatch watch;
  fmt::print(out, "Speed of this machine:\n");
  Json result{{"servo", servo(out)}, {"points", kPoints}, {"backends", Json::array()}};
  const SpeedScene scene;
  fmt::print(out, "  a tick with an edit of {} points, median / p99, us:\n  {:>16}  {:>16}\n", kPoints,
             fmt::format("{} touched", kTouched[0]), fmt::format("{} touched", kTouched[1]));
  std::vector<std::string> names{"cpu"};
  if (context.hasRealGpu()) names.emplace_back("vulkan");
  for (const std::string& name : names)
    result["backends"].push_back(edits(out, context, name, scene, name == "cpu" || watch.elapsed_s() < kStart_s));
  result["measured_s"] = watch.elapsed_s();
  fmt::print(out, "  (measured for {:.1f} s)\n", watch.elapsed_s());
  return result;
}

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
