// Opening and saving in the window: a file that cannot be opened changes nothing, and a saved file becomes the open
// one.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/program.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_open_test {

namespace {

// Presses the brush into the middle of the area that the panel leaves free in a window of 480 x 360.
std::string strokeAt(double time_s) {
  return fmt::format("{} mouse 132 180\n{} key space down\n{} button left down\n{} button left up\n{} key space up\n",
                     time_s, time_s + 0.2, time_s + 0.3, time_s + 0.6, time_s + 0.7);
}

// Drops each file, and writes the state to a file of the same name.
std::string dropAll(double time_s, const std::vector<std::string>& names) {
  std::string script;
  for (const std::string& name : names) {
    script += fmt::format("{} drop %/{}\n{} state %/{}.json\n", time_s, name, time_s + 0.3, name);
    time_s += 0.4;
  }
  return script;
}

void checkNothingIsLost(const std::string& backend) {
  CAPTURE(backend);
  const std::vector<std::string> refused{"empty.ply", "broken.ply", "none.ply", "text.ply", "folder"};
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --rate 250 --edit push --backend " + backend,
      [](const auto& folder) {
        makeSphere(folder, 2000);
        std::ofstream(folder / "empty.ply")
            << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
               "property float z\nend_header\n";
        std::ofstream(folder / "broken.ply") << "ply\nformat ascii 1.0\nelement vertex 7\n";
        std::ofstream(folder / "text.ply") << "a letter\n";
        std::filesystem::create_directory(folder / "folder");
      },
      strokeAt(0.1) + "1 ask\n1.1 state %/dent.json\n" + dropAll(1.2, refused) + strokeAt(4) + R"(
5 state %/again.json
5.1 key ctrl+z
5.2 key ctrl+z
5.5 state %/undone.json
5.6 quit
)");
  const auto dent = played->state("dent.json"), again = played->state("again.json");
  REQUIRE(dent["undo_count"] == 1);
  for (const std::string& name : refused) {
    CAPTURE(name);
    const auto state = played->state(name + ".json");
    CHECK(says(std::string(state["last_message"]), name));
    CHECK(state["asks_about_changes"] == false);  // a file that cannot be opened discards nothing
    CHECK(state["model"] == dent["model"]);
    CHECK(state["undo_count"] == 1);
    CHECK(state["changed"] == true);
    CHECK(state["edits"] == dent["edits"]);
  }
  CHECK(again["undo_count"] == 2);
  CHECK(again["edits"] > dent["edits"]);
  CHECK(played->state("undone.json")["changed"] == false);
}

}  // namespace

TEST_CASE("a file that cannot be opened changes nothing: model, strokes and undo stay, on either back end") {
  if (!hasDisplay()) return;
  checkNothingIsLost("cpu");
  checkNothingIsLost("vulkan");
}

TEST_CASE("a model saved under another name has that file from then on, and a file that failed to open is ignored") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", makeKeptSphere, strokeAt(0.1) + R"(
1 ask
1.1 save %/mine.ply
1.3 state %/saved.json
1.4 key ctrl+s
1.5 state %/nothing.json
1.6 drop %/none.ply
1.8 state %/none.json
1.9 key d
2.0 mouse 112 160
2.2 button left down
2.2 button left up
2.4 mouse 152 200
2.6 button left down
2.6 button left up
2.7 click true length, mm
2.8 text 40
2.9 click Set
3.2 state %/scaled.json
3.3 key ctrl+s
3.4 state %/again.json
3.5 quit
8 state %/after.json
)");
  const std::string mine = played->folder.path() / "mine.ply";
  for (const char* name : {"saved.json", "nothing.json", "none.json", "scaled.json", "again.json"}) {
    CAPTURE(name);
    CHECK(played->state(name)["model"] == mine);
    CHECK(played->state(name)["save_file"] == mine);
  }
  CHECK(says(std::string(played->state("nothing.json")["last_message"]), "mine.ply already contains these points"));
  CHECK(says(std::string(played->state("none.json")["last_message"]), "none.ply"));
  CHECK(played->state("scaled.json")["mm_per_unit"] != played->state("saved.json")["mm_per_unit"]);
  CHECK(played->state("scaled.json")["measured"] > 0);  // and is still shown
  CHECK(says(std::string(played->state("again.json")["last_message"]), "mine.ply already contains these points"));
  CHECK_FALSE(std::filesystem::exists(played->folder.path() / "after.json"));
  CHECK(contentOf(played->folder.path() / "sphere.ply") == contentOf(played->folder.path() / "kept.ply"));
  CHECK(contentOf(played->folder.path() / "state" / "palpate" / "recent").starts_with(mine));
}

