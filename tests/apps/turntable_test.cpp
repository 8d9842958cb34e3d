// Transparent pictures, orthographic ones, and turntables on the command line.
#include <algorithm>

#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::turntable_test {

namespace {

constexpr int kWidth = 200, kHeight = 150;

struct Pixels {
  explicit Pixels(const std::filesystem::path& file) {
    int width = 0, height = 0, channels = 0;
    data = stbi_load(file.string().c_str(), &width, &height, &channels, 4);
    REQUIRE(data);
    REQUIRE(width == kWidth);
    REQUIRE(height == kHeight);
  }
  ~Pixels() { stbi_image_free(data); }
  Pixels(const Pixels&) = delete;
  Pixels& operator=(const Pixels&) = delete;
  int alpha(int x, int y) const { return data[4 * (y * kWidth + x) + 3]; }
  /// Columns and rows that are covered by the model.
  struct Box {
    int left = kWidth, right = 0, top = kHeight, bottom = 0;
  };
  Box box() const {
    Box box;
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x)
        if (alpha(x, y) > 127)
          box = {std::min(box.left, x), std::max(box.right, x), std::min(box.top, y), std::max(box.bottom, y)};
    return box;
  }
  stbi_uc* data = nullptr;
};

/// A long bar along x with y up.
void writeBar(const std::filesystem::path& file) {
  std::ofstream out(file);
  for (double x = -3; x <= 3; x += 0.05)
    for (double y = -1; y <= 1; y += 0.05)
      for (const double z : {-0.3, 0.3}) out << x << ' ' << y << ' ' << z << " 0 0 " << (z > 0 ? 1 : -1) << '\n';
}

std::string renders(const std::filesystem::path& model, const std::string& output, const std::string& options) {
  return "--quiet render " + model.string() + " -o " + output + " --up y --size 200x150 " + options;
}

}  // namespace

TEST_CASE("render draws without a background, and refuses files that cannot be transparent") {
  const ScratchFolder folder;
  writeBar(folder / "bar.xyz");
  works(renders(folder / "bar.xyz", folder / "clear.png", "--background transparent"));
  const Pixels clear(folder / "clear.png");
  CHECK(clear.alpha(0, 0) == 0);
  CHECK(clear.alpha(kWidth / 2, kHeight / 2) == 255);
  works(renders(folder / "bar.xyz", folder / "plain.png", ""));
  CHECK(Pixels(folder / "plain.png").alpha(0, 0) == 255);
  checkEnds(2, renders(folder / "bar.xyz", folder / "clear.jpg", "--background transparent"),
            {"clear.jpg cannot be transparent", ".png"});
  checkEnds(2, renders(folder / "bar.xyz", folder / "clear.mp4", "--background transparent --turntable 4"),
            {"clear.mp4 cannot be transparent"});
  checkEnds(2, renders(folder / "bar.xyz", folder / "clear.png", "--background clear"), {"or transparent"});
}

TEST_CASE("render draws lengths of an orthographic picture by its height") {
  const ScratchFolder folder;
  writeBar(folder / "bar.xyz");
  works(renders(folder / "bar.xyz", folder / "o.png",
                "--background transparent --camera \"eye=0,0,5 target=0,0,0 ortho=6\""));
  const Pixels::Box box = Pixels(folder / "o.png").box();
  CHECK(box.right - box.left == within(150, 3));  // 25 pixels a unit
  CHECK(box.bottom - box.top == within(50, 3));
  checkEnds(2, renders(folder / "bar.xyz", folder / "o.png", "--camera ortho=-1"), {"not a height above 0"});
}

TEST_CASE("a turntable shows the model from all around, whole and in the same place") {
  const ScratchFolder folder;
  writeBar(folder / "bar.xyz");
  for (const char* camera : {"", " --camera isometric"}) {
    CAPTURE(camera);
    works("--force " + renders(folder / "bar.xyz", folder / "turn-%02d.png",
                               "--turntable 4 --background transparent" + std::string(camera)));
    const Pixels front(folder / "turn-00.png"), side(folder / "turn-01.png"), back(folder / "turn-02.png");
    CHECK_FALSE(std::filesystem::exists(folder / "turn-04.png"));
    for (const Pixels* view : {&front, &side, &back}) {
      const Pixels::Box box = view->box();
      CHECK(box.left > 2);
      CHECK(box.right < kWidth - 3);
      CHECK(box.top > 2);
      CHECK(box.bottom < kHeight - 3);
      CHECK(0.5 * (box.left + box.right) == within(0.5 * kWidth, 3));
    }
    if (*camera != 0) continue;
    CHECK(front.box().right - front.box().left > 120);
    CHECK(side.box().right - side.box().left < 0.3 * (front.box().right - front.box().left));
    CHECK(back.box().right - back.box().left == within(front.box().right - front.box().left, 3));
  }
}

