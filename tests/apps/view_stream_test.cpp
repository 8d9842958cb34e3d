// A depth camera in the window: pausing and sculpting keep the picture, the points and the stroke.
#include "engine/io/ply_reader.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"

namespace palpate::view_stream_test {

TEST_CASE("a depth camera that is paused and sculpted keeps its picture and points, and is saved beside its folder") {
  if (!hasDisplay()) return;
  std::string script = "0.2 mouse 132 180\n";
  for (int i = 0; i < 12; ++i) script += "0.3 key ]\n";  // the points are far apart
  script += "0.4 key k\n0.7 state %/paused.json\n0.8 key space down\n0.9 impatient\n1.0 key 2\n";
  constexpr int kLooks = 40;
  for (int i = 0; i < kLooks; ++i) script += fmt::format("{:.2f} state %/wait{}.json\n", 1.05 + 0.05 * i, i);
  script += R"(
3.1 patient
3.3 state %/held.json
3.4 button left down
3.8 button left up
4.2 state %/struck.json
4.4 key ctrl+s
4.8 state %/saved.json
5.0 quit
)";
  const auto played = playWell(
      "%/room --size 480x360 --rate 250", [](const auto& folder) { writeRedwood(folder / "room"); }, script);
  const auto paused = played->state("paused.json"), held = played->state("held.json"),
             struck = played->state("struck.json"), saved = played->state("saved.json");
  for (int i = 0; i < kLooks; ++i) {
    const auto state = played->state(fmt::format("wait{}.json", i));
    CHECK(says(state["model"].dump(), "room"));
    CHECK(state["points"] > 0);
  }
  CHECK(held["stylus"] == true);  // Space was down all the time
  CHECK(held["points"] == paused["points"]);
  CHECK(struck["undo_count"] == 1);
  CHECK(struck["changed"] == true);
  const std::filesystem::path file = played->folder.path() / "room-sculpted.ply";
  CHECK(saved["save_file"] == file.string());
  CHECK(saved["changed"] == false);
  REQUIRE(std::filesystem::exists(file));
  CHECK(readPly(file).size() == saved["points"]);
}

}  // namespace palpate::view_stream_test
