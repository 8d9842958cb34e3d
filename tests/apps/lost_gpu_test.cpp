// The program when its GPU is lost in the middle of a session.
#include "tests/lost_gpu/lost_gpu.hpp"

#include "tests/apps/program.hpp"

namespace palpate {

TEST_CASE("a program that loses its GPU keeps the trace, says so in one line and ends with 1") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), trace = (folder / "trace.csv").string();
  works("make sphere -n 20000 -o " + model);
  for (const std::string when : {"submit:400", "fence:400"})
    for (const std::string way :
         {"", "--realtime", "--realtime --edit push --penetration 4 --picture PICTURE --size 160x100"}) {
      CAPTURE(when);
      CAPTURE(way);
      std::string options = way;
      if (const auto at = options.find("PICTURE"); at != std::string::npos)
        options.replace(at, 7, (folder / "p.png").string());
      const LostGpuLayer layer(when);
      const Outcome outcome =
          palpate("touch " + model + " --device sim --path builtin:press --quiet --trace " + trace + " " + options);
      CHECK(outcome.code == 1);
      CHECK(outcome.text.find("VK_ERROR_DEVICE_LOST") != std::string::npos);
      CHECK(outcome.text.find("the GPU stopped; start again") != std::string::npos);
      CHECK(std::ranges::count(outcome.text, '\n') == 1);
      const auto rows = readTrace(trace);
      REQUIRE(rows.size() > 100);
      CHECK(rows.back().force == DVec3(0));
      CHECK_FALSE(std::filesystem::exists(folder / "p.png"));
      std::filesystem::remove(trace);
    }
}

TEST_CASE("the layer that takes the GPU away lets everything else pass") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  const std::string with = (folder / "with.csv").string(), without = (folder / "without.csv").string();
  works("touch " + model + " --trace " + without);
  const LostGpuLayer layer;
  works("touch " + model + " --trace " + with);
  CHECK(contentOf(with) == contentOf(without));
}

}  // namespace palpate
