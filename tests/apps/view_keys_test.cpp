// Keys and mouse of the window, as the README describes them.
#include "engine/core/brush.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"

namespace palpate::view_keys_test {

namespace {

DVec3 vecOf(const Result& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

struct Eye {
  explicit Eye(const Result& state) : eye(vecOf(state["camera"]["eye"])), target(vecOf(state["camera"]["target"])) {}
  DVec3 way() const { return eye - target; }
  DVec3 direction() const { return glm::normalize(way()); }
  DVec3 eye, target;
};

}  // namespace

TEST_CASE("the mouse and the keys move the view") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(2000), R"(
0.1 mouse 132 180
0.3 state %/still.json
0.4 state %/begin.json
0.5 button middle down
0.6 mouse 172 200
0.7 button middle up
0.8 state %/panned.json
0.9 key shift down
0.9 button left down
1.0 mouse 132 180
1.1 button left up
1.1 key shift up
1.2 state %/back.json
1.3 wheel 3
1.4 state %/near.json
1.5 key r
1.6 state %/fitted.json
1.7 mouse 162 205
2.0 button left down
2.0 button left up
2.0 button left down
2.0 button left up
2.1 state %/looked.json
2.2 key r
2.3 key x
2.4 state %/x.json
2.5 key shift+x
2.6 state %/behind_x.json
2.7 key y
2.8 state %/y.json
2.9 key z
3.0 state %/z.json
3.1 key q
9.9 state %/after.json
)");
  const auto eye = [&](const char* name) { return Eye(played->state(name)); };
  const Eye begin = eye("begin.json"), panned = eye("panned.json"), looked = eye("looked.json");
  // The sphere follows the cursor to the right and down, so the eye moves to the left and up.
  CHECK(glm::distance(panned.way(), begin.way()) < 1e-6);
  CHECK(panned.target.x < begin.target.x - 1);
  CHECK(glm::distance(eye("back.json").target, begin.target) < 0.5);
  CHECK(glm::length(eye("near.json").way()) < 0.8 * glm::length(begin.way()));
  CHECK(glm::distance(eye("fitted.json").eye, begin.eye) < 1e-9);
  CHECK(glm::length(looked.target) == near(50, 0.02));  // a point on the sphere
  CHECK(looked.target.x > 2);
  CHECK(glm::distance(eye("x.json").direction(), DVec3(1, 0, 0)) < 0.01);
  CHECK(glm::distance(eye("behind_x.json").direction(), DVec3(-1, 0, 0)) < 0.01);
  CHECK(glm::distance(eye("y.json").direction(), DVec3(0, 1, 0)) < 0.2);  // not exactly, so that up stays up
  CHECK(glm::distance(eye("z.json").direction(), DVec3(0, 0, 1)) < 0.01);
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));  // Q closes the window
  // What has not changed is not drawn again.
  const auto count = [&](const char* name, const char* what) { return played->state(name)[what].get<int>(); };
  CHECK(count("begin.json", "pictures") == count("still.json", "pictures"));
  CHECK(count("begin.json", "pictures_of_model") == count("still.json", "pictures_of_model"));
  CHECK(count("panned.json", "pictures_of_model") > count("begin.json", "pictures_of_model"));
  CHECK(count("y.json", "pictures_of_model") == count("behind_x.json", "pictures_of_model") + 1);
}

TEST_CASE("a first click measures, even directly after the start or after a cursor move") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(2000), R"(
0 key d
0 mouse 112 160
0 button left down
0 button left up
0 mouse 152 200
0 button left down
0 button left up
0 state %/measured.json
0.1 quit
)");
  CHECK(played->state("measured.json")["measured"] > 10);
}

