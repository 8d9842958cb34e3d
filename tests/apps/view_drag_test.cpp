// Drags with the mouse in the window, over a border and over parts that are thin.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/near.hpp"

namespace palpate::view_drag_test {

namespace {

// A plate of this thickness, mm, or a single sheet for 0, under the default brush.
auto pushOnPlate(double thickness, const std::string& script) {
  return playWell(
      "%/plate.ply --size 560x420 --up z --mm-per-unit 1 --edit push",
      [=](const std::filesystem::path& folder) { writePlate(folder / "plate.ply", thickness); }, script);
}

}  // namespace

TEST_CASE("a drag makes the same stroke however its events fall into pictures") {
  if (!hasDisplay()) return;
  const auto saved = [](const std::string& pause) {
    std::string script = "0.1 mouse 177 210\n0.3 key space down\n0.6 button left down\n";
    for (int i = 0; i < 40; ++i) {
      script += fmt::format("{} mouse {} {}\n", 0.65 + 0.011 * i, 177 + 2 * i, 210 + i % 7);
      if (i % 9 == 2) script += pause.empty() ? "" : fmt::format("{} {}\n", 0.65 + 0.011 * i, pause);
    }
    const auto played = playWell("%/sphere.ply --size 560x420 --edit push", sphereOf(),
                                 script + "1.2 button left up\n3 save %/after.ply\n3.2 quit\n");
    return contentOf(played->folder.path() / "after.ply");
  };
  const std::string once = saved("");
  CHECK(once == saved("screenshot %/late.png"));  // the events after it wait for the next picture
}

TEST_CASE("a drag off the border of an open scan pulls no tongue") {
  if (!hasDisplay()) return;
  const auto played = pushOnPlate(0, R"(
0.1 mouse 177 210
0.3 key space down
0.6 button left down
0.8 mouse 199 212
0.9 mouse 317 214
1.0 mouse 179 230
1.1 mouse 177 418
1.3 mouse 177 240
1.5 button left up
1.8 screenshot %/after.png
1.8 state %/after.json
1.9 save %/after.ply
2.1 quit
)");
  CHECK(played->state("after.json")["undo_count"] == 1);
  const PointCloud after = readPly(played->folder / "after.ply");
  float lowest = 0, highest = 0, widest = 0;
  for (const Vec3& place : after.positions) {
    lowest = std::min(lowest, place.z);
    highest = std::max(highest, place.z);
    widest = std::max({widest, std::abs(place.x), std::abs(place.y)});
  }
  CHECK(lowest == near(-2.5, 0.2));
  CHECK(highest <= 0.6F);
  CHECK(widest <= 30.6F);
}

TEST_CASE("the window says that a part is too thin for its brush, as long as the brush presses there") {
  if (!hasDisplay()) return;
  const auto played = pushOnPlate(0.8, R"(
0.1 mouse 177 210
0.3 key space down
0.5 state %/before.json
0.6 button left down
1.3 state %/pressed.json
1.3 screenshot %/pressed.png
1.4 button left up
2.2 state %/after.json
2.3 quit
)");
  const auto pressed = played->state("pressed.json");
  CAPTURE(pressed.dump());
  CHECK(played->state("before.json")["blocked"] == "");
  CHECK(pressed["contact"] == true);
  CHECK(pressed["blocked"] == "too thin here");
  CHECK(played->state("after.json")["blocked"] == "");
  const auto thick = pushOnPlate(12, R"(
0.1 mouse 177 160
0.3 key space down
0.6 button left down
1.3 state %/pressed.json
1.4 button left up
1.5 quit
)");
  CHECK(thick->state("pressed.json")["edits"] > 0);
  CHECK(thick->state("pressed.json")["blocked"] == "");
}

}  // namespace palpate::view_drag_test
