// The window under scripts of a user's input, on a display without a screen (Xvfb).
#include "engine/cloud/point_tree.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/content_of.hpp"
#include "tests/fake_devices/fake_driver.hpp"
#include "tests/near.hpp"

namespace palpate::view_test {

namespace {

// The brush's ring is the only yellow object.
int ringPixels(const Picture& picture, int x, int y) {
  return count(x, y, 40, [&](int i, int j) {
    const auto p = picture.at(i, j);
    return p[0] > p[2] + 80 && p[1] > p[2] + 80;
  });
}

constexpr const char* kBroken = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nend_header\n0\nnan\n";

}  // namespace

TEST_CASE("an invalid script is refused with its line before anything is opened") {
  if (!hasDisplay()) return;
  for (const auto& [line, complaint] :
       {std::pair{"0.2 resize 640x", "script.txt:2: the width: '640x' is not a number"},
        {"0.2 key nose", "script.txt:2: unknown key 'nose'; keys are a to z 0 to 9 f1 to f12 space escape"},
        {"0.2 press", "script.txt:2: unknown event 'press'; choose key"},
        {"0.2 screenshot a.tif", "script.txt:2: a.tif: pictures are written as .png"},
        {"0.2 button left", "script.txt:2: down or up is missing"},
        {"0.2 push 0 2 0 0 0 0", "script.txt:2: the push is 2; it must be between"},
        {"0.2 push 0 0 0 1", "script.txt:2: the turn is missing"},
        {"0.05 quit", "script.txt:2: the time is before that of the line above"},
        {"0.2 click", "script.txt:2: the name is missing"},
        {"0.2 quit now", "script.txt:2: unexpected 'now'"}}) {
    const auto played = play("", std::string("0.1 mouse 1 2\n") + line + "\n");
    CHECK(played->outcome.code == 1);
    CHECK_MESSAGE(played->outcome.text.find(complaint) != std::string::npos, played->outcome.text);
  }
}

TEST_CASE("each press of the button is one stroke, even a quick one or one across an edge") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/cube.ply --size 560x420 --edit push",
      [](const std::filesystem::path& folder) { works("make cube -n 6000 -o " + (folder / "cube.ply").string()); }, R"(
0.1 mouse 177 210
0.3 key Space down
0.6 button left down
0.75 button left up
0.85 button left down
1.0 button left up
1.6 state %/quick.json
1.7 key Ctrl+Z
1.8 state %/once.json
1.9 mouse 139 210
2.0 button left down
2.2 mouse 159 210
2.4 mouse 189 210
2.6 mouse 219 210
2.8 mouse 299 210
3.0 mouse 199 210
3.2 mouse 169 210
3.4 button left up
4.0 state %/over.json
4.1 quit
)");
  CHECK(played->state("quick.json")["undo_count"] == 2);
  CHECK(played->state("once.json")["undo_count"] == 1);
  CHECK(played->state("over.json")["undo_count"] == 2);
}

TEST_CASE("a session in the window, from the first touch to the saved file") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 560x420 --rate 250 --edit push",
      [](const std::filesystem::path& folder) {
        makeSphere(folder);
        std::ofstream(folder / "broken.ply") << kBroken;
      },
      R"(
