// The picture that the window saves is the one that `render` draws with the same camera and settings.
#include "tests/apps/window_play.hpp"
#include "tests/says.hpp"

namespace palpate::view_picture_test {

namespace {

constexpr const char* kModel = "%/ball.ply --size 480x400 --rate 250 --backend cpu ";

/// A bumpy ball without colours.
void makeBall(const std::filesystem::path& folder) {
  works("--quiet make bumpy-sphere -n 9000 -o " + (folder / "ball.ply").string());
}

/// Saves a picture in a window whose script begins with `script`, and draws it by `render`, both with `settings`.
void checkSame(const std::string& settings, const std::string& script, const std::string& ofRender) {
  const auto played = playWell(kModel + settings, makeBall, "\n" + script + R"(
0.9 state %/view.json
1.0 key ctrl+p
1.4 quit
)");
  const auto at = [&](const char* name) { return (played->folder.path() / name).string(); };
  works("--quiet render " + at("ball.ply") + " -o " + at("rendered.png") + " --size 480x400 " + settings + ofRender +
        " --camera '" + played->state("view.json")["camera"]["text"].get<std::string>() + "'");
  const Picture saved(at("ball-1.png")), rendered(at("rendered.png"));
  REQUIRE(saved.width == rendered.width);
  REQUIRE(saved.height == rendered.height);
  // The unit of the sums depends on the room for further points, so that a few samples are rounded otherwise.
  int most = 0;
  std::size_t others = 0;
  for (std::size_t i = 0; i < saved.rgb.size(); ++i) {
    const int by = std::abs(int{saved.rgb[i]} - int{rendered.rgb[i]});
    most = std::max(most, by);
    others += by > 0;
  }
  CHECK(most <= 8);
  CHECK(static_cast<double>(others) < 0.01 * static_cast<double>(saved.rgb.size()));
  CHECK(differing(saved, rendered, 240, 200, 190) == 0);
}

}  // namespace

TEST_CASE("a saved picture is that of render, beside panels, with its bar and in each light") {
  if (!hasDisplay()) return;
  checkSame("", "", " --scale-bar");
  checkSame("--material plaster --occlusion on --cavity on --ground on ", "0.3 key 4", " --scale-bar");
}

TEST_CASE("a saved picture is that of render, without perspective, in colours of heights and with their legend") {
  if (!hasDisplay()) return;
  checkSame("--color-by height ", "0.3 key ctrl+8", " --scale-bar");
  checkSame("--color-by z --color-map turbo ", "0.3 click Look\n0.5 click scale", "");
}

}  // namespace palpate::view_picture_test
