// Points that palpate touch hides, locks or leaves alone by a condition.
#include "engine/io/cloud_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::touch_masks_test {

namespace {

struct Touched {
  PointCloud before, after;
  Result report;
};

// A press into the top of a ball, after which all points but inserted ones are in the order of the file.
Touched touched(const ScratchFolder& folder, const std::string& options) {
  const std::string ball = (folder / "ball.ply").string(), saved = (folder / "saved.ply").string(),
                    report = (folder / "report.json").string();
  works("--quiet make sphere -n 8000 -o " + ball);
  works("--quiet touch " + ball + " --backend cpu --edit push --penetration 4 --force --save " + saved + " --json " +
        report + " " + options);
  return {readCloud(ball).cloud, readCloud(saved).cloud, jsonOf(report)};
}

// How many of the points have moved, on each side of x = 0.
std::array<int, 2> movedIn(const Touched& touched) {
  std::array<int, 2> moved{};
  for (std::size_t i = 0; i < touched.before.size(); ++i)
    moved[touched.before.positions[i].x > 0] += touched.before.positions[i] != touched.after.positions[i];
  return moved;
}

}  // namespace

TEST_CASE("a brush changes no locked point, and where only some may be changed, no other one") {
  const ScratchFolder folder;
  const auto all = movedIn(touched(folder, ""));
  CHECK(all[0] > 20);
  CHECK(all[1] > 20);
  const Touched locked = touched(folder, "--lock \"x < 0\"");
  CHECK(movedIn(locked)[0] == 0);
  CHECK(movedIn(locked)[1] > 20);
  CHECK(locked.report["peak_force_N"].get<double>() > 0.5);
  const auto only = movedIn(touched(folder, "--only \"x < 0 && z > 0\""));
  CHECK(only[0] > 20);
  CHECK(only[1] == 0);
}

TEST_CASE("hidden points are not felt and are saved, and a recording with masks is repeated exactly") {
  const ScratchFolder folder;
  const Touched hidden = touched(folder, "--hide \"z > 0\" --log " + (folder / "log").string());
  CHECK(hidden.report["peak_force_N"].get<double>() == 0);
  CHECK(hidden.after.positions == hidden.before.positions);
  works("--quiet replay " + (folder / "log").string());
  touched(folder, "--lock \"x < 0\" --hide \"y > 20\" --log " + (folder / "second").string());
  works("--quiet replay " + (folder / "second").string());
}

TEST_CASE("a condition that is none, that holds for no point, or without a brush is refused by name") {
  const ScratchFolder folder;
  works("--quiet make sphere -n 500 -o " + (folder / "ball.ply").string());
  const auto refused = [&](const std::string& options) {
    const Outcome outcome = palpate("touch " + (folder / "ball.ply").string() + " --backend cpu " + options);
    CHECK(outcome.code != 0);
    return outcome.text;
  };
  CHECK(says(refused("--edit push --lock \"x >\""), "--lock"));
  CHECK(says(refused("--edit push --hide \"w > 1\""), "w"));
  CHECK(says(refused("--edit push --only \"z > 1000\""), "holds for no point"));
  CHECK(says(refused("--lock \"x > 0\""), "requires a brush"));
}

}  // namespace palpate::touch_masks_test