0.1 mouse 309 20
0.4 screenshot %/before.png
0.4 state %/before.json
0.45 mouse 177 210
0.5 key Space down
0.7 button left down
1.1 wheel 6
2.0 screenshot %/touch.png
2.0 state %/touch.json
2.1 button left up
2.2 key space up
2.3 mouse 309 20
2.6 screenshot %/dent.png
2.6 state %/dent.json
2.7 drop %/broken.ply
3.0 state %/broken.json
3.1 save %/saved.ply
3.4 state %/saved.json
3.5 key Ctrl+Z
4.0 screenshot %/undone.png
4.0 state %/undone.json
4.1 key ctrl+shift+z
4.3 state %/redone.json
4.4 mouse 157 220
4.5 button left down
4.6 mouse 237 210
4.7 button left up
4.8 state %/turned.json
4.9 resize 480 360
5.2 state %/resized.json
5.3 minimise
5.5 restore
5.7 key 3
5.8 key ]
6.0 state %/tool.json
6.1 quit
)");
  const auto before = played->state("before.json"), touch = played->state("touch.json");
  CHECK(before["points"] == 8000);
  CHECK(before["strokes"] == 0);
  CHECK(before["tool"] == "push");
  CHECK(before["size"] == std::vector{560, 420});
  CHECK(touch["contact"] == true);
  CHECK(touch["stylus"] == true);
  CHECK(touch["penetration_mm"] > 0);
  CHECK(touch["peak_force_N"] > 0.3);
  CHECK(touch["edits"] > 20);
  const auto dent = played->state("dent.json");
  CHECK(dent["strokes"] >= 1);
  CHECK(dent["contact"] == false);
  CHECK(dent["changed"] == true);
  CHECK(dent["ticks"] > touch["ticks"]);

  const auto broken = played->state("broken.json");
  CHECK(std::string(broken["last_message"]).find("broken.ply") != std::string::npos);
  CHECK(broken["model"] == before["model"]);
  CHECK(broken["edits"] == dent["edits"]);
  CHECK(played->state("saved.json")["changed"] == false);
  works("--quiet info " + (played->folder.path() / "saved.ply").string());
  const auto undone = played->state("undone.json");
  CHECK(undone["undo_count"] == dent["undo_count"].get<int>() - 1);
  CHECK(played->state("redone.json")["undo_count"] == dent["undo_count"]);
  CHECK(played->state("turned.json")["camera"]["eye"] != before["camera"]["eye"]);
  CHECK(played->state("resized.json")["size"] == std::vector{480, 360});
  CHECK(played->state("tool.json")["tool"] == "carve");
  CHECK(played->state("tool.json")["brush_radius_mm"] > 6.1);

  const auto picture = [&](const char* name) { return Picture(played->folder.path() / name); };
  const Picture first = picture("before.png"), touching = picture("touch.png"), dented = picture("dent.png");
  CHECK(ringPixels(first, 177, 210) == 0);
  CHECK(ringPixels(touching, 177, 210) > 30);
  CHECK(ringPixels(dented, 177, 210) == 0);
  CHECK(differing(first, dented, 177, 200, 40) > 100);  // the dent
  // Above the messages, whose height depends on the length of the folder's name.
  if (dent["undo_count"] == 1) CHECK(differing(first, picture("undone.png"), 177, 200, 40) < 10);
  CHECK(differing(first, dented, 239, 250, 10) == 0);  // and the rest is unchanged
  // The panel: darker than the background beside it.
  CHECK(first.at(500, 200)[0] < first.at(290, 40)[0]);
}

TEST_CASE("a second press at one position meets the surface, however soon the cursor arrives before it") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(3000), R"(
0.1 mouse 132 180
0.5 key space down
0.7 button left down
1.5 state %/first.json
1.6 button left up
1.7 key space up
1.8 mouse 229 350
2.1 mouse 132 180
2.1 key space down
2.1 button left down
3.1 state %/second.json
3.2 quit
)");
  for (const char* name : {"first.json", "second.json"}) {
    CAPTURE(name);
    const auto state = played->state(name);
    CHECK(state["contact"] == true);
    CHECK(state["penetration_mm"] > 0.1);
  }
}

TEST_CASE("a press acts where the cursor is, not on the stylus's way there, however quickly it follows a motion") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 560x420 --edit push", sphereOf(), R"(
0.1 mouse 119 280
0.3 key space down
0.6 mouse 229 160
0.6 button left down
1.2 state %/pressed.json
1.3 button left up
1.6 save %/after.ply
1.8 quit
)");
  const auto state = played->state("pressed.json");
  CHECK(state["contact"] == true);
  const auto at = state["proxy"];
  const DVec3 proxy(at[0].get<double>(), at[1].get<double>(), at[2].get<double>());
  const PointCloud before = readPly(played->folder / "sphere.ply"), after = readPly(played->folder / "after.ply");
  const PointTree whole(before.positions);
  std::vector<std::uint32_t> same;
  double farthest = 0;
  for (const Vec3& place : after.positions) {
    same.clear();
    whole.near(DVec3(place), 1e-4, same);
    if (same.empty()) farthest = std::max(farthest, glm::distance(DVec3(place), proxy));
  }
  CHECK(farthest > 3);
  CHECK(farthest < 12);
}

TEST_CASE("a script runs the same ticks on any machine; in real time ticks of a stylus that moves follow the clock") {
  if (!hasDisplay()) return;
  const std::string script = R"(
0.1 mouse 94 120
0.5 key space down
0.7 state %/held.json
0.7 button left down
1.5 state %/pressed.json
1.6 quit
)";
  const auto sphere = [](const std::filesystem::path& folder) { makeSphere(folder, 3000); };
  Result states[2];
  for (Result& state : states) {
    const auto played = playWell("%/sphere.ply --size 400x240 --rate 250 --edit push", sphere, script);
    state = played->state("pressed.json");
  }
  for (const char* key : {"ticks", "hip", "proxy", "force_N", "penetration_mm", "edits"}) {
    CAPTURE(key);
    CHECK(states[0][key] == states[1][key]);
  }
  CHECK(states[0]["missed_ticks"] == 0);
  CHECK(states[0]["ticks"] > 325);
  CHECK(states[0]["ticks"] < 400);
  CHECK(states[0]["edits"] > 0);
  const auto played = playWell("%/sphere.ply --size 400x240 --rate 250 --realtime", sphere, script);
  const auto ticksAt = [&](const char* file) {
    const auto state = played->state(file);
    return state["ticks"].get<int>() + state["missed_ticks"].get<int>();
  };
  CHECK(ticksAt("pressed.json") - ticksAt("held.json") > 100);
  CHECK(ticksAt("pressed.json") - ticksAt("held.json") < 300);
}