TEST_CASE("a turntable replaces no file without --force, and says what its output needs") {
  const ScratchFolder folder;
  writeBar(folder / "bar.xyz");
  std::ofstream(folder / "t-1.png") << "mine";
  const std::string command = renders(folder / "bar.xyz", folder / "t-%d.png", "--turntable 3");
  checkEnds(1, command, {"t-1.png", "exists", "--force"});
  CHECK(contentOf(folder / "t-1.png") == "mine");
  CHECK_FALSE(std::filesystem::exists(folder / "t-0.png"));
  works("--force " + command);
  CHECK(contentOf(folder / "t-1.png") != "mine");
  for (const char* name : {"t.png", "t-%s.png", "%d-%d.png"})
    checkEnds(2, renders(folder / "bar.xyz", folder / name, "--turntable 3"), {"needs a number", "turn-%03d.png"});
  checkEnds(2, renders(folder / "bar.xyz", folder / "t-%d.png", "--turntable 1"), {"--turntable"});
  checkEnds(2, renders(folder / "bar.xyz", folder / "u-%d.png", "--turntable 3 --depth d.pfm"), {"--depth"});
}

TEST_CASE("a film is made by ffmpeg, and without it the error says what to do") {
  const ScratchFolder folder, programs;
  writeBar(folder / "bar.xyz");
  const auto film = [&](const std::string& options) {
    return run("PATH=" + programs.path().string() + ":/usr/bin:/bin " + program() + " " +
               renders(folder / "bar.xyz", folder / "turn.mp4", "--turntable 3 " + options));
  };
  const auto install = [&](const std::string& script) {
    std::ofstream(programs / "ffmpeg") << "#!/bin/sh\n" << script;
    std::filesystem::permissions(programs / "ffmpeg", std::filesystem::perms::owner_all);
  };
  // In place of the encoder: lists the pictures that it was given.
  install("for last; do :; done\n[ \"$last\" = - ] || ls \"$(dirname \"$last\")\" > \"$last\"\n");
  const Outcome made = film("");
  CHECK_MESSAGE(made.code == 0, made.text);
  CHECK(says(contentOf(folder / "turn.mp4"), "00000.png\n00001.png\n00002.png\n"));
  CHECK(film("").code == 1);
  install("for last; do :; done\n[ \"$last\" = - ] || exit 9\n");
  const Outcome failed = film("--force");
  CHECK(failed.code == 1);
  CHECK_MESSAGE(says(failed.text, "ffmpeg failed with exit code 9"), failed.text);
  CHECK(says(contentOf(folder / "turn.mp4"), "00000.png"));  // the older film stays
  // No folder of pictures is left.
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()) == 2);
  const Outcome missing = run("PATH=" + (programs.path() / "empty").string() + " " + program() + " " +
                              renders(folder / "bar.xyz", folder / "other.mp4", "--turntable 3"));
  CHECK(missing.code == 1);
  CHECK_MESSAGE(says(missing.text, "ffmpeg, which was not found"), missing.text);
}

TEST_CASE("the window's view becomes orthographic and back by a key, and is touched as it is seen") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 480x360 --rate 250", sphereOf(5000), R"(
0.1 mouse 132 180
0.2 state %/begin.json
0.3 key ctrl+8
0.5 state %/ortho.json
0.6 wheel 3
0.8 state %/near.json
0.9 key space down
1.0 button left down
1.6 state %/pressed.json
1.7 button left up
1.7 key space up
1.8 key ctrl+8
2.0 state %/back.json
2.1 quit
)");
  CHECK(played->state("begin.json")["camera"]["ortho"].is_null());
  const double height = played->state("ortho.json")["camera"]["ortho"].get<double>();
  CHECK(height > 100);
  CHECK(played->state("near.json")["camera"]["ortho"].get<double>() < 0.8 * height);
  CHECK(played->state("pressed.json")["contact"] == true);
  CHECK(played->state("back.json")["camera"]["ortho"].is_null());
}

