// Texts of the panels have room.
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_fit_test {

namespace {

// Opens each section, with what can be shown in it, and writes a state after each.
std::string allSections() {
  std::string script;
  double time_s = 0.1;
  int states = 0;
  const auto step = [&](const std::string& event) { script += fmt::format("{:.1f} {}\n", time_s += 0.1, event); };
  const auto shown = [&](std::initializer_list<const char*> events) {
    for (const char* const event : events) step(event);
    time_s += 0.2;
    step(fmt::format("state %/{}.json", states++));
  };
  shown({"key f2", "click more", "layer new the left side of the chin, without the beard", "layer close"});
  shown({"key 8"});
  shown({"key s", "where z > (", "key ctrl+a", "value classification 2"});
  for (const char* const key :
       {"key o", "key e", "key b", "key shift+b", "key a", "key w", "key shift+w", "key d", "key g"})
    shown({key});
  shown({"key f3"});
  shown({"key f4", "click colour by", "click classification"});
  shown({"key f5", "click more"});
  shown({"key f6", "click triangles", "click name of the view", "text from above", "click Remember view"});
  shown({"key s", "key d", "mouse 200 300", "button left down", "button left up", "mouse 250 330", "button left down",
         "button left up", "key f7"});
  shown({"key f8"});
  shown({"key f9"});
  shown({"key f10", "click Look for devices"});
  return script + fmt::format("{:.1f} quit\n", time_s + 0.2);
}

}  // namespace

TEST_CASE("no label, button or value of any section of the panel is cut off, in small windows and with large text") {
  if (!hasDisplay()) return;
  for (const char* const options : {"--size 900x600", "--size 1280x720", "--size 900x600 --text-size 200"}) {
    CAPTURE(options);
    const auto played =
        playWell(fmt::format("%/sphere.ply --backend cpu --edit inflate {}", options), sphereOf(1000), allSections());
    const auto& folder = played->folder.path();
    int states = 0;
    for (; std::filesystem::exists(folder / fmt::format("{}.json", states)); ++states) {
      const Result state = played->state(fmt::format("{}.json", states));
      CAPTURE(states);
      CHECK_MESSAGE(state["cut_off"].empty(), state["cut_off"].dump());
      CHECK_MESSAGE(state["errors"].empty(), state["errors"].dump());
      CHECK(state["messages_share"].get<double>() < 100.0 / 3);
    }
    CHECK(states == 20);
  }
}

TEST_CASE("with large text every tool is reached by its key and by scrolling, and messages leave the model free") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --backend cpu --size 900x600 --text-size 200", sphereOf(1000), R"(
0.05 key p
0.1 key s
0.3 state %/first.json
0.4 key g
0.6 state %/last.json
0.7 click Tools above
0.8 click Tools above
1.0 state %/above.json
1.1 click Tools below
1.2 click Tools below
1.4 state %/below.json
1.5 screenshot %/below.png
1.6 key f9
1.8 key ctrl+pagedown
2.0 key ctrl+pagedown
2.2 where ((
2.3 drop %/no_such_file_with_a_long_name_that_needs_many_lines_of_large_text_in_a_narrow_window.ply
2.4 drop %/second_file_with_a_long_name_that_needs_many_lines_of_large_text_in_a_narrow_window.ply
2.8 state %/errors.json
3.0 quit
)");
  const auto inView = [&](const char* state, const char* name) {
    for (const auto& tool : played->state(state)["tools"])
      if (tool["name"] == name) return tool["in_view"].get<bool>();
    return false;
  };
  CHECK(inView("first.json", "rectangle"));
  CHECK_FALSE(inView("first.json", "move"));
  CHECK(inView("last.json", "move"));  // chosen by its key
  CHECK(inView("above.json", "Sculpt"));
  CHECK_FALSE(inView("above.json", "move"));
  CHECK(inView("below.json", "move"));
  // The picture shows the model in its whole height, although the window has little room for it.
  const Picture picture(played->folder.path() / "sphere-1.png");
  int columns = 0;
  for (int x = 0; x < picture.width; ++x) columns += picture.at(x, 300) != picture.at(2, 2) ? 1 : 0;
  CHECK(columns > 450);
  const Result errors = played->state("errors.json");
  CHECK(errors["errors"].size() > 0);
  CHECK(errors["messages_share"].get<double>() > 5);
  CHECK(errors["messages_share"].get<double>() < 100.0 / 3);
}

}  // namespace palpate::view_fit_test
