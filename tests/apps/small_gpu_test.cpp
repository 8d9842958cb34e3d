// The program on GPUs with only the limits that Vulkan guarantees, or less than palpate requires.
#include "tests/lost_gpu/lost_gpu.hpp"

#include <algorithm>
#include <fstream>
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

/// A user's cache in that folder, but a software driver's translations remain known.
void useCacheIn(const std::filesystem::path& folder) {
  const char* const home = std::getenv("HOME");
  ::setenv("MESA_SHADER_CACHE_DIR", ((home ? std::filesystem::path(home) : folder) / ".cache").c_str(), 0);
  ::setenv("XDG_CACHE_HOME", folder.c_str(), 1);
}

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

TEST_CASE("doctor proves GPUs as small machines have them, and forces there are the same" * kFull) {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "proof.json").string();
  works("make sphere -n 5000 -o " + model);
  useCacheIn(folder / "cache");
  const auto forces = [&](const std::string& name) {
    const std::string trace = (folder / name).string();
    works("touch " + model + " --backend vulkan --path builtin:press --rate 250 --trace " + trace);
    return readTrace(trace);
  };
  const std::vector<Row> here = forces("here.csv");
  CHECK(std::ranges::count_if(here, [](const Row& row) { return glm::length(row.force) > 0.1; }) > 20);
  for (const int lanes : {4, 8, 16}) {
    CAPTURE(lanes);
    ::setenv("LP_NATIVE_VECTOR_WIDTH", fmt::format("{}", 32 * lanes).c_str(), 1);
    const LostGpuLayer layer(kMinGpu + ",maxMemoryAllocationSize=134217728,maxBufferSize=134217728");
    works("doctor --prove --json " + json);
    const auto proof = jsonOf(json)["proof"];
    CHECK(proof["subgroup_size"] == lanes);
    CHECK(proof["wrong"] == "");
    for (const auto primitive : proof["primitives"]) {
      const std::string name = primitive["name"];
      ::setenv("PALPATE_PROOF_FAILS", name.c_str(), 1);
      checkEnds(1, "doctor --prove --json " + json, {"wrong results: " + name});
      CHECK(jsonOf(json)["proof"]["wrong"] == name);
    }
    ::unsetenv("PALPATE_PROOF_FAILS");
    const std::vector<Row> there = forces("there.csv");
    REQUIRE(there.size() == here.size());
    for (std::size_t i = 0; i < here.size(); ++i) REQUIRE(glm::distance(there[i].force, here[i].force) <= 1e-6);
  }
  ::unsetenv("LP_NATIVE_VECTOR_WIDTH");
  ::unsetenv("XDG_CACHE_HOME");
  ::unsetenv("MESA_SHADER_CACHE_DIR");
}

TEST_CASE("on Intel's GPUs every pass requires subgroups of 16") {
  ::setenv("LP_NATIVE_VECTOR_WIDTH", "512", 1);
  ::setenv("PALPATE_COUNT_PIPELINES", "1", 1);
  {
    const LostGpuLayer layer(kMinGpu + ",vendorID=32902,minSubgroupSize=8,maxSubgroupSize=32");
    const Outcome outcome = palpate("doctor --prove");
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    CHECK(says(outcome.text, "pipelines of subgroups of 16"));
    CHECK(!says(outcome.text, "pipelines of subgroups of 0"));
  }
  ::unsetenv("PALPATE_COUNT_PIPELINES");
  ::unsetenv("LP_NATIVE_VECTOR_WIDTH");
}