TEST_CASE("views are remembered by name for their model, shown again, and forgotten") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/sphere.ply --size 900x1000 --rate 250", sphereOf(3000), R"(
0.1 click Look
0.3 key ctrl+8
0.5 state %/first.json
0.6 click name of the view
0.7 text left ear
0.8 click Remember view
1.0 click Remember view
1.2 key ctrl+8
1.3 click right
1.5 state %/elsewhere.json
1.6 click left ear
1.8 state %/shown.json
1.9 click Forget view 1
2.1 quit
)");
  const auto camera = [&](const char* name) { return played->state(name)["camera"]; };
  CHECK(camera("elsewhere.json") != camera("first.json"));
  CHECK(camera("elsewhere.json")["ortho"].is_null());
  CHECK(camera("shown.json") == camera("first.json"));
  const std::string kept = contentOf(played->folder / "state/palpate/views");
  CHECK_MESSAGE(says(kept, "sphere.ply\tleft ear\teye="), kept);
  CHECK_FALSE(says(kept, "view 1"));
  // The text is one for --camera: the same view.
  std::string text = kept.substr(kept.find("eye="));
  text.resize(text.find('\n'));
  works("--quiet render " + (played->folder / "sphere.ply").string() + " -o " +
        (played->folder / "again.png").string() + " --camera \"" + text + "\"");
  // The next window of this model has it too; one of another model does not.
  std::filesystem::copy_file(played->folder.path() / "sphere.ply", played->folder.path() / "other.ply");
  const auto again = [&](const std::string& model) {
    std::ofstream(played->folder.path() / "again.txt")
        << "0.1 click Look\n0.3 click left ear\n0.6 state again.json\n0.8 quit\n";
    return run("cd " + played->folder.path().string() + " && XDG_STATE_HOME=state timeout 100 xvfb-run -a " +
               std::filesystem::absolute(program()).string() + " view " + model +
               " --size 900x1000 --script again.txt");
  };
  CHECK(again("sphere.ply").code == 0);
  CHECK(camera("again.json") == camera("first.json"));
  CHECK(again("other.ply").code == 0);
  CHECK(camera("again.json") != camera("first.json"));
}

TEST_CASE("pictures along a way begin and end with its cameras, and a wrong line is named") {
  const ScratchFolder folder;
  const std::string model = (folder / "ball.ply").string(), way = (folder / "way.txt").string();
  works("--quiet make bumpy-sphere -n 4000 --size 2 -o " + model);
  const std::array<std::string, 2> cameras{"eye=0,0,5 target=0,0,0 up=0,1,0 fov=40",
                                           "eye=4,1,0 target=0,0,0 up=0,1,0 fov=40"};
  std::ofstream(way) << "# from the front to the side\n" << cameras[0] << "\n\n" << cameras[1] << '\n';
  const std::string size = " --size 96x72 --guides compass,box";
  works("--quiet render " + model + " -o " + (folder / "w-%02d.png").string() + " --frames 5 --camera-path " + way +
        size);
  CHECK_FALSE(std::filesystem::exists(folder / "w-05.png"));
  const auto differ = [&](const std::string& a, const std::string& b) {
    const Picture one(folder / a), other(folder / b);
    int worst = 0;
    for (std::size_t i = 0; i < one.rgb.size(); ++i) worst += std::abs(int{one.rgb[i]} - int{other.rgb[i]}) > 8;
    return worst;
  };
  for (const std::size_t end : {0U, 1U}) {
    const std::string alone = fmt::format("alone-{}.png", end);
    works("--quiet render " + model + " -o " + (folder / alone).string() + " --camera '" + cameras[end] + "'" + size);
    CHECK(differ(alone, end == 0 ? "w-00.png" : "w-04.png") < 40);
  }
  CHECK(differ("w-00.png", "w-02.png") > 300);
  works("--quiet render " + model + " -o " + (folder / "bare.png").string() + " --size 96x72 --camera '" + cameras[0] +
        "'");
  CHECK(differ("w-00.png", "bare.png") > 60);

  const std::string begin = "render " + model + " -o " + (folder / "x-%d.png").string() + " --camera-path ";
  std::ofstream(folder / "wrong.txt") << cameras[0] << "\neye=1,2\n";
  checkEnds(1, begin + (folder / "wrong.txt").string(), {"wrong.txt:2: ", "'eye=1,2' needs three numbers"});
  std::ofstream(folder / "mixed.txt") << cameras[0] << "\northo=3\n";
  checkEnds(1, begin + (folder / "mixed.txt").string(), {"mixed.txt:2: ", "orthographic"});
  std::ofstream(folder / "one.txt") << cameras[0] << '\n';
  checkEnds(1, begin + (folder / "one.txt").string(), {"fewer than two cameras"});
  checkEnds(2, begin + way + " --turntable 5", {"--camera-path: leave out --turntable"});
  checkEnds(2, begin + way + " --camera eye=1,2,3", {"--camera-path: leave out --camera"});
  checkEnds(2, "render " + model + " -o " + (folder / "x.png").string() + " --frames 5", {"--camera-path"});
}

}  // namespace palpate::turntable_test
