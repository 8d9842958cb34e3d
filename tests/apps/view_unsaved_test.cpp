// Unsaved strokes survive any end of the window, and input shorter than a frame is not lost.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"
#include "tests/splat_files.hpp"

namespace palpate::view_unsaved_test {

namespace {

constexpr const char* kTwoStrokes = R"(0.1 mouse 132 180
0.3 key space down
0.4 button left down
0.7 button left up
0.8 key space up
1.0 key ctrl+z
1.1 key ctrl+shift+z
1.2 mouse 109 160
1.3 key space down
1.4 button left down
1.7 button left up
1.8 key space up
)";

// State of a window that is ended by a signal after its script.
struct Struck {
  ScratchFolder folder;
  int status = 0;
  std::filesystem::path unsaved() const { return folder.path() / "state" / "palpate" / "unsaved"; }
  bool keepsSomething() const {
    std::error_code none;
    return std::filesystem::directory_iterator(unsaved(), none) != std::filesystem::directory_iterator();
  }
  // Opens another window, with that model or without one, which offers the strokes.
  Result later(const std::string& script, const std::string& model = "") const {
    const std::filesystem::path& path = folder.path();
    std::ofstream(path / "later.txt") << inFolder("0 ask\n0.1 state %/asked.json\n" + script + "9 quit\n", path);
    const Outcome outcome = run(inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a timeout 120 ", path) +
                                std::filesystem::absolute(program()).string() + " view " + model +
                                " --size 480x360 --rate 250 --edit push --script later.txt");
    CAPTURE(outcome.text);
    CHECK(outcome.code == 0);
    return jsonOf(path / "asked.json");
  }
};

// Runs the program in its folder and on a display of its own, and sends it `signal` after its script.
void strike(Struck& struck, int signal, const std::string& script, const std::string& options = "",
            const std::string& model = "sphere.ply") {
  const std::filesystem::path& path = struck.folder.path();
  makeSphere(path, 2000);
  if (!std::filesystem::exists(path / model)) std::filesystem::copy(path / "sphere.ply", path / model);
  std::ofstream(path / "script.txt") << inFolder(script + "4 state %/end.json\n4 await %/never\n", path);
  // The shell reports the process id of the window: xvfb-run is its parent.
  const std::string command =
      inFolder("cd % && echo $$ > pid && XDG_STATE_HOME=%/state exec env --default-signal=HUP " +
                   std::filesystem::absolute(program()).string() + " view %/" + model +
                   " --size 480x360 --rate 250 --edit push --script %/script.txt " + options,
               path);
  std::ofstream(path / "window.sh") << command << "\n";
  std::thread display([&] { run(inFolder("xvfb-run -a sh %/window.sh > %/said 2>&1", path)); });
  for (int i = 0; i < 1200 && !std::filesystem::exists(path / "end.json"); ++i)
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  std::this_thread::sleep_for(std::chrono::milliseconds(600));  // longer than strokes take to reach the file
  const std::string pid = contentOf(path / "pid");
  if (!pid.empty()) ::kill(std::stoi(pid), signal);
  display.join();
}

}  // namespace

TEST_CASE("unsaved strokes survive SIGKILL and can be resumed with their points, undo and file name") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGKILL, kTwoStrokes);
  const auto end = jsonOf(struck.folder.path() / "end.json");
  REQUIRE(end["changed"] == true);
  REQUIRE(struck.keepsSomething());
  const auto asked = struck.later(R"(0.2 click Restore them
0.5 state %/again.json
0.6 save %/again.ply
0.9 key ctrl+z
1.0 key ctrl+z
1.2 state %/undone.json
1.3 key ctrl+shift+z
1.4 key ctrl+shift+z
1.6 state %/redone.json
)");
  CHECK(asked["asks_about_strokes"] == true);
  const std::filesystem::path& path = struck.folder.path();
  const auto again = jsonOf(path / "again.json");
  for (const char* what : {"model", "save_file", "points", "undo_count", "changed"}) {
    CAPTURE(what);
    CHECK(again[what] == end[what]);
  }
  CHECK(jsonOf(path / "undone.json")["undo_count"] == 0);
  CHECK(jsonOf(path / "redone.json")["changed"] == false);
  CHECK_FALSE(struck.keepsSomething());
  // The same strokes in a window that was not interrupted.
  const auto whole = play("%/sphere.ply --size 480x360 --rate 250 --edit push",
                          std::string(kTwoStrokes) + "4 save %/whole.ply\n4.2 quit\n", "",
                          [](const auto& folder) { makeSphere(folder, 2000); });
  CHECK(contentOf(path / "again.ply") == contentOf(whole->folder.path() / "whole.ply"));
}