TEST_CASE("the cap of a 3D mouse moves the model, or the stylus once its first button has grabbed it") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(3000), R"(
0.1 mouse 132 180
0.4 state %/begin.json
0.5 push 0.4 0.2 0 0 0 0
0.8 push 0 0 0 0 0 0
0.9 state %/moved.json
1.0 push 0 0 0.8 0 0 0
1.3 push 0 0 0 0 0 0
1.4 state %/near.json
1.5 push 0 0 0 0 0.5 0
1.8 push 0 0 0 0 0 0
1.9 state %/turned.json
2.0 push 0 0 0 0 0 0 2
2.1 push 0 0 0 0 0 0
2.2 state %/fitted.json
2.3 push 0 0 0 0 0 0 1
2.4 push 0 0 -1 0 0 0
3.4 push 0 0 0 0 0 0
3.6 state %/touch.json
3.7 push 0 0 0.9 0 0 0
4.7 state %/back.json
4.8 push 0 0 0 0 0 0 1
5.0 state %/let.json
5.1 quit
)");
  const auto camera = [&](const char* name) { return played->state(name)["camera"]; };
  const auto part = [](const Result& v, int k) { return v[static_cast<std::size_t>(k)].get<double>(); };
  const auto distance = [&](const Result& one) {
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += std::pow(part(one["eye"], k) - part(one["target"], k), 2);
    return std::sqrt(sum);
  };
  const auto begin = camera("begin.json"), moved = camera("moved.json"), nearer = camera("near.json");
  CHECK(moved["target"] != begin["target"]);
  CHECK(distance(moved) == near(distance(begin), 1e-6));
  CHECK(distance(nearer) < 0.9 * distance(begin));
  CHECK(camera("turned.json")["eye"] != nearer["eye"]);
  CHECK(distance(camera("turned.json")) == near(distance(nearer), 1e-6));
  CHECK(distance(camera("fitted.json")) == near(distance(begin), 1e-6));
  const auto touch = played->state("touch.json"), back = played->state("back.json");
  CHECK(touch["stylus"] == true);
  CHECK(touch["contact"] == true);
  CHECK(touch["peak_force_N"] > 0.3);
  CHECK(touch["camera"] == played->state("fitted.json")["camera"]);  // the 3D mouse moves the stylus now, not the model
  CHECK(back["contact"] == false);
  CHECK(played->state("let.json")["stylus"] == false);
}

TEST_CASE("touching, sculpting and meshing in the window cause no Vulkan validation message") {
  if (!hasDisplay()) return;
  const auto played = play("%/sphere.ply --size 480x240 --rate 250 --edit carve --resolution 32", R"(
0.1 mouse 132 120
0.2 impatient
0.3 key m
0.3 state %/announced.json
0.3 patient
0.6 state %/mesh.json
0.7 key space down
0.9 button left down
1.0 wheel 16
1.6 button left up
1.7 key space up
1.9 state %/carved.json
2.0 key ctrl+z
2.2 state %/undone.json
2.3 resize 420 200
2.5 screenshot %/last.png
2.6 quit
)",
                           "--validate=core", [](const std::filesystem::path& folder) { makeSphere(folder, 4000); });
  CAPTURE(played->outcome.text);
  CHECK(played->outcome.code == 0);
  const auto mesh = played->state("mesh.json"), undone = played->state("undone.json");
  CHECK(played->state("announced.json")["last_message"] == "making the triangles");
  CHECK(mesh["mesh_triangles"] > 1000);
  CHECK(played->state("carved.json")["edits"] > 0);
  CHECK(played->state("carved.json")["mesh_triangles"] != mesh["mesh_triangles"]);
  CHECK(undone["undo_count"] == 0);
  CHECK(undone["mesh_triangles"] == mesh["mesh_triangles"]);  // the mesh follows an undo
}

