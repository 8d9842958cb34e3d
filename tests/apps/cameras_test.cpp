// A model's cameras in its pictures: where they are drawn, and that nothing else changes.
#include <algorithm>
#include <cmath>

#include "tests/apps/window_play.hpp"
#include "tests/colmap_writer.hpp"
#include "tests/rgbd_writer.hpp"
#include "tests/says.hpp"

namespace palpate::cameras_test {

namespace {

constexpr int kWidth = 480, kHeight = 360;
const DVec3 kEye(3, 4, -30);  // of the picture; it looks at the origin, with y down and a field of view of 45 degrees

/// A sheet of points about the origin, seen by four cameras in front of it that look along z.
WrittenColmap sheet() {
  WrittenColmap written{.camera = "1 PINHOLE 800 400 500 500 400 200", .images = {}, .points = {}};
  for (std::uint32_t k = 0; k < 4; ++k)
    written.images.push_back({.id = 7 + 2 * k, .centre = {k % 2 == 0 ? -4.0 : 4.0, k < 2 ? -3.0 : 3.0, -12}});
  for (int k = 0; k < 900; ++k)
    written.points.push_back(
        {.place = {0.4 * (k % 30 - 15), 0.4 * (k / 30 - 15), 0}, .color = {90, 90, 90}, .images = {7, 9, 11, 13}});
  return written;
}

DVec2 seenAt(const DVec3& place) {
  const DVec3 forward = glm::normalize(-kEye), up(0, -1, 0);
  const DVec3 right = glm::normalize(glm::cross(forward, up)), top = glm::cross(right, forward);
  const double focal_px = 0.5 * kHeight / std::tan(22.5 / 57.29577951308232);
  const DVec3 way = place - kEye;
  const double depth = glm::dot(way, forward);
  return {0.5 * kWidth + focal_px * glm::dot(way, right) / depth,
          0.5 * kHeight - focal_px * glm::dot(way, top) / depth};
}

std::string rendering(const std::filesystem::path& model, const std::filesystem::path& picture) {
  return "render " + model.string() + " -o " + picture.string() +
         fmt::format(" --size {}x{} --camera \"eye={},{},{} target=0,0,0 up=0,-1,0\" ", kWidth, kHeight, kEye.x, kEye.y,
                     kEye.z);
}

bool differs(const Picture& a, const Picture& b, const DVec2& place_px) {
  return differing(a, b, static_cast<int>(place_px.x), static_cast<int>(place_px.y), 1) > 0;
}

}  // namespace

TEST_CASE("render draws a camera's frustum with the corners of its intrinsics") {
  const ScratchFolder folder;
  writeColmap(folder / "model", sheet());
  works(rendering(folder / "model", folder / "without.png"));
  works(rendering(folder / "model", folder / "with.png") + "--cameras");
  const Picture without(folder / "without.png"), with(folder / "with.png");
  const auto isLine = [&](const DVec3& place) { return differs(with, without, seenAt(place)); };
  // All pyramids have the same size, which is measured in the picture along the lower right edge of the first.
  const DVec3 toCorner(400.0 / 500, 200.0 / 500, 1);
  const DVec3 first = sheet().images[0].centre;
  double length = 0;
  for (double at = 0.02; at < 4 && isLine(first + at * toCorner); at += 0.02) length = at;
  CHECK(length > 0.1);
  CHECK(length < 2);
  for (const WrittenImage& image : sheet().images) {
    CAPTURE(image.id);
    CHECK(isLine(image.centre));
    for (const double x : {-0.8, 0.8})
      for (const double y : {-0.4, 0.4}) {
        CHECK(isLine(image.centre + (length - 0.03) * DVec3(x, y, 1)));
        CHECK_FALSE(isLine(image.centre + (length + 0.25) * DVec3(x, 2.2 * y, 1)));
        CHECK(isLine(image.centre + (length - 0.03) * DVec3(0, y, 1)));  // the edges of the image rectangle
        CHECK(isLine(image.centre + (length - 0.03) * DVec3(x, 0, 1)));
      }
  }
  // All other pixels are unchanged.
  std::vector<std::array<DVec2, 2>> edges;
  for (const WrittenImage& image : sheet().images) {
    const auto seen = [&](double x, double y) { return seenAt(image.centre + length * DVec3(x, y, 1)); };
    const std::array corners{seen(-0.8, -0.4), seen(0.8, -0.4), seen(0.8, 0.4), seen(-0.8, 0.4)};
    const DVec2 ridge = seen(0, -0.6);  // of the roof above the upper edge
    for (std::size_t k = 0; k < 4; ++k) {
      edges.push_back({seenAt(image.centre), corners[k]});
      edges.push_back({corners[k], corners[(k + 1) % 4]});
    }
    edges.push_back({corners[0], ridge});
    edges.push_back({ridge, corners[1]});
  }
  const auto isFarFromAll = [&](const DVec2& p) {
    return std::ranges::all_of(edges, [&](const std::array<DVec2, 2>& edge) {
      const DVec2 along = edge[1] - edge[0];
      const double share = std::clamp(glm::dot(p - edge[0], along) / glm::dot(along, along), 0.0, 1.0);
      return glm::distance(p, edge[0] + share * along) > 4;
    });
  };
  std::size_t far = 0, changed = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (!isFarFromAll({x + 0.5, y + 0.5})) continue;
      ++far;
      changed += with.at(x, y) != without.at(x, y);
    }
  CHECK(far > kWidth * kHeight / 2);
  CHECK(changed == 0);
}

