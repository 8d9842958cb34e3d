// The program on GPUs with only the limits that Vulkan guarantees, or less than palpate requires.
#include "tests/lost_gpu/lost_gpu.hpp"

#include <map>

#include "engine/core/clock.hpp"
#include "tests/apps/program.hpp"
#include "tests/labels.hpp"
#include "tests/says.hpp"

namespace palpate::small_gpu_test {

TEST_CASE("doctor names what a GPU lacks, and refused commands name the same") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  const LostGpuLayer layer("minimum");
  const Outcome doctor = palpate("doctor");
  CHECK(says(doctor.text, "LACKS maxComputeWorkGroupInvocations of 256 at least (it is 128)"));
  CHECK(says(doctor.text, "LACKS scalarBlockLayout"));
  CHECK(says(doctor.text, "palpate cannot run on it"));
  checkEnds(1, "touch " + model + " --backend vulkan --path builtin:press",
            {"scalarBlockLayout, maxComputeWorkGroupInvocations of 256 at least (it is 128)"});
}

TEST_CASE("on a minimal GPU that doctor accepts, models are touched, sculpted, drawn and meshed") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), saved = (folder / "dent.ply").string();
  works("make sphere -n 5000 -o " + model);
  const LostGpuLayer layer(kMinGpu);
  CHECK(says(palpate("doctor").text, "palpate runs on it"));
  for (const std::string& command :
       {"touch " + model + " --backend vulkan --path builtin:press --rate 250 --edit push --save " + saved,
        "render " + saved + " -o " + (folder / "dent.png").string() + " --size 160x120",
        "mesh " + saved + " --resolution 40 -o " + (folder / "mesh.ply").string()}) {
    const Outcome outcome = palpate(command);
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    CHECK_MESSAGE(outcome.text.find("Validation Error") == std::string::npos, outcome.text);
  }
}

namespace {

/// A GPU as small machines have it, made up from the driver that is here: one queue without timestamps or with them.
struct SmallGpu {
  int subgroup;            ///< of a software driver; others keep their own
  bool integrated;         ///< its memory is the CPU's own
  int shared_KiB;          ///< of a workgroup
  bool wide, timestamped;  ///< 64-bit integers and atomics; timestamps
};

std::string layerOf(const SmallGpu& gpu) {
  return fmt::format(
      "{},maxComputeSharedMemorySize={},deviceType={},shaderInt64={},shaderBufferInt64Atomics={},"
      "timestampValidBits={}",
      kMinGpu, gpu.shared_KiB * 1024, gpu.integrated ? 1 : 0, int{gpu.wide}, int{gpu.wide}, gpu.timestamped ? 64 : 0);
}

std::string nameOf(const SmallGpu& gpu) {
  return fmt::format("subgroups of {}, {} KiB shared{}{}{}", gpu.subgroup, gpu.shared_KiB,
                     gpu.integrated ? ", integrated" : "", gpu.wide ? ", 64 bits" : "",
                     gpu.timestamped ? ", timestamps" : "");
}

/// What a press that sculpts leaves, in a file and in a picture.
struct Left {
  std::string points, picture;
};

Left sculpted(const std::string& model, const ScratchFolder& folder) {
  const std::string saved = (folder / "dent.ply").string(), picture = (folder / "dent.png").string();
  const Outcome outcome = palpate("touch " + model + " --backend vulkan --rate 250 --edit push --save " + saved +
                                  " --picture " + picture + " --size 96x72");
  CHECK_MESSAGE(outcome.code == 0, outcome.text);
  Left left{contentOf(saved), contentOf(picture)};
  std::filesystem::remove(saved);
  std::filesystem::remove(picture);
  return left;
}

}  // namespace

TEST_CASE("GPUs of small machines sculpt and draw the same bytes: each pair of what they may lack" * kFull) {
  constexpr SmallGpu kPairs[]{{4, false, 16, false, false}, {4, true, 32, true, true},   {8, false, 32, false, true},
                              {8, true, 16, true, false},   {16, false, 16, true, true}, {16, true, 32, false, false}};
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  std::map<int, Left> drivers;  // by the size of a subgroup
  for (const SmallGpu& gpu : kPairs) {
    CAPTURE(nameOf(gpu));
    ::setenv("LP_NATIVE_VECTOR_WIDTH", fmt::format("{}", 32 * gpu.subgroup).c_str(), 1);
    Left& driver = drivers[gpu.subgroup];
    if (driver.points.empty()) driver = sculpted(model, folder);
    const LostGpuLayer layer(layerOf(gpu));
    const Left small = sculpted(model, folder);
    CHECK(!small.points.empty());
    CHECK(small.points == driver.points);
    CHECK(small.picture == driver.picture);
  }
  ::unsetenv("LP_NATIVE_VECTOR_WIDTH");
}

TEST_CASE("a bench keeps a GPU busy for a second before each size; a software driver has no clock to raise") {
  const std::string bench = "bench sort --sizes 500 1000 --repeat 5";
  CHECK(palpate(bench).text.find("warming the GPU up") == std::string::npos);
  const LostGpuLayer layer(kMinGpu + ",deviceType=1,timestampValidBits=64");
  const Stopwatch watch;
  const Outcome outcome = palpate(bench);
  CHECK(watch.elapsed_s() > 2);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const std::size_t first = outcome.text.find("warming the GPU up for 1 s");
  REQUIRE(first != std::string::npos);
  CHECK(outcome.text.find("warming the GPU up for 1 s", first + 1) != std::string::npos);
}

TEST_CASE("auto measures a GPU against the CPU in real time alone, says so, remembers it, and forgets it on request") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "touch.json").string();
  works("make sphere -n 5000 -o " + model);
  const std::string home = std::getenv("HOME") ? std::getenv("HOME") : folder.path().string();
  ::setenv("MESA_SHADER_CACHE_DIR", (home + "/.cache").c_str(), 0);  // a software driver's translations remain known
  ::setenv("XDG_CACHE_HOME", (folder / "cache").c_str(), 1);
  const LostGpuLayer layer(kMinGpu + ",deviceType=1");  // an integrated GPU, as slow as the software driver behind it
  const auto touch = [&](const std::string& options) {
    const Outcome outcome = palpate("touch " + model + " --edit push --rate 200 --json " + json + options);
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    return outcome.text;
  };
  CHECK(touch(" --duration 0.1").find("Back end:") == std::string::npos);
  CHECK(jsonOf(json)["backend"] == "vulkan");
  CHECK(!std::filesystem::exists(folder / "cache" / "palpate"));

  const std::string first = touch(" --realtime --duration 0.1");
  CHECK(says(first, "p99 of a tick with an edit, measured for"));
  const std::string chosen = jsonOf(json)["backend"];
  CHECK(says(first, chosen == "cpu" ? "Back end: cpu (" : "Back end: llvmpipe"));
  CHECK(says(touch(" --realtime --duration 0.1"), "measured earlier; palpate doctor --forget"));
  CHECK(jsonOf(json)["backend"] == chosen);
  CHECK(says(palpate("doctor --forget").text, "1 measurement"));
  CHECK(!std::filesystem::exists(folder / "cache" / "palpate" / "backends"));
  CHECK(touch(" --realtime --duration 0.1 --gpu 0").find("Back end:") == std::string::npos);  // that GPU is meant
  CHECK(jsonOf(json)["backend"] == "vulkan");
  ::unsetenv("XDG_CACHE_HOME");
  ::unsetenv("MESA_SHADER_CACHE_DIR");
}

}  // namespace palpate::small_gpu_test
