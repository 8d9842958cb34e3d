// Presentation on the display: the memory of an X server is compared with the picture that the window drew.
#include <bit>

#include "tests/apps/window_play.hpp"
#include "tests/lost_gpu/lost_gpu.hpp"
#include "tests/says.hpp"

namespace palpate::view_present_test {

namespace {

// Screen of an X server that keeps it in a file (Xvfb -fbdir), in the format of xwd.
struct Screen {
  explicit Screen(const std::filesystem::path& file) : bytes(contentOf(file)) {
    REQUIRE(bytes.size() > 100);
    depth = field(3);
    width = field(4);
    height = field(5);
    bits = field(11);
    stride = field(12);
    pixels = field(0) + 12 * field(19);  // after header and colours
    REQUIRE(bytes.size() >= pixels + std::size_t{stride} * height);
  }
  std::array<int, 3> at(int x, int y) const {
    const std::size_t place = pixels + std::size_t{stride} * std::size_t(y) + std::size_t(x) * (bits / 8);
    const auto byte = [&](std::size_t i) { return int{static_cast<unsigned char>(bytes[place + i])}; };
    if (bits == 32) return {byte(2), byte(1), byte(0)};
    const int word = byte(0) | byte(1) << 8;  // 5, 6 and 5 bits
    return {(word >> 11) * 255 / 31, (word >> 5 & 63) * 255 / 63, (word & 31) * 255 / 31};
  }
  std::string bytes;
  std::uint32_t depth, width, height, bits, stride;
  std::size_t pixels;

 private:
  std::uint32_t field(std::size_t i) const {
    std::uint32_t value = 0;
    for (std::size_t k = 0; k < 4; ++k) value = value << 8 | static_cast<unsigned char>(bytes[4 * i + k]);
    return value;
  }
};

struct Shown {
  ScratchFolder folder;
  Outcome outcome;
  Picture picture() const { return Picture(folder / "picture.png"); }
  Screen screen() const { return Screen(folder / "screen.xwd"); }
};

// Plays until seen.json exists, and then keeps the content of the screen.
std::unique_ptr<Shown> show(const std::string& options, int depth) {
  auto shown = std::make_unique<Shown>();
  const std::filesystem::path& folder = shown->folder.path();
  makeSphere(folder, 3000);
  std::ofstream(folder / "script.txt") << inFolder(
      "0.1 mouse 10 470\n0.9 screenshot %/picture.png\n1.1 resize 600 480\n1.7 screenshot %/picture.png\n"
      "2.0 state %/seen.json\n",
      folder);
  std::ofstream(folder / "play.sh") << inFolder(
      "timeout 900 " + std::filesystem::absolute(program()).string() + " view %/sphere.ply --size 640x480 " + options +
          " --script %/script.txt &\npid=$!\n"
          "while kill -0 $pid 2> /dev/null && [ ! -e %/seen.json ]; do sleep 0.05; done\n"
          "cp %/Xvfb_screen0 %/screen.xwd\nkill $pid 2> /dev/null && exit 0\nwait $pid\n",
      folder);
  const std::string command = inFolder("cd % && XDG_STATE_HOME=%/state xvfb-run -a -s '-screen 0 800x600x" +
                                           std::to_string(depth) + " -fbdir %' bash play.sh",
                                       folder);
  shown->outcome = run(command);
  return shown;
}

// Number of pixels in the model's part of the window that differ by more than `tolerance` in some channel.
int wrongPixels(const Screen& screen, const Picture& picture, int tolerance) {
  return count(139, 240, 90, [&](int x, int y) {
    const auto a = screen.at(x, y), b = picture.at(x, y);
    return std::abs(a[0] - b[0]) > tolerance || std::abs(a[1] - b[1]) > tolerance || std::abs(a[2] - b[2]) > tolerance;
  });
}

}  // namespace

TEST_CASE("the screen shows the drawn picture, presented by the GPU or copied, also with 16-bit colours") {
  if (!hasDisplay()) return;
  struct Case {
    const char* options;
    int depth, tolerance;
  };
  for (const Case& each : {Case{"", 24, 0},
                           {"--present swapchain", 24, 0},
                           {"--present copy", 24, 0},
                           {"--present copy", 16, 8},
                           {"--present copy --sight-gpu 0", 24, 0}}) {
    CAPTURE(each.options);
    CAPTURE(each.depth);
    const auto shown = show(each.options, each.depth);
    REQUIRE_MESSAGE(shown->outcome.code == 0, shown->outcome.text);
    const Screen screen = shown->screen();
    const Picture picture = shown->picture();
    CHECK(int(screen.depth) == each.depth);
    CHECK(picture.width == 600);
    CHECK(wrongPixels(screen, picture, each.tolerance) == 0);
    // The picture contains the model, not only the background.
    CHECK(count(139, 240, 90, [&](int x, int y) { return picture.at(x, y) != picture.at(320, 400); }) > 5000);
  }
}

// NVIDIA's driver crashes if it is queried on such a server.
TEST_CASE("a driver that would crash on an X server without its extension is not queried, and pictures are copied") {
  if (!hasDisplay()) return;
  const LostGpuLayer layer("display");
  const auto shown = show("", 24);
  REQUIRE_MESSAGE(shown->outcome.code == 0, shown->outcome.text);
  CHECK(wrongPixels(shown->screen(), shown->picture(), 0) == 0);
  const ScratchFolder folder;
  const std::string command = "xvfb-run -a " + std::filesystem::absolute(program()).string() + " doctor > " +
                              (folder / "said").string() + " 2>&1";
  CHECK(std::system(command.c_str()) == 0);
  CHECK(says(contentOf(folder / "said"), "(--present copy): the X server has no NV-GLX"));
}

TEST_CASE("doctor reports how pictures are presented on the display, or that there is no display") {
  if (!hasDisplay()) return;
  const ScratchFolder folder;
  const std::string json = (folder / "d.json").string();
  const std::string command = "xvfb-run -a " + std::filesystem::absolute(program()).string() +
                              " --quiet doctor --json " + json + " > /dev/null";
  REQUIRE(std::system(command.c_str()) == 0);
  const auto display = jsonOf(json)["display"];
  REQUIRE(display.size() == jsonOf(json)["gpus"].size());
  bool presents = false;
  for (const auto& gpu : display) {
    CAPTURE(gpu.dump());
    CHECK((gpu["present"] == "swapchain" || gpu["present"] == "copy"));
    CHECK((gpu["present"] == "swapchain") == (gpu["reason"] == ""));
    presents = presents || gpu["present"] == "swapchain";
  }
  if (says(palpate("doctor").text, "llvmpipe")) CHECK(presents);
  const std::string without =
      "env -u DISPLAY -u WAYLAND_DISPLAY " + program() + " doctor --json " + json + " > " + (folder / "said").string();
  CHECK(std::system(without.c_str()) == 0);
  CHECK(says(contentOf(folder / "said"), "Display: none;"));
  CHECK(jsonOf(json)["display"].is_null());
}

}  // namespace palpate::view_present_test
