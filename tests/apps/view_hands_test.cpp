// What a sculptor's hands know from other programs: Shift smooths, Ctrl inverts, F drags the size, Esc takes a stroke
// back, and strokes are mirrored.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::view_hands_test {

namespace {

constexpr const char* kWindow = "%/sphere.ply --size 480x360 --rate 250 --edit push";

// Of the original points, those that were moved: on the side of x > 0, and on the other one.
std::pair<int, int> movedOf(const std::filesystem::path& before, const std::filesystem::path& after) {
  const PointCloud was = readPly(before.string()), is = readPly(after.string());
  std::pair<int, int> moved;
  for (std::size_t i = 0; i < was.size(); ++i)
    if (was.positions[i] != is.positions[i]) ++(was.positions[i].x > 0 ? moved.first : moved.second);
  return moved;
}

}  // namespace

TEST_CASE("the ring of the brush follows the mouse over the model, without drawing the model or a resting window") {
  if (!hasDisplay()) return;
  const auto played = playWell(kWindow, sphereOf(2000), R"(
0.1 mouse 20 350
0.5 state %/beside.json
0.6 mouse 132 180
1.0 state %/over.json
1.4 state %/still.json
1.5 mouse 109 160
1.9 state %/moved.json
2.0 key 1
2.3 state %/feel.json
2.4 key 2
2.4 key v
2.8 state %/look.json
2.9 quit
)");
  const auto ring = [&](const char* name) { return played->state(name)["brush"]["ring"]; };
  const auto count = [&](const char* name, const char* what) { return played->state(name)[what].get<int>(); };
  CHECK(ring("beside.json").empty());
  REQUIRE(ring("over.json").size() > 20);
  CHECK(ring("still.json") == ring("over.json"));
  CHECK(ring("moved.json") != ring("over.json"));
  CHECK(ring("feel.json").empty());
  CHECK(ring("look.json").empty());
  CHECK(count("still.json", "pictures") == count("over.json", "pictures"));
  CHECK(count("moved.json", "pictures") > count("over.json", "pictures"));
  CHECK(count("moved.json", "pictures_of_model") == count("beside.json", "pictures_of_model"));
  // As wide as the brush: 12 of the 100 mm that the sphere is wide.
  double left = 1e9, right = -1e9;
  for (const auto& corner : ring("over.json")) {
    left = std::min(left, corner[0].get<double>());
    right = std::max(right, corner[0].get<double>());
  }
  CHECK(0.5 * (left + right) == near(132, 0.03));
  CHECK(right - left > 20);
  CHECK(right - left < 60);
}

TEST_CASE("F and a motion of the mouse change the size, Shift+F the strength; a click keeps it, Esc does not") {
  if (!hasDisplay()) return;
  const auto played = playWell(kWindow, sphereOf(2000), R"(
0.1 mouse 132 180
0.4 key f
0.5 mouse 192 180
0.7 state %/dragged.json
0.8 key escape
0.9 state %/escaped.json
1.0 mouse 132 180
1.1 key f
1.2 mouse 72 180
1.3 button left down
1.3 button left up
1.4 mouse 200 100
1.5 state %/clicked.json
1.6 key shift+f
1.7 mouse 240 100
1.8 key enter
1.9 mouse 300 100
2.0 state %/stronger.json
2.1 key 6
2.2 key shift+f
2.3 mouse 260 100
2.4 key f
2.5 state %/grab_too.json
2.6 key 1
2.7 key f
2.8 state %/feel.json
2.9 quit
)");
  const auto brush = [&](const char* name) { return played->state(name)["brush"]; };
  const auto radius = [&](const char* name) { return brush(name)["radius_mm"].get<double>(); };
  CHECK(radius("dragged.json") == near(6 * std::sqrt(2.0), 1e-6));
  CHECK(brush("dragged.json")["words"].get<std::string>().starts_with("size "));
  CHECK(radius("escaped.json") == 6);
  CHECK(brush("escaped.json")["words"] == "");
  CHECK(played->state("escaped.json")["camera"] == played->state("dragged.json")["camera"]);
  CHECK(radius("clicked.json") == near(6 / std::sqrt(2.0), 1e-6));
  CHECK(played->state("clicked.json")["camera"] == played->state("dragged.json")["camera"]);
  CHECK(radius("stronger.json") == radius("clicked.json"));
  CHECK(brush("stronger.json")["push_rate"].get<double>() == near(0.2, 1e-6));  // push has no other strength
  CHECK(brush("grab_too.json")["strength"].get<double>() == near(0.4, 1e-6));
  CHECK(played->state("grab_too.json")["undo_count"] == 0);
  CHECK(says(played->state("feel.json")["errors"].dump(), "choose a brush first"));
}