TEST_CASE("journey 5: ten mirrored strokes beside a mask, five of them undone, saved, killed and recovered") {
  if (!hasDisplay()) return;
  std::string script = R"(0.05 where y > 20
0.1 key s
0.2 click Lock
0.4 key 2
0.4 key t
)";
  const auto stroke = [&](double time_s, int k) {
    script +=
        fmt::format("{0:.2f} mouse {4} {5}\n{1:.2f} button left down\n{2:.2f} mouse {6} {7}\n{3:.2f} button left up\n",
                    time_s, time_s + 0.1, time_s + 0.15, time_s + 0.2, 99 + 12 * (k % 5), 155 + 25 * (k / 5),
                    109 + 12 * (k % 5), 162 + 25 * (k / 5));
  };
  for (int k = 0; k < 10; ++k) stroke(0.5 + 0.25 * k, k);
  script += "3.2 state %/ten.json\n";
  for (int k = 0; k < 5; ++k) script += "3.25 key ctrl+z\n";
  script += "3.4 state %/five.json\n3.4 save %/five.ply\n3.5 key escape\n3.5 key t\n";
  stroke(3.6, 11);
  Struck struck;
  strike(struck, SIGKILL, script, "--symmetry x");
  const std::filesystem::path& path = struck.folder.path();
  CHECK(jsonOf(path / "ten.json")["undo_count"] == 12);  // ten strokes, a selection and the mask
  CHECK(jsonOf(path / "five.json")["undo_count"] == 7);
  CHECK(jsonOf(path / "end.json")["undo_count"] == 8);
  // The mask has kept its points, and both sides of the sphere have been sculpted.
  const PointCloud was = readPly((path / "sphere.ply").string()), five = readPly((path / "five.ply").string());
  std::size_t left = 0, right = 0, locked = 0;
  for (std::size_t i = 0; i < was.size(); ++i) {
    if (was.positions[i] == five.positions[i]) continue;
    ++(was.positions[i].x < 0 ? left : right);
    locked += was.positions[i].y > 20;
  }
  CHECK(left > 4);
  CHECK(right > 4);
  CHECK(locked == 0);
  const auto asked = struck.later(R"(0.2 click Restore them
0.6 state %/again.json
0.7 key ctrl+z
0.9 save %/undone.ply
1.1 key ctrl+shift+z
1.3 state %/redone.json
1.4 key ctrl+z
)");
  CHECK(asked["asks_about_strokes"] == true);
  CHECK(jsonOf(path / "again.json")["changed"] == true);
  CHECK(jsonOf(path / "again.json")["points"] == jsonOf(path / "end.json")["points"]);
  CHECK(contentOf(path / "undone.ply") == contentOf(path / "five.ply"));
  CHECK(jsonOf(path / "redone.json")["points"] == jsonOf(path / "end.json")["points"]);
}

TEST_CASE("a stroke on a splat scene is recovered, and saved with the same Gaussians as without the crash") {
  if (!hasDisplay()) return;
  Struck struck;
  const test::SplatFile scene = test::splatBall(3);
  const auto makeScene = [&](const std::filesystem::path& folder) {
    std::ofstream(folder / "scene.ply", std::ios::binary) << scene.bytes();
  };
  makeScene(struck.folder.path());
  const std::string two = kTwoStrokes, stroke = two.substr(0, two.find("1.0 key"));
  strike(struck, SIGKILL, stroke, "", "scene.ply");
  REQUIRE(struck.keepsSomething());
  struck.later("0.2 click Restore them\n0.8 save %/again.ply\n");
  const auto whole = play("%/scene.ply --size 480x360 --rate 250 --edit push",
                          stroke + "4 save %/whole.ply\n4.6 quit\n", "", makeScene);
  const std::string again = contentOf(struck.folder / "again.ply");
  CHECK((again == contentOf(whole->folder / "whole.ply")));
  const auto saved = test::parsedSplats(again);
  CHECK(saved.names == scene.names);
  std::size_t same = 0;
  const std::set<std::string> rows(scene.rows.begin(), scene.rows.end());
  for (const std::string& row : saved.rows) same += rows.contains(row) ? 1 : 0;
  CHECK(same > scene.rows.size() / 2);
  CHECK(same < scene.rows.size());
}

