// Saving in the window: the user is asked before a file would lose something, and no work of the user is lost.
#include "engine/io/ply_reader.hpp"
#include "engine/io/ply_writer.hpp"
#include "haptics/session_log.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_save_test {

namespace {

// A sphere with faces, as another program writes it, and a copy for later comparison.
void makeMesh(const std::filesystem::path& folder) {
  makeSphere(folder, 2000);
  PointCloud cloud = readPly(folder / "sphere.ply");
  cloud.storedAs.comments = {"comment of another program"};
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (std::uint32_t i = 0; i + 2 < cloud.size(); ++i) triangles.push_back({i, i + 1, i + 2});
  writePly(folder / "mesh.ply", cloud, {.triangles = &triangles});
  std::filesystem::copy_file(folder / "mesh.ply", folder / "original.ply");
}

// Presses the brush into the middle of the area that the panel leaves free in a window of 480 x 360.
std::string strokeAt(double time_s) {
  return fmt::format("{} mouse 132 180\n{} key space down\n{} button left down\n{} button left up\n{} key space up\n",
                     time_s, time_s + 0.2, time_s + 0.3, time_s + 0.8, time_s + 0.9);
}

bool exists(const Played& played, const char* name) { return std::filesystem::exists(played.folder.path() / name); }
std::string fileOf(const Played& played, const char* name) { return contentOf(played.folder.path() / name); }

}  // namespace

TEST_CASE("Ctrl+S asks before a mesh loses its faces, saves beside it by default, and asks only once") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/mesh.ply --size 480x360 --rate 250 --edit push",
      [](const auto& folder) {
        makeMesh(folder);
        std::ofstream(folder / "mesh-sculpted.ply") << "of yesterday";
      },
      strokeAt(0.1) + R"(
1.4 ask
1.5 key ctrl+s
1.7 state %/asked.json
1.7 screenshot %/asked.png
1.8 key ctrl+z
1.9 key escape
2.1 state %/cancelled.json
2.2 key ctrl+s
2.4 key enter
2.8 state %/saved.json
)" + strokeAt(2.9) +
          R"(
4.2 key ctrl+s
4.6 state %/again.json
4.7 quit
8 state %/after.json
)");
  const auto asked = played->state("asked.json"), cancelled = played->state("cancelled.json"),
             saved = played->state("saved.json"), again = played->state("again.json");
  CHECK(asked["asks_how_to_save"] == true);
  CHECK(asked["asks_about_changes"] == false);
  CHECK(asked["changed"] == true);
  CHECK(cancelled["asks_how_to_save"] == false);
  CHECK(cancelled["changed"] == true);
  CHECK(cancelled["undo_count"] == asked["undo_count"]);  // keys have no effect while the question is open
  CHECK(std::string(saved["save_file"]).ends_with("mesh-sculpted-2.ply"));
  CHECK(saved["changed"] == false);
  CHECK(says(std::string(saved["last_message"]), "mesh-sculpted-2.ply is saved"));
  CHECK(again["asks_how_to_save"] == false);
  CHECK(again["changed"] == false);
  CHECK_FALSE(exists(*played, "after.json"));
  CHECK(fileOf(*played, "mesh.ply") == fileOf(*played, "original.ply"));
  CHECK(fileOf(*played, "mesh-sculpted.ply") == "of yesterday");
  CHECK_FALSE(exists(*played, "mesh.ply.bak"));
  CHECK(readPly(played->folder.path() / "mesh-sculpted-2.ply").size() == again["points"]);
}

TEST_CASE("saving over a mesh keeps the original as a backup, and earlier backups too") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/mesh.ply --size 480x360 --rate 250 --edit push",
      [](const auto& folder) {
        makeMesh(folder);
        std::ofstream(folder / "mesh.ply.bak") << "of yesterday";
      },
      strokeAt(0.1) + R"(
1.4 ask
1.5 key ctrl+s
1.7 click Replace
2.3 state %/saved.json
)" + strokeAt(2.4) +
          R"(