TEST_CASE("a GPU that is wrong with its best size of subgroups is used with another that is right") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "proof.json").string();
  works("make sphere -n 3000 -o " + model);
  useCacheIn(folder / "cache");
  const std::string onGpu = "touch " + model + " --backend vulkan --realtime --rate 100 --duration 0.1";
  ::setenv("LP_NATIVE_VECTOR_WIDTH", "256", 1);  // of 8 lanes, whatever is required
  {
    const LostGpuLayer layer(kMinGpu + ",vendorID=32902,minSubgroupSize=8,maxSubgroupSize=32");
    checkEnds(1, onGpu,
              {"may not move a hand: wrong results of", "right with subgroups of 8, which the next start uses"});
    works(onGpu);
    const Outcome proved = palpate("doctor --prove --json " + json);
    CHECK_MESSAGE(proved.code == 0, proved.text);
    CHECK(says(proved.text, "subgroups of 16; shaders by"));
    CHECK(says(proved.text, "sessions in real time may use this GPU, with subgroups of 8"));
    const auto proof = jsonOf(json)["proof"];
    CHECK(proof["subgroup_size"] == 16);
    CHECK(proof["wrong"] != "");
    CHECK(proof["substitute"]["subgroup_size"] == 8);
    CHECK(proof["substitute"]["wrong"] == "");
  }
  ::unsetenv("LP_NATIVE_VECTOR_WIDTH");
  ::unsetenv("XDG_CACHE_HOME");
  ::unsetenv("MESA_SHADER_CACHE_DIR");
}

TEST_CASE("a session in real time proves the GPU once, and uses the CPU where a primitive is wrong or hangs") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "touch.json").string();
  const std::filesystem::path proofs = folder / "cache" / "palpate" / "proofs";
  works("make sphere -n 3000 -o " + model);
  useCacheIn(folder / "cache");
  const std::string onGpu = "touch " + model + " --backend vulkan --realtime --rate 100 --duration 0.1";
  const Outcome first = palpate(onGpu), again = palpate(onGpu);
  CHECK_MESSAGE(first.code == 0, first.text);
  CHECK(says(first.text, "once for this driver"));
  CHECK_MESSAGE(again.code == 0, again.text);
  CHECK(!says(again.text, "once for this driver"));
  std::ofstream(proofs) << "what is this\n";
  const Outcome damaged = palpate(onGpu);
  CHECK(damaged.code == 0);
  CHECK(says(damaged.text, "is not a file of proofs of GPUs"));
  CHECK(says(damaged.text, "once for this driver"));

  for (const auto& [fails, why] : {std::pair<std::string, std::string>{"ballot", "wrong results of ballot"},
                                   {"hang", "its driver did not end a proof"}}) {
    CAPTURE(fails);
    std::filesystem::remove(proofs);
    ::setenv("PALPATE_PROOF_FAILS", fails.c_str(), 1);
    checkEnds(1, onGpu, {"may not move a hand: " + why, "use the back end cpu"});
    ::unsetenv("PALPATE_PROOF_FAILS");
    checkEnds(1, onGpu, {"may not move a hand: " + why});                           // remembered
    works("touch " + model + " --backend vulkan --path builtin:press --rate 250");  // no hand is moved
  }
  std::filesystem::remove(proofs);
  {
    const LostGpuLayer layer("submit:5");  // in the middle of the proof
    checkEnds(1, onGpu, {"VK_ERROR_DEVICE_LOST"});
    CHECK(!std::filesystem::exists(proofs));
  }
  ::setenv("PALPATE_PROOF_FAILS", "sort", 1);
  {
    const LostGpuLayer layer(kMinGpu + ",deviceType=1");  // as one that auto would use
    const Outcome chosen = palpate("touch " + model + " --realtime --rate 100 --duration 0.1 --json " + json);
    CHECK_MESSAGE(chosen.code == 0, chosen.text);
    CHECK(says(chosen.text, "wrong results of sort"));
    CHECK(jsonOf(json)["backend"] == "cpu");
  }
  checkEnds(1, "doctor --prove", {"sort", "WRONG", "Sessions in real time use the CPU"});
  ::unsetenv("PALPATE_PROOF_FAILS");
  works("doctor --prove --validate=core");  // where a software driver translates each shader at its first run
  const Outcome right = palpate("doctor --prove");
  CHECK_MESSAGE(right.code == 0, right.text);
  CHECK(says(right.text, "All are right in"));
  // A folder that cannot be written costs a proof at each start, and nothing else.
  ::setenv("XDG_CACHE_HOME", model.c_str(), 1);
  for (int start = 0; start < 2; ++start) {
    const Outcome outcome = palpate(onGpu);
    CHECK_MESSAGE(outcome.code == 0, outcome.text);
    CHECK(says(outcome.text, "once for this driver"));
  }
  ::unsetenv("XDG_CACHE_HOME");
  ::unsetenv("MESA_SHADER_CACHE_DIR");
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
  useCacheIn(folder / "cache");
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