TEST_CASE("classes and kept selections survive SIGKILL, with their undo, and reach the saved file") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGKILL, R"(0.1 where x > 0
0.2 value classification 6
0.3 key s
0.4 click name of the field
0.6 text half
0.7 key enter
)");
  const auto end = jsonOf(struck.folder.path() / "end.json");
  REQUIRE(end["undo_count"] == 3);
  struck.later(R"(0.2 click Restore them
0.5 state %/again.json
0.6 save %/again.ply
1.2 key ctrl+z
1.3 key ctrl+z
1.5 save %/undone.ply
)");
  const std::filesystem::path& path = struck.folder.path();
  CHECK(jsonOf(path / "again.json")["undo_count"] == 3);
  CHECK(jsonOf(path / "again.json")["selection"]["selected"] == end["selection"]["selected"]);
  const PointCloud again = readPly(path / "again.ply");
  REQUIRE(again.extra.size() == 2);
  CHECK(again.extra[0].name == "classification");
  CHECK(again.extra[1].name == "half");
  int wrong = 0, chosen = 0;
  for (std::size_t i = 0; i < again.size(); ++i) {
    const bool isChosen = again.positions[i].x > 0;
    chosen += isChosen;
    wrong += again.extra[0].data[i] != std::byte(isChosen ? 6 : 0) || again.extra[1].data[i] != std::byte(isChosen);
  }
  CHECK(chosen == end["selection"]["selected"]);
  CHECK(wrong == 0);
  CHECK(readPly(path / "undone.ply").extra.empty());
}

TEST_CASE("strokes after a save under another name can be resumed without the first file") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGKILL,
         std::string(kTwoStrokes) +
             "2.0 save %/n.ply\n2.9 mouse 149 200\n3.0 key space down\n3.1 button left down\n3.4 button left up\n"
             "3.5 key space up\n");
  const std::filesystem::path& path = struck.folder.path();
  std::filesystem::rename(path / "sphere.ply", path / "elsewhere.ply");
  struck.later("0.2 click Restore them\n0.8 state %/again.json\n1.0 save %/again.ply\n");
  const auto end = jsonOf(path / "end.json"), again = jsonOf(path / "again.json");
  for (const char* what : {"model", "save_file", "points", "changed"}) {
    CAPTURE(what);
    CHECK(again[what] == end[what]);
  }
}

TEST_CASE("the question about unsaved strokes says what they change in the file that was saved last") {
  if (!hasDisplay()) return;
  struct Case {
    const char* name;
    std::string script;
    int made, undone, undoCount;
  };
  const std::string save = "2.0 key ctrl+s\n";
  for (const Case& each : {Case{"undone", save + "2.8 key ctrl+z\n", 0, 1, 0},
                           Case{"all undone", save + "2.8 key ctrl+z\n2.9 key ctrl+z\n", 0, 2, 0},
                           Case{"another",
                                save + "2.8 key ctrl+z\n2.9 mouse 149 200\n3.0 key space down\n"
                                       "3.1 button left down\n3.4 button left up\n3.5 key space up\n",
                                1, 1, 1},
                           Case{"undone without a file", "2.8 key ctrl+z\n", 1, 0, 1}}) {
    CAPTURE(each.name);
    Struck struck;
    strike(struck, SIGKILL, kTwoStrokes + each.script);
    const auto end = jsonOf(struck.folder.path() / "end.json");
    const auto asked = struck.later("0.2 click Restore them\n0.6 state %/again.json\n0.7 save %/again.ply\n");
    CHECK(asked["asks_about_strokes"] == true);
    CHECK(asked["strokes_left"] == each.made);
    CHECK(asked["strokes_undone"] == each.undone);
    const auto again = jsonOf(struck.folder.path() / "again.json");
    CHECK(again["model"] == end["model"]);
    CHECK(again["changed"] == true);
    CHECK(again["undo_count"] <= each.undoCount);
  }
}

