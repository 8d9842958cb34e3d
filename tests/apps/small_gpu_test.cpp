// The program on GPUs with only the limits that Vulkan guarantees, or less than palpate requires.
#include "tests/lost_gpu/lost_gpu.hpp"

#include "tests/apps/program.hpp"
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
  const Outcome touch = palpate("touch " + model + " --backend vulkan --path builtin:press");
  CHECK(touch.code == 1);
  CHECK(says(touch.text, "scalarBlockLayout, maxComputeWorkGroupInvocations of 256 at least (it is 128)"));
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

}  // namespace palpate::small_gpu_test
