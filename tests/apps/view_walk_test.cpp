// Walking by keys, turning the head, and guides in the window.
#include <numbers>

#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_walk_test {

namespace {

DVec3 vecOf(const Result& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

struct Eye {
  explicit Eye(const Result& state) : eye(vecOf(state["camera"]["eye"])), target(vecOf(state["camera"]["target"])) {}
  DVec3 forward() const { return glm::normalize(target - eye); }
  DVec3 eye, target;
};

}  // namespace

TEST_CASE("held arrows walk until they are released, Shift walks faster, and a right drag turns the head") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x400 --rate 250 --backend cpu", sphereOf(2000), R"(
0.1 key tab
0.2 state %/begin.json
0.3 key up down
0.7 key up up
0.8 state %/ahead.json
1.0 state %/rests.json
1.1 key shift down
1.1 key down down
1.5 key down up
1.5 key shift up
1.6 state %/back.json
1.7 key pageup down
2.0 key pageup up
2.1 state %/higher.json
2.2 key v
2.3 mouse 240 200
2.3 button right down
2.4 mouse 340 200
2.4 button right up
2.5 state %/turned.json
2.6 quit
)");
  const Eye begin(played->state("begin.json")), ahead(played->state("ahead.json")), rests(played->state("rests.json")),
      back(played->state("back.json")), higher(played->state("higher.json")), turned(played->state("turned.json"));
  const double went = glm::dot(ahead.eye - begin.eye, begin.forward());
  CHECK(went > 0);
  CHECK(glm::distance(ahead.eye, begin.eye) == near(went, 1e-9));
  CHECK(glm::distance(ahead.target - ahead.eye, begin.target - begin.eye) < 1e-9);
  CHECK(rests.eye == ahead.eye);
  CHECK(glm::dot(ahead.eye - back.eye, begin.forward()) > 3 * went);  // five times as fast
  CHECK(higher.eye.y > back.eye.y);
  CHECK(glm::distance(higher.forward(), back.forward()) < 1e-9);
  CHECK(glm::distance(turned.eye, higher.eye) < 1e-9);
  // The picture follows the mouse to the right, so that the viewer looks to the left.
  const DVec3 right = glm::cross(higher.forward(), DVec3(0, 1, 0));
  constexpr double kFieldOfView = 0.25 * std::numbers::pi, kShare = 100.0 / 400;  // of the picture's height
  CHECK(glm::dot(turned.forward(), right) == near(-std::sin(kFieldOfView * kShare), 0.05));
}

TEST_CASE("guides that do not exist are refused before a window opens") {
  const Outcome outcome = palpate("view nothing.ply --guides box,foo");
  CHECK(outcome.code == 2);
  CHECK(says(outcome.text, "--guides: 'foo' is none of box, axes, grid and compass"));
}

TEST_CASE("guides are drawn in the window and in its pictures, and an idle window with them draws nothing") {
  if (!hasDisplay()) return;
  const auto played =
      playWell("%/sphere.ply --size 480x400 --backend cpu --guides box,axes,grid,compass", sphereOf(2000), R"(
0.1 key tab
0.4 screenshot %/with.png
0.5 state %/first.json
0.6 key ctrl+p
0.9 key f8
1.0 click Look
1.2 click box
1.4 key tab
1.6 screenshot %/without.png
1.7 quit
)");
  const Picture with(played->folder.path() / "with.png"), saved(played->folder.path() / "sphere-1.png");
  CHECK(differing(with, saved, 52, 40, 30) < 400);  // the compass is in both
  const auto colored = [](const Picture& picture) {
    return count(52, 42, 40, [&](int x, int y) {
      const auto p = picture.at(x, y);
      return std::max({p[0], p[1], p[2]}) - std::min({p[0], p[1], p[2]}) > 60;
    });
  };
  CHECK(colored(with) > 20);
  CHECK(colored(saved) > 20);
}

}  // namespace palpate::view_walk_test