TEST_CASE("strokes of three killed windows are counted, and offered one after another") {
  if (!hasDisplay()) return;
  Struck struck;
  for (int i = 0; i < 3; ++i) {
    std::filesystem::remove(struck.folder.path() / "end.json");
    strike(struck, SIGKILL, kTwoStrokes);
  }
  CHECK(struck.later("0.2 click Ask again later\n0.4 state %/second.json\n0.5 click Discard them\n"
                     "0.7 state %/third.json\n")["strokes_waiting"] == 2);
  const std::filesystem::path& path = struck.folder.path();
  CHECK(jsonOf(path / "second.json")["strokes_waiting"] == 1);
  CHECK(jsonOf(path / "third.json")["strokes_waiting"] == 0);
  CHECK(jsonOf(path / "third.json")["asks_about_strokes"] == true);
  // Two are left. The second one is offered once the first one is saved.
  CHECK(struck.later(R"(0.2 click Restore them
0.5 state %/first.json
0.6 save %/one.ply
1.2 state %/saved.json
1.3 click Restore them
1.8 save %/two.ply
2.4 state %/both.json
)")["strokes_waiting"] == 1);
  CHECK(jsonOf(path / "first.json")["asks_about_strokes"] == false);
  CHECK(says(jsonOf(path / "first.json")["messages"].dump(),
             "1 more set of unsaved strokes: offered once these are saved"));
  CHECK(jsonOf(path / "saved.json")["asks_about_strokes"] == true);
  CHECK(jsonOf(path / "saved.json")["strokes_waiting"] == 0);
  CHECK(jsonOf(path / "both.json")["asks_about_strokes"] == false);
  CHECK(contentOf(path / "one.ply").size() > 10'000);
  CHECK(contentOf(path / "two.ply").size() > 10'000);
  CHECK_FALSE(struck.keepsSomething());
}

TEST_CASE("strokes on the file that is opened are offered before later ones on another file") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGKILL, kTwoStrokes);
  std::filesystem::remove(struck.folder.path() / "end.json");
  const std::string two = kTwoStrokes;
  strike(struck, SIGKILL, two.substr(0, two.find("1.0 key")), "", "other.ply");
  const auto asked = struck.later("0.2 click Discard them\n0.4 state %/second.json\n", "sphere.ply");
  CHECK(asked["strokes_waiting"] == 1);
  CHECK(asked["strokes_left"] == 2);
  CHECK(jsonOf(struck.folder.path() / "second.json")["strokes_left"] == 1);
}

TEST_CASE("a window ended by SIGTERM keeps its strokes, which can be discarded or offered again later") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGTERM, std::string(kTwoStrokes) + "1.9 save %/copy.ply\n2.1 key ctrl+z\n");
  CHECK(says(contentOf(struck.folder.path() / "said"), "are kept, and offered"));
  CHECK(jsonOf(struck.folder.path() / "end.json")["model"] == (struck.folder.path() / "copy.ply").string());
  CHECK(struck.later("0.2 click Ask again later\n0.4 state %/later.json\n")["asks_about_strokes"] == true);
  CHECK(jsonOf(struck.folder.path() / "later.json")["asks_about_strokes"] == false);
  REQUIRE(struck.keepsSomething());
  CHECK(struck.later("0.2 click Discard them\n")["asks_about_strokes"] == true);
  CHECK_FALSE(struck.keepsSomething());
  CHECK(struck.later("")["asks_about_strokes"] == false);
}