3.7 key ctrl+s
4.1 state %/again.json
4.2 quit
)");
  const auto saved = played->state("saved.json"), again = played->state("again.json");
  CHECK(saved["changed"] == false);
  CHECK(says(std::string(saved["last_message"]), "mesh.ply.bak2"));
  CHECK(again["asks_how_to_save"] == false);
  CHECK(again["changed"] == false);
  CHECK(fileOf(*played, "mesh.ply.bak2") == fileOf(*played, "original.ply"));
  CHECK(fileOf(*played, "mesh.ply.bak") == "of yesterday");
  CHECK(exists(*played, "mesh.ply.bak3"));  // palpate's own file, which the second save replaced
  CHECK_FALSE(exists(*played, "mesh.ply.bak4"));
  CHECK(readPly(played->folder.path() / "mesh.ply").size() == again["points"]);
}

TEST_CASE("closing the window and choosing Save asks how to save a mesh, and Cancel keeps everything") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/mesh.ply --size 480x360 --rate 250 --edit push", makeMesh, strokeAt(0.1) + R"(
1.4 ask
1.5 quit
1.7 click Save
2.1 state %/asked.json
2.2 click Cancel
2.5 state %/cancelled.json
2.6 quit
2.8 click Save
3.2 click Save a copy
30 state %/after.json
)");
  CHECK(played->state("asked.json")["asks_how_to_save"] == true);
  CHECK(played->state("cancelled.json")["asks_how_to_save"] == false);
  CHECK(played->state("cancelled.json")["asks_about_changes"] == false);
  CHECK(played->state("cancelled.json")["changed"] == true);
  CHECK_FALSE(exists(*played, "after.json"));
  CHECK(fileOf(*played, "mesh.ply") == fileOf(*played, "original.ply"));
  CHECK(exists(*played, "mesh-sculpted.ply"));
}

TEST_CASE("a script without questions saves a mesh beside the original, and replaces palpate's own file") {
  if (!hasDisplay()) return;
  const std::string script = strokeAt(0.1) + "1.5 key ctrl+s\n1.9 state %/saved.json\n2.0 quit\n";
  const auto mesh = playWell("%/mesh.ply --size 480x360 --rate 250 --edit push", makeMesh, script);
  CHECK(mesh->state("saved.json")["changed"] == false);
  CHECK(fileOf(*mesh, "mesh.ply") == fileOf(*mesh, "original.ply"));
  CHECK(exists(*mesh, "mesh-sculpted.ply"));
  const auto ours = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", makeMesh, "0 ask\n" + script);
  CHECK(ours->state("saved.json")["asks_how_to_save"] == false);
  CHECK(std::string(ours->state("saved.json")["save_file"]).ends_with("sphere.ply"));
  CHECK(readPly(ours->folder.path() / "sphere.ply").size() == ours->state("saved.json")["points"]);
  CHECK(exists(*ours, "sphere.ply.bak"));
  CHECK_FALSE(exists(*ours, "sphere-sculpted.ply"));
}

TEST_CASE("undone strokes are not unsaved changes, redo restores them, and changes are relative to the saved state") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250 --edit push", makeKeptSphere, strokeAt(0.1) + R"(
1.4 ask
1.5 state %/dent.json
1.6 key ctrl+z
1.9 state %/undone.json
2.0 key ctrl+s
2.1 state %/nothing.json
2.2 key ctrl+shift+z
2.5 state %/redone.json
2.6 key ctrl+s
3.0 state %/saved.json
3.1 key ctrl+z
3.4 state %/behind.json
3.5 key ctrl+shift+z
3.8 state %/same.json
3.9 quit
8 state %/after.json
)");
  const auto changed = [&](const char* name) { return played->state(name)["changed"]; };
  REQUIRE(played->state("dent.json")["undo_count"] == 1);
  CHECK(changed("dent.json") == true);
  CHECK(changed("undone.json") == false);
  CHECK(says(std::string(played->state("nothing.json")["last_message"]), "nothing to save"));
  CHECK(changed("redone.json") == true);
  CHECK(changed("saved.json") == false);
  CHECK(changed("behind.json") == true);
  CHECK(changed("same.json") == false);
  CHECK_FALSE(exists(*played, "after.json"));  // the window was closed without a question
  CHECK(fileOf(*played, "sphere.ply") != fileOf(*played, "kept.ply"));
}