TEST_CASE("keys choose the brush, keep the stylus engaged and switch the forces off and on") {
  if (!hasDisplay()) return;
  std::string script = "0.1 mouse 132 180\n0.4 state %/begin.json\n";
  for (std::size_t key = 1; key <= kBrushKinds.size() + 1; ++key) {
    const double time_s = 0.5 + 0.4 * static_cast<double>(key - 1);
    script += fmt::format("{:.1f} key {}\n{:.1f} state %/tool{}.json\n", time_s, key, time_s + 0.2, key);
  }
  script += R"(
3.8 key 1
4.0 key [
4.1 key g
4.2 key t
4.5 state %/kept.json
4.6 key space
4.9 state %/still_kept.json
5.0 button left down
5.8 state %/pressed.json
5.9 key backspace
6.2 state %/off.json
6.3 key backspace
6.4 button left up
6.9 button left down
7.7 state %/on.json
7.8 button left up
7.9 key escape
8.2 state %/let.json
8.3 key ctrl+q
29.9 state %/after.json
)";
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(2000), script);
  CHECK(played->state("tool1.json")["tool"] == "feel");
  for (std::size_t i = 0; i < kBrushKinds.size(); ++i)
    CHECK(played->state(fmt::format("tool{}.json", i + 2))["tool"] == kBrushKinds[i].first);
  const auto kept = played->state("kept.json");
  CHECK(kept["brush_radius_mm"] < played->state("begin.json")["brush_radius_mm"]);
  CHECK(played->state("begin.json")["stylus"] == false);
  CHECK(kept["stylus"] == true);
  CHECK(kept["last_message"] ==
        "hand gain 0.50: for a device in the hand; the mouse moves the stylus as far as the cursor");
  CHECK(played->state("still_kept.json")["stylus"] == true);  // releasing Space does not release the stylus
  const auto force_N = [&](const char* name) { return glm::length(vecOf(played->state(name)["force_N"])); };
  CAPTURE(played->state("pressed.json").dump());
  CHECK(played->state("pressed.json")["contact"] == true);
  CHECK(force_N("pressed.json") > 0.2);
  CHECK(played->state("off.json")["forces_on"] == false);
  CHECK(force_N("off.json") == 0);
  CHECK(played->state("on.json")["forces_on"] == true);
  CHECK(force_N("on.json") > 0.2);
  CHECK(played->state("let.json")["stylus"] == false);
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
}

TEST_CASE("help, curves, colours, background and screenshots follow their keys") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 800x600 --rate 250", sphereOf(2000), R"(
0.1 mouse 159 590
0.4 screenshot %/begin.png
0.5 key c
0.8 screenshot %/bare.png
0.9 key h
1.2 screenshot %/help.png
1.3 key h
1.4 click Tool
1.5 click Look
1.6 click Colours
1.7 click colour by
1.9 click normal
2.2 screenshot %/normals.png
2.2 click Look
2.3 click theme
2.4 click light
2.6 screenshot %/light.png
2.7 key p
2.9 key p
3.1 state %/last.json
3.2 quit
)");
  const auto picture = [&](const char* name) { return Picture(played->folder.path() / name); };
  const Picture begin = picture("begin.png"), bare = picture("bare.png"), helped = picture("help.png"),
                normals = picture("normals.png"), light = picture("light.png");
  CHECK(differing(begin, bare, 430, 60, 40) > 500);  // the curves are hidden, and
  CHECK(differing(begin, bare, 670, 300, 40) == 0);  // the panel remains
  CHECK(differing(bare, helped, 400, 300, 40) > 500);
  CHECK(differing(bare, normals, 162, 300, 40) > 500);
  CHECK(bare.at(500, 500)[0] < 110);
  CHECK(light.at(500, 500)[0] > 200);
  // Screenshots are written to the working directory, and none overwrites another.
  const Picture first = picture("sphere-1.png"), second = picture("sphere-2.png");
  CHECK(first.width == 800);
  int unlike = 0;  // the model is in the middle of its picture
  for (int dy = -40; dy <= 40; ++dy)
    for (int dx = -40; dx <= 40; ++dx)
      unlike += std::abs(first.at(400 + dx, 300 + dy)[0] - light.at(162 + dx, 300 + dy)[0]) > 24;
  CHECK(unlike < 30);
  CHECK(differing(first, light, 670, 300, 40) > 500);  // without the panel
  CHECK(std::string(played->state("last.json")["last_message"]).find("sphere-2.png") != std::string::npos);
}

}  // namespace palpate::view_keys_test