TEST_CASE("the window can be closed while a model loads, and can load one model after another") {
  if (!hasDisplay()) return;
  int points = 200'000;
  const auto prepare = [&](const std::filesystem::path& folder) {
    makeSphere(folder, points);
    works("--quiet make torus -n 3000 -o " + (folder / "torus.ply").string());
  };
  const auto closed = play("%/torus.ply --size 320x240", R"(
0.1 impatient
0.2 drop %/sphere.ply
0.2 quit
)",
                           "", prepare);
  CAPTURE(closed->outcome.text);
  CHECK(closed->outcome.code == 0);
  points = 30'000;
  const auto changed = playWell("%/torus.ply %/sphere.ply --size 320x240", prepare, R"(
0.2 state %/torus.json
0.3 drop %/sphere.ply
0.6 state %/sphere.json
0.7 drop %/torus.ply
0.9 state %/again.json
1.0 quit
)");
  CHECK(changed->state("torus.json")["points"] == 3000);
  CHECK(changed->state("sphere.json")["points"] == points);
  CHECK(changed->state("again.json")["points"] == 3000);
  CHECK(contentOf(changed->folder.path() / "state" / "palpate" / "recent")
            .starts_with((changed->folder.path() / "torus.ply").string() + "\n"));
}

TEST_CASE("a session recorded in the window is replayed, in the window and without one") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x300 --rate 250 --edit push", sphereOf(3000), R"(
0.1 mouse 132 145
0.2 record %/session.log
0.3 key space down
0.6 button left down
1.4 button left up
1.5 key space up
1.6 record
1.7 state %/recorded.json
1.8 key ctrl+z
1.9 replay %/session.log
4.5 state %/replayed.json
4.6 record %/late.log
4.7 state %/late.json
4.8 quit
)");
  CHECK(played->state("recorded.json")["edits"] > 0);
  CHECK(played->state("replayed.json")["edits"] > played->state("recorded.json")["edits"]);
  CHECK(std::string(played->state("late.json")["last_message"]).find("begins with the model as its file") !=
        std::string::npos);
  checkEnds(0, "replay --tolerance 1e-9 " + (played->folder.path() / "session.log").string(),
            {"recorded edits        give the recorded points"});
}

TEST_CASE("a second GPU draws the model that the first one touches: edits are transferred through the host") {
  if (!hasDisplay()) return;
  const auto played =
      playWell("%/sphere.ply --size 480x300 --edit paint --backend vulkan --sight-gpu 0 --rate 250", sphereOf(3000), R"(
0.1 mouse 132 145
0.6 screenshot %/before.png
0.7 key space down
1.0 button left down
1.1 wheel 8
1.3 button left up
1.4 key space up
2.0 screenshot %/painted.png
2.0 state %/painted.json
2.1 quit
)");
  const auto painted = played->state("painted.json");
  CHECK(painted["backend"] == "vulkan");
  CHECK(painted["edits"] > 0);
  const Picture before(played->folder.path() / "before.png"), after(played->folder.path() / "painted.png");
  CHECK(differing(before, after, 132, 145, 30) > 20);
}

TEST_CASE("a held haptic device is felt in the window, and moves along the axes of the screen") {
  if (!hasDisplay()) return;
  // From outside the sphere into it, along the device's axis towards the user.
  const FakeDriver driver("fake_hd", "hurry\nlead 2\nbutton 1 3.5 60", "0,0,0,34.5\n1,0,0,28\n60,0,0,28\n");
  const auto played = playWell("%/sphere.ply --size 480x320 --edit push --device openhaptics", sphereOf(), R"(
4.5 state %/touch.json
5.0 key x
6.0 state %/turned.json
6.1 quit
)");
  const auto touched = played->state("touch.json"), turned = played->state("turned.json");
  const auto sizeOf = [](const Result& v) {
    return std::hypot(v[0].get<double>(), v[1].get<double>(), v[2].get<double>());
  };
  CAPTURE(touched.dump());
  CAPTURE(turned.dump());
  CHECK(touched["stylus"] == true);
  CHECK(driver.note().mostForce_N > 0.2);
  CHECK(touched["edits"].get<int>() > 0);  // the button is pressed
  // Towards the eye, which is at first in front of the model and then beside it.
  CHECK(touched["hip"][2].get<double>() > 0.8 * sizeOf(touched["hip"]));
  CHECK(turned["hip"][0].get<double>() > 0.9 * sizeOf(turned["hip"]));
  CHECK(driver.lastForce_N() == DVec3(0));
  CHECK(driver.note().threadFaults + driver.note().frameFaults == 0);
  CHECK(driver.note().closed == 1);
}

TEST_CASE("without a display the window reports what it needs") {
  if (std::getenv("PALPATE_PROGRAM")) return;
  const Outcome outcome = run("env -u DISPLAY -u WAYLAND_DISPLAY " + program() + " view");
  CHECK(outcome.code == 1);
  CHECK(outcome.text.find("needs a display") != std::string::npos);
}

}  // namespace palpate::view_test