TEST_CASE("a window that closes ends its recording, and keeps an older log of that name") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --edit push", sphereOf(2000),
                               "0.1 record %/take.log\n0.4 record\n0.5 record %/take.log\n0.5 state %/again.json\n" +
                                   strokeAt(0.6) + "2.0 quit\n");
  const auto& folder = played->folder.path();
  CHECK(says(std::string(played->state("again.json")["last_message"]), "take.log.bak"));
  const SessionRecord last = readSessionLog(folder / "take.log"), older = readSessionLog(folder / "take.log.bak");
  REQUIRE(older.end);
  REQUIRE(last.end);
  CHECK(last.edits.points.size() > 0);
  CHECK(older.edits.points.empty());
}

TEST_CASE("saving under a name that says no format is refused, and a change of notation is said") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/german.csv --size 480x600",
      [](const auto& folder) {
        std::ofstream out(folder / "german.csv");
        out << "x;y;z\n";
        for (int k = 0; k < 100; ++k) out << k % 10 << ",5;" << k / 10 << ",25;0,5\n";
      },
      R"(
0.1 click Feel
0.2 click Look
0.3 click Look
0.4 click Save and record
0.6 click Save as
0.8 state %/none.json
1.0 click other.ply
1.1 text a.tsv
1.2 click Save as
1.4 state %/refused.json
1.5 save %/copy.csv
2.5 state %/saved.json
2.6 quit
)");
  const auto lastMessage = [&](const char* state) { return std::string(played->state(state)["last_message"]); };
  CHECK(says(lastMessage("none.json"), "type the name of a file"));
  CHECK(says(lastMessage("refused.json"), "a.tsv: clouds are written as"));
  CHECK_FALSE(exists(*played, "a.tsv"));
  CHECK(says(lastMessage("saved.json"), "copy.csv is saved, with decimal points and commas between columns"));
}

TEST_CASE("a recording on a full disk gives one message, and the session continues") {
  if (!hasDisplay()) return;
  // The program's files are limited to 100 KiB: three quarters of a second of ticks.
  const ScratchFolder folder;
  const std::filesystem::path limited = folder / "limited.sh";
  std::ofstream(limited) << "#!/bin/bash\nulimit -f 100\nexec '" + std::filesystem::absolute(program()).string() +
                                "' \"$@\"\n";
  std::filesystem::permissions(limited, std::filesystem::perms::owner_all);
  const char* before = std::getenv("PALPATE_PROGRAM");
  const std::string old = before ? before : "";
  ::setenv("PALPATE_PROGRAM", limited.c_str(), 1);
  const auto played = play("%/sphere.ply --size 480x360 --edit push", "0.1 record %/take.log\n" + strokeAt(0.2) + R"(
2.5 state %/full.json
2.6 record
2.8 state %/ended.json
2.9 quit
)",
                           "", [](const auto& scene) { makeSphere(scene, 2000); });
  before ? ::setenv("PALPATE_PROGRAM", old.c_str(), 1) : ::unsetenv("PALPATE_PROGRAM");
  CAPTURE(played->outcome.text);
  REQUIRE(played->outcome.code == 0);
  const auto full = played->state("full.json");
  CHECK(full["ticks"] > 2000);
  CHECK(full["edits"] > 0);
  CHECK(full["recording"] == true);
  CHECK(says(std::string(full["last_message"]), "take.log: cannot be written"));
  CHECK(played->state("ended.json")["recording"] == false);
  CHECK(played->state("ended.json")["last_message"] == full["last_message"]);  // no further message
  const std::string& text = played->outcome.text;
  REQUIRE(says(text, "the session continues"));
  CHECK(text.find("the session continues") == text.rfind("the session continues"));
  checkEnds(
      0, "replay --recover --save " + (folder / "r.ply").string() + " " + (played->folder.path() / "take.log").string(),
      {"they were not written"});
}

}  // namespace palpate::view_save_test