TEST_CASE("a question in the window ends the stroke, and none starts behind it") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", sphereOf(2000), strokeAt(0.1) + R"(
1 ask
1.1 key space down
1.3 button left down
1.5 state %/pressing.json
1.6 quit
1.8 state %/asked.json
1.9 mouse 99 160
2.1 mouse 149 200
2.3 state %/later.json
2.4 click Cancel
2.6 state %/cancelled.json
2.7 quit
2.9 click Do not save
)");
  CHECK(played->state("pressing.json")["stylus"] == true);
  for (const char* name : {"asked.json", "later.json", "cancelled.json"}) {
    CAPTURE(name);
    CHECK(played->state(name)["stylus"] == false);
    CHECK(played->state(name)["contact"] == false);
    CHECK(played->state(name)["edits"] == played->state("asked.json")["edits"]);
  }
}

TEST_CASE("file dialogues can be used by keyboard alone, and say which file will be replaced") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --rate 250",
      [](const auto& folder) {
        makeSphere(folder, 2000);
        std::filesystem::create_directory(folder / "a");
        works("--quiet make cube -n 500 -o " + (folder / "cube.ply").string());
      },
      R"(
0.1 key ctrl+shift+s
0.4 screenshot %/original.png
0.5 text mine
0.7 screenshot %/mine.png
0.8 key enter
1.2 state %/saved.json
1.3 key ctrl+o
1.6 key down
1.7 key down
1.8 key down
1.9 key enter
2.4 state %/opened.json
2.5 key ctrl+o
2.8 text sphere.ply
2.9 key h
3.0 key escape
3.2 click name
3.4 state %/closed.json
3.5 key ctrl+o
3.8 text sphere.ply
3.9 key enter
4.4 state %/again.json
4.5 quit
)");
  const auto& folder = played->folder.path();
  CHECK(played->state("saved.json")["model"] == (folder / "mine.ply").string());
  CHECK(readPly(folder / "mine.ply").size() == 2000);
  CHECK(played->state("opened.json")["model"] == (folder / "cube.ply").string());  // it follows two folders in the list
  CHECK(says(std::string(played->state("closed.json")["last_message"]), "'name' cannot be clicked"));
  CHECK(played->state("again.json")["model"] == (folder / "sphere.ply").string());
  // The dialogue warns in a line that the model's own file would be replaced; for a new name there is no such line.
  const Picture original(folder / "original.png"), mine(folder / "mine.png");
  CHECK(differing(original, mine, 240, 180, 150) > 200);
}

TEST_CASE("opening another model closes the save dialogue, so that the first model's file is not overwritten") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/sphere.ply --size 480x360 --rate 250",
      [](const auto& folder) {
        makeSphere(folder, 2000);
        works("--quiet make cube -n 500 -o " + (folder / "other.ply").string());
      },
      R"(
0.1 key ctrl+shift+s
0.4 drop %/other.ply
1.2 click Replace
1.6 state %/state.json
1.7 quit
)");
  const auto state = played->state("state.json");
  CHECK(state["points"] == 500);
  CHECK(says(std::string(state["last_message"]), "'Replace' cannot be clicked"));
  CHECK(readPly(played->folder.path() / "sphere.ply").size() == 2000);
}

}  // namespace palpate::view_open_test
