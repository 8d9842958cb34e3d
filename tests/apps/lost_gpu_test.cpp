// The program when its GPU is lost during a session.
#include "tests/lost_gpu/lost_gpu.hpp"

#include <algorithm>

#include "tests/apps/program.hpp"
#include "tests/labels.hpp"

namespace palpate::lost_gpu_test {

namespace {

/// Number of submissions to the GPU that this command makes.
long submissionsOf(const std::string& command) {
  const LostGpuLayer layer("count");
  const Outcome outcome = palpate(command);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto end = outcome.text.rfind(" submissions");
  REQUIRE(end != std::string::npos);
  return std::stol(outcome.text.substr(outcome.text.rfind('\n', end) + 1));
}

}  // namespace

TEST_CASE("a program that loses its GPU keeps the trace, reports it in one line and exits with 1") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), trace = (folder / "trace.csv").string();
  works("make sphere -n 20000 -o " + model);
  // Longer than a busy machine needs until that submission, including dropped ticks.
  std::ofstream(folder / "long.csv") << "t_s,x,y,z\n0,0,0,53\n0.6,0,0,53\n0.8,0,0,47\n120,0,0,47\n";
  const std::string path = "--path " + (folder / "long.csv").string() + " --realtime ";
  // A separate GPU for drawing receives the model's normals in more, shorter pieces.
  const long prepared =
      submissionsOf("touch " + model + " --backend vulkan --device sim --quiet --path builtin:press --duration 0.01");
  for (const std::string& when : {"submit:" + std::to_string(prepared + 80), "fence:" + std::to_string(prepared + 80)})
    for (const std::string& way :
         {std::string("--path builtin:press"), path, path + "--edit push --picture PICTURE --size 160x100"}) {
      CAPTURE(when);
      CAPTURE(way);
      std::string options = way;
      if (const auto at = options.find("PICTURE"); at != std::string::npos)
        options.replace(at, 7, (folder / "p.png").string());
      const LostGpuLayer layer(when);
      const Outcome outcome =
          palpate("touch " + model + " --backend vulkan --device sim --quiet --trace " + trace + " " + options);
      CHECK(outcome.code == 1);
      CHECK(outcome.text.find("VK_ERROR_DEVICE_LOST") != std::string::npos);
      CHECK(outcome.text.find("the GPU stopped; start again") != std::string::npos);
      CHECK(std::ranges::count(outcome.text, '\n') == 1);
      const auto rows = readTrace(trace);
      REQUIRE(rows.size() > 10);
      CHECK(rows.back().force == DVec3(0));
      CHECK_FALSE(std::filesystem::exists(folder / "p.png"));
      std::filesystem::remove(trace);
    }
}

TEST_CASE("sculpted points are saved when the GPU is lost, during the session or during undo" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 2000 -o " + model);
  const std::string session =
      "touch " + model + " --backend vulkan --edit push --penetration 4 --rate 100 --quiet --save " + saved;
  const long all = submissionsOf(session + " --undo 1");
  const std::string untouched = contentOf(saved);
  const long before = submissionsOf(session);
  const std::string sculpted = contentOf(saved);
  REQUIRE(bool(sculpted != untouched));
  REQUIRE(all > before + 2);
  for (const std::string when : {"submit:", "fence:"})
    for (const long at : {before * 9 / 10, before, (before + all) / 2, all - 1}) {
      if (!inFullTier() && at != (when == "submit:" ? before * 9 / 10 : (before + all) / 2)) continue;
      CAPTURE(when);
      CAPTURE(at);
      std::filesystem::remove(saved);
      const LostGpuLayer layer(when + std::to_string(at));
      const Outcome outcome = palpate(session + " --undo 1");
      CHECK(outcome.code == 1);
      CHECK(outcome.text.find("VK_ERROR_DEVICE_LOST") != std::string::npos);
      CHECK(outcome.text.find(saved + " contains the last known points") != std::string::npos);
      CHECK(std::ranges::count(outcome.text, '\n') == 1);
      REQUIRE(std::filesystem::exists(saved));
      const bool isUntouched = contentOf(saved) == untouched, isSculpted = contentOf(saved) == sculpted;
      CHECK_FALSE(isUntouched);
      if (at >= before) CHECK(isSculpted);
    }
}

TEST_CASE("the layer that loses the GPU changes nothing else") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  const std::string with = (folder / "with.csv").string(), without = (folder / "without.csv").string();
  works("touch " + model + " --backend vulkan --trace " + without);
  const LostGpuLayer layer;
  works("touch " + model + " --backend vulkan --trace " + with);
  CHECK(contentOf(with) == contentOf(without));
}

}  // namespace palpate::lost_gpu_test