TEST_CASE("without a requested view the picture includes the cameras") {
  const ScratchFolder folder;
  WrittenColmap far = sheet();
  for (WrittenImage& image : far.images) image.centre.z = -60;
  writeColmap(folder / "model", far);
  const auto draw = [&](const std::string& options) {
    works("render " + (folder / "model").string() + " --size 240x180 --background 0,0,0 -o " +
          (folder / "p.png").string() + options);
    return Picture(folder / "p.png");
  };
  const auto pixels = [](const Picture& picture, auto&& is) {
    std::size_t found = 0;
    for (std::size_t i = 0; i < picture.rgb.size(); i += 3)
      found += is(picture.rgb[i], picture.rgb[i + 1], picture.rgb[i + 2]) ? 1 : 0;
    return found;
  };
  const auto isBlue = [](int red, int, int blue) { return blue > red + 60; };
  const auto isSheet = [](int red, int green, int blue) {
    return red > 20 && std::abs(red - green) < 20 && blue < red + 20;
  };
  const Picture with = draw(" --cameras");
  CHECK(pixels(with, isBlue) > 20);
  CHECK(pixels(with, isSheet) > 50);
  CHECK(pixels(draw(""), isBlue) == 0);
}

TEST_CASE("a model without cameras is drawn unchanged, with a message") {
  const ScratchFolder folder;
  works("--quiet make sphere -n 2000 -o " + (folder / "s.ply").string());
  works("render " + (folder / "s.ply").string() + " --size 200x150 -o " + (folder / "without.png").string());
  checkEnds(0,
            "render " + (folder / "s.ply").string() + " --size 200x150 --cameras -o " + (folder / "with.png").string(),
            {"no cameras are drawn: the model has no camera poses"});
  CHECK(contentOf(folder / "without.png") == contentOf(folder / "with.png"));
}

TEST_CASE("the first frame of a recording is drawn with its camera") {
  const ScratchFolder folder;
  writeRedwood(folder / "recorded");
  const std::string both = "render " + (folder / "recorded").string() +
                           " --size 240x180 --camera \"eye=2,-1,-2 target=0,0,1 up=0,-1,0\" -o ";
  works(both + (folder / "without.png").string());
  works(both + (folder / "with.png").string() + " --cameras");
  const Picture without(folder / "without.png"), with(folder / "with.png");
  std::size_t changed = 0;
  for (std::size_t i = 0; i < with.rgb.size(); ++i) changed += with.rgb[i] != without.rgb[i];
  CHECK(changed > 100);
  CHECK(changed < with.rgb.size() / 4);
}

TEST_CASE("unreliable COLMAP points are left out by info and render, and by convert on request, with a message") {
  const ScratchFolder folder;
  WrittenColmap written = sheet();
  for (int k = 0; k < 50; ++k) written.points.push_back({.place = {0.1 * k, 0, 900}, .images = {7, 9, 11}});
  writeColmap(folder / "model", written);
  const std::string model = (folder / "model").string(), out = (folder / "o.ply").string(),
                    json = (folder / "j.json").string();
  checkEnds(0, "convert " + model + " " + out + " --drop-unreliable --json " + json,
            {"50 of 950 points, which are unreliable: 50 with rays that meet at less than 1.5 "
             "degrees (--drop-unreliable)"});
  CHECK(jsonOf(json)["points"] == 900);
  works("convert " + model + " " + out + " --force --json " + json);
  CHECK(jsonOf(json)["points"] == 950);
  works("info " + model + " --json " + json);
  CHECK(jsonOf(json)["points"] == 900);
  CHECK(jsonOf(json)["cameras"] == 4);
  CHECK(says(jsonOf(json)["left_out"].get<std::string>(), "50 of 950 points"));
  works("info " + model + " --keep-unreliable --json " + json);
  CHECK(jsonOf(json)["points"] == 950);
  CHECK(jsonOf(json)["left_out"].is_null());
  const Outcome drawn = palpate("render " + model + " --size 64x48 -o " + (folder / "p.png").string());
  CHECK_MESSAGE(says(drawn.text, "left out: 50 of 950 points"), drawn.text);
}

TEST_CASE("the window shows a reconstruction's cameras, and a recording's camera with its path; Ctrl+F hides them") {
  if (!hasDisplay()) return;
  const auto played = playWell(
      "%/model --size 480x360 --backend cpu",
      [](const std::filesystem::path& folder) {
        writeColmap(folder / "model", sheet());
        writeRedwood(folder / "recorded", {.frames = 30});
      },
      R"(
0.1 key tab
0.3 screenshot %/with.png
0.35 state %/with.json
0.4 key ctrl+f
0.6 screenshot %/without.png
0.65 state %/without.json
0.7 drop %/recorded
0.9 state %/hidden.json
1.0 key ctrl+f
1.1 state %/shown.json
1.2 quit
)");
  CHECK(played->state("with.json")["cameras_shown"] == 4);
  CHECK(played->state("without.json")["cameras_shown"] == 0);
  CHECK(played->state("hidden.json")["cameras_shown"] == 0);
  CHECK(played->state("shown.json")["cameras_shown"] == 1);
  const Picture with(played->folder / "with.png"), without(played->folder / "without.png");
  std::size_t blue = 0, blueWithout = 0;
  for (std::size_t i = 0; i < with.rgb.size(); i += 3) {
    blue += with.rgb[i + 2] > with.rgb[i] + 60;
    blueWithout += without.rgb[i + 2] > without.rgb[i] + 60;
  }
  CHECK(blue > blueWithout + 50);
}

}  // namespace palpate::cameras_test