TEST_CASE("while the stylus is held Shift smooths and Ctrl inverts, also when it is released in the stroke") {
  if (!hasDisplay()) return;
  const auto played = playWell(kWindow, sphereOf(2000), R"(
0.1 mouse 132 180
0.2 key shift down
0.4 state %/without.json
0.5 key shift up
0.6 key space down
0.7 key ctrl down
0.9 state %/inverse.json
1.0 button left down
1.2 key ctrl up
1.4 state %/raising.json
1.6 button left up
2.0 state %/raised.json
2.0 save %/raised.ply
2.2 key shift down
2.4 state %/smooth.json
2.5 key shift up
2.7 state %/again.json
2.8 key 6
2.9 key ctrl down
3.1 state %/grab.json
3.2 key z
3.3 key ctrl up
3.4 state %/undone.json
3.5 quit
)");
  const auto tool = [&](const char* name) { return played->state(name)["tool"]; };
  const auto words = [&](const char* name) { return played->state(name)["brush"]["words"].get<std::string>(); };
  CHECK(tool("without.json") == "push");  // the stylus is not held: Shift moves the view
  CHECK(words("without.json") == "");
  CHECK(tool("inverse.json") == "inflate");
  CHECK(words("inverse.json") == "inflate (Ctrl)");
  CHECK(tool("raising.json") == "inflate");
  CHECK(tool("raised.json") == "push");
  CHECK(tool("smooth.json") == "smooth");
  CHECK(words("smooth.json") == "smooth (Shift)");
  CHECK(tool("again.json") == "push");
  CHECK(tool("grab.json") == "grab");
  CHECK(words("grab.json") == "grab has no inverse: pull the other way");
  CHECK(played->state("undone.json")["undo_count"] == 0);
  const std::filesystem::path& path = played->folder.path();
  const PointCloud was = readPly((path / "sphere.ply").string()), is = readPly((path / "raised.ply").string());
  double most = 0, least = 0;
  for (std::size_t i = 0; i < was.size(); ++i) {
    const double rise = glm::length(DVec3(is.positions[i])) - glm::length(DVec3(was.positions[i]));
    most = std::max(most, rise);
    least = std::min(least, rise);
  }
  CHECK(most > 0.05);
  CHECK(least > -0.05);
}

TEST_CASE("a stroke keeps the size of the brush with which it began, and is one change whatever keys are pressed") {
  if (!hasDisplay()) return;
  const auto played = playWell(kWindow, sphereOf(2000), R"(
0.1 mouse 132 180
0.3 key space down
0.5 state %/before.json
0.6 button left down
0.9 key ]
1.1 key ]
1.3 state %/pressed.json
1.4 mouse 142 180
1.7 button left up
2.4 state %/after.json
2.5 quit
)");
  const auto number = [&](const char* name, const char* key) { return played->state(name)[key].get<double>(); };
  CHECK(number("pressed.json", "brush_radius_mm") == number("before.json", "brush_radius_mm"));
  CHECK(number("after.json", "brush_radius_mm") == near(1.21 * number("before.json", "brush_radius_mm"), 1e-6));
  CHECK(number("pressed.json", "edits") > 0);
  CHECK(number("after.json", "undo_count") == 1);
}