TEST_CASE("strokes survive a lost terminal, also on the GPU, and strokes that were all undone are not offered") {
  if (!hasDisplay()) return;
  Struck struck;
  strike(struck, SIGHUP, kTwoStrokes, "--backend vulkan");
  const auto end = jsonOf(struck.folder.path() / "end.json");
  CHECK(end["backend"] == "vulkan");
  REQUIRE(end["undo_count"] == 2);
  const auto asked = struck.later("0.2 click Restore them\n0.5 state %/again.json\n0.6 save %/again.ply\n");
  CHECK(asked["asks_about_strokes"] == true);
  const auto again = jsonOf(struck.folder.path() / "again.json");
  CHECK(again["undo_count"] == 2);
  CHECK(again["points"] == end["points"]);
  Struck undone;
  strike(undone, SIGKILL, std::string(kTwoStrokes) + "2.2 key ctrl+z\n2.4 key ctrl+z\n2.6 state %/undone.json\n");
  REQUIRE(jsonOf(undone.folder.path() / "undone.json")["changed"] == false);
  CHECK(undone.later("")["asks_about_strokes"] == false);
}

TEST_CASE("sculpting continues when the disk for unsaved strokes is full, and one error reports it") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  makeSphere(folder.path(), 20000);
  const std::filesystem::path limited = folder / "limited.sh";
  std::ofstream(limited) << "#!/bin/bash\nulimit -f 12\nexec '" + std::filesystem::absolute(program()).string() +
                                "' \"$@\"\n";
  std::filesystem::permissions(limited, std::filesystem::perms::owner_all);
  const char* before = std::getenv("PALPATE_PROGRAM");
  const std::string old = before ? before : "";
  ::setenv("PALPATE_PROGRAM", limited.c_str(), 1);
  const auto played = play((folder / "sphere.ply").string() + " --size 480x360 --rate 250 --edit push", R"(
0.1 mouse 132 180
0.3 key space down
0.4 button left down
1.9 button left up
1.9 key space up
2.1 state %/first.json
2.1 key escape
2.2 key space down
2.4 button left down
2.8 button left up
3 state %/second.json
3.1 quit
)");
  before ? ::setenv("PALPATE_PROGRAM", old.c_str(), 1) : ::unsetenv("PALPATE_PROGRAM");
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto first = played->state("first.json"), second = played->state("second.json");
  CHECK(first["undo_count"] == 1);
  CHECK(second["undo_count"] == 2);
  CHECK(second["edits"] > first["edits"]);
  REQUIRE(first["errors"].size() == 1);
  CHECK(says(std::string(first["errors"][0]), "unsaved strokes are no longer kept on disk"));
  CHECK(second["errors"].empty());  // the error was closed, and is not repeated
}

TEST_CASE("each tap of the stylus makes a stroke of its own, and a tap beside the model makes none") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", sphereOf(2000), R"(
0.1 mouse 132 180
0.3 key t
0.6 tap 132 180
1.2 state %/once.json
1.3 tap 109 160
1.3 tap 154 200
2.2 state %/thrice.json
2.3 key ctrl+z
2.6 state %/undone.json
2.7 tap 225 320
3.3 state %/beside.json
3.4 quit
)");
  CHECK(played->state("once.json")["undo_count"] == 1);
  CHECK(played->state("thrice.json")["undo_count"] == 3);
  CHECK(played->state("undone.json")["undo_count"] == 2);
  CHECK(played->state("beside.json")["undo_count"] == 2);
  CHECK(played->state("beside.json")["edits"] == played->state("undone.json")["edits"]);
}

TEST_CASE("a click or key press shorter than a frame is not lost, in a panel or on the model") {
  if (!hasDisplay()) return;
  const auto played =
      playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", sphereOf(2000), std::string(kTwoStrokes) + R"(
2 state %/before.json
2.1 tap 20 184
2.3 state %/tool.json
2.4 tap d
2.6 tap 112 160
2.8 tap 152 200
3 state %/measured.json
3.1 ask
3.2 quit
3.4 state %/asked.json
3.5 tap escape
3.7 state %/cancelled.json
3.8 quit
3.9 click Do not save
9 state %/after.json
)");
  CHECK(played->state("before.json")["tool"] == "push");
  CHECK(played->state("tool.json")["tool"] == "carve");
  CHECK(played->state("measured.json")["measured"] > 10);
  CHECK(played->state("asked.json")["asks_about_changes"] == true);
  CHECK(played->state("cancelled.json")["asks_about_changes"] == false);
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
}

}  // namespace palpate::view_unsaved_test
