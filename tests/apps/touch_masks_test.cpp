// Points that palpate touch hides, locks or leaves alone by a condition.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <vector>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::touch_masks_test {

namespace {

struct Touched {
  PointCloud before, after;
  Result report;
};

// A press into a ball, after which all points but inserted ones are in the order of the file.
Touched touched(const ScratchFolder& folder, const std::string& options) {
  const std::string ball = (folder / "ball.ply").string(), saved = (folder / "saved.ply").string(),
                    report = (folder / "report.json").string();
  works("--quiet make sphere -n 8000 -o " + ball);
  works("--quiet touch " + ball + " --backend cpu --edit push --penetration 4 --force --save " + saved + " --json " +
        report + " " + options);
  return {readCloud(ball).cloud, readCloud(saved).cloud, jsonOf(report)};
}

bool hasMoved(const Touched& touched, std::size_t i) {
  return touched.before.positions[i] != touched.after.positions[i];
}

// How many of the points have moved, below y and above.
std::array<int, 2> movedIn(const Touched& touched, double y) {
  std::array<int, 2> moved{};
  for (std::size_t i = 0; i < touched.before.size(); ++i)
    moved[static_cast<double>(touched.before.positions[i].y) > y] += hasMoved(touched, i);
  return moved;
}

// A y that divides the points that have moved.
double middleOf(const Touched& free) {
  std::vector<float> moved;
  for (std::size_t i = 0; i < free.before.size(); ++i)
    if (hasMoved(free, i)) moved.push_back(free.before.positions[i].y);
  std::ranges::sort(moved);
  REQUIRE(moved.size() > 40);
  return 0.5 * (double{moved[moved.size() / 2]} + double{moved[moved.size() / 2 - 1]});
}

}  // namespace

TEST_CASE("a brush changes no locked point, and where only some may be changed, no other one") {
  const ScratchFolder folder;
  const std::string wide = "--brush-radius 10 ";
  const double y = middleOf(touched(folder, wide));
  const Touched locked = touched(folder, wide + fmt::format("--lock \"y < {}\"", y));
  CHECK(movedIn(locked, y)[0] == 0);
  CHECK(movedIn(locked, y)[1] > 10);
  CHECK(locked.report["peak_force_N"].get<double>() > 0.5);
  const auto only = movedIn(touched(folder, wide + fmt::format("--only \"y < {} && z > 0\"", y)), y);
  CHECK(only[0] > 10);
  CHECK(only[1] == 0);
}

TEST_CASE("around what is locked a soft rim moves in part, and a file that was saved with it is locked so") {
  const ScratchFolder folder;
  const double y = middleOf(touched(folder, "--brush-radius 10"));
  const std::string locks = fmt::format("--brush-radius 10 --lock \"y < {}\" ", y);
  const Touched hard = touched(folder, locks);
  const Touched soft = touched(folder, locks + "--lock-rim 6 --log " + (folder / "log").string());
  const auto moved = [y](const Touched& touched, double from, double to) {
    double sum = 0;
    for (std::size_t i = 0; i < touched.before.size(); ++i)
      if (touched.before.positions[i].y >= y + from && touched.before.positions[i].y < y + to)
        sum += glm::distance(touched.before.positions[i], touched.after.positions[i]);
    return sum;
  };
  CHECK(moved(soft, -200, 0) == 0);
  CHECK(moved(soft, 0, 1.5) < 0.5 * moved(hard, 0, 1.5));
  CHECK(moved(soft, 0, 1.5) > 0.1 * moved(hard, 0, 1.5));
  CHECK(moved(soft, 3, 4.5) > 0.6 * moved(hard, 3, 4.5));
  works("--quiet replay " + (folder / "log").string());
  // The saved file is locked by its property, without an option.
  const std::string saved = (folder / "saved.ply").string(), again = (folder / "again.ply").string();
  const auto lock = std::ranges::find(soft.after.extra, "lock", &Attribute::name);
  REQUIRE(lock != soft.after.extra.end());
  const Outcome stated =
      palpate("touch " + saved + " --backend cpu --edit push --brush-radius 10 --penetration 6 --save " + again);
  CHECK(stated.code == 0);
  CHECK(says(stated.text, "points locked, also in part, by the field lock of the file"));
  const PointCloud next = readCloud(again).cloud;
  std::size_t changed = 0, locked = 0;
  for (std::size_t i = 0; i < soft.after.size(); ++i) {
    const bool isLocked = lock->data[i] == std::byte{255};
    locked += isLocked;
    changed += !isLocked && next.positions[i] != soft.after.positions[i];
    if (isLocked) CHECK(next.positions[i] == soft.after.positions[i]);
  }
  CHECK(locked > 3000);
  CHECK(changed > 10);
  const Outcome outcome = palpate("touch " + saved + " --backend cpu --edit push --lock-rim 3");
  CHECK(outcome.code != 0);
  CHECK(says(outcome.text, "--lock-rim: requires --lock"));
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

TEST_CASE("the strokes of a path have the strength that is asked for, down to none") {
  const ScratchFolder folder;
  const Touched whole = touched(folder, ""), made = touched(folder, "--layer-strength 1"),
                half = touched(folder, "--layer-strength 0.5"), none = touched(folder, "--layer-strength 0");
  CHECK(made.after.positions == whole.after.positions);
  CHECK(none.after.positions == none.before.positions);
  std::size_t moved = 0, wrong = 0;
  for (std::size_t i = 0; i < whole.before.size(); ++i) {
    const DVec3 from(whole.before.positions[i]), to(whole.after.positions[i]);
    wrong += !(glm::distance(DVec3(half.after.positions[i]), 0.5 * (from + to)) < 1e-5);
    moved += from != to;
  }
  CHECK(moved > 10);
  CHECK(wrong == 0);
  const auto refused = [&](const std::string& options) {
    const Outcome outcome = palpate("touch " + (folder / "ball.ply").string() + " --backend cpu " + options);
    CHECK(outcome.code != 0);
    return outcome.text;
  };
  CHECK(says(refused("--edit push --layer-strength 3"), "3 is not a number from -1 to 2"));
  CHECK(says(refused("--layer-strength 1"), "requires a brush"));
}

}  // namespace palpate::touch_masks_test