TEST_CASE("Esc takes the stroke in hand back to the bit, and otherwise does what it did") {
  if (!hasDisplay()) return;
  const auto played = playWell(kWindow, sphereOf(2000), R"(
0.1 mouse 132 180
0.3 key space down
0.4 button left down
0.7 button left up
1.2 save %/one.ply
1.4 state %/one.json
1.5 mouse 99 150
1.7 button left down
1.8 mouse 139 200
2.2 state %/stroking.json
2.2 key escape
2.4 mouse 59 150
2.6 state %/taken.json
2.6 save %/taken.ply
2.8 button left up
3.2 state %/after.json
3.25 key ctrl down
3.3 button left down
3.5 mouse 79 160
3.7 key ctrl+escape
3.8 button left up
3.9 key ctrl up
4.1 state %/inverted.json
4.1 key ctrl+shift+z
4.3 state %/redo.json
4.3 mouse 132 180
4.5 button left down
4.8 button left up
5.2 state %/two.json
5.3 key t
5.4 key space up
5.5 state %/locked.json
5.6 key escape
5.8 state %/away.json
5.9 quit
)");
  const std::filesystem::path& path = played->folder.path();
  const auto undo = [&](const char* name) { return played->state(name)["undo_count"].get<int>(); };
  CHECK(undo("one.json") == 1);
  CHECK(played->state("stroking.json")["edits"].get<int>() > played->state("one.json")["edits"].get<int>());
  CHECK(undo("taken.json") == 1);
  CHECK(played->state("taken.json")["stylus"] == true);
  CHECK(says(played->state("taken.json")["messages"].dump(), "the stroke was taken back"));
  CHECK(contentOf(path / "taken.ply") == contentOf(path / "one.ply"));
  CHECK(undo("after.json") == 1);
  CHECK(undo("inverted.json") == 1);
  CHECK(played->state("inverted.json")["edits"].get<int>() > played->state("after.json")["edits"].get<int>());
  CHECK(undo("redo.json") == 1);
  CHECK(undo("two.json") == 2);
  CHECK(played->state("locked.json")["stylus"] == true);
  CHECK(played->state("away.json")["stylus"] == false);
  CHECK(undo("away.json") == 2);
}

TEST_CASE("symmetry is chosen by an option, in the panel, or as the plane of the selection, and is shown") {
  if (!hasDisplay()) return;
  constexpr const char* kStroke = R"(
0.1 mouse 149 180
0.3 key space down
0.4 button left down
0.7 button left up
0.8 key space up
1.2 save %/option.ply
1.2 key z
1.3 screenshot %/on.png
1.4 click symmetry
1.6 click off
1.8 mouse 20 350
2.0 screenshot %/off.png
2.1 state %/off.json
2.2 key ctrl+z
2.3 key s
2.4 key d
2.5 click numbers
2.6 text 0,0,0:1,0,0
2.7 key enter
2.9 click Mirror here
3.1 state %/plane.json
3.2 mouse 149 180
3.4 key space down
3.5 button left down
3.8 button left up
3.9 key space up
4.4 save %/plane.ply
4.5 quit
)";
  const auto played = playWell(std::string(kWindow) + " --symmetry x --up z", sphereOf(8000), kStroke);
  const std::filesystem::path& path = played->folder.path();
  for (const char* const file : {"option.ply", "plane.ply"}) {
    CAPTURE(file);
    const auto [right, left] = movedOf(path / "sphere.ply", path / file);
    CHECK(right > 10);
    CHECK(left == near(right, 0.3));
  }
  CHECK(played->state("off.json")["brush"]["symmetry"] == "");
  CHECK(played->state("plane.json")["brush"]["symmetry"] == "0,0,0,1,0,0");
  CHECK(played->state("plane.json")["mouse"] == "sculpting");
  // Its lines stand beside the sphere.
  const Picture on(path / "on.png"), off(path / "off.png");
  CHECK(differing(on, off, 137, 80, 15) > 5);
}

TEST_CASE("a plane of symmetry that is none is refused before a window opens") {
  for (const char* const wrong : {"w", "1,2,3", "nan,0,0,1,0,0", "0,0,0,0,0,0"}) {
    CAPTURE(wrong);
    const Outcome outcome = palpate(std::string("view a.ply --symmetry ") + wrong);
    CHECK(outcome.code == 2);
    CHECK(says(outcome.text, "--symmetry"));
  }
}

}  // namespace palpate::view_hands_test
