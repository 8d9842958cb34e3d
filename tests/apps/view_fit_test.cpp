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
  shown({"key f2", "click more", "layer new", "layer close"});
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
    }
    CHECK(states == 20);
  }
}

}  // namespace palpate::view_fit_test
