// Journey of a surgeon: the skin of a CT is pressed with the stylus in true millimetres, depth and force are measured,
// and the model is filmed. Judged by the shape that is known.
#include <cmath>
#include <numbers>

#include "engine/io/cloud_formats.hpp"
#include "tests/apps/window_play.hpp"
#include "tests/near.hpp"

namespace palpate::journey_press_test {

namespace {

// A head of 150 x 190 x 220 mm on a neck that the scan cuts off, in a scanner's coordinates, z towards the head, no
// normals.
constexpr DVec3 kHead(75, 95, 110), kMiddle(-12.5, 230, -1043);
constexpr double kNeck = 55, kStep = 2;
PointCloud skin() {
  PointCloud cloud;
  cloud.origin = kMiddle;
  const auto add = [&](const DVec3& place) { cloud.positions.emplace_back(place); };
  constexpr double kGolden = 2.399963229728653;
  const auto count = static_cast<int>(4 * std::numbers::pi * 95 * 95 / (kStep * kStep));
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z);
    const DVec3 place = kHead * DVec3(r * std::cos(kGolden * i), r * std::sin(kGolden * i), z);
    if (place.z > 0 || std::hypot(place.x, place.y) > kNeck) add(place);
  }
  for (double z = -150; z < -60; z += kStep)
    for (double angle = 0; angle < 2 * std::numbers::pi; angle += kStep / kNeck) {
      const DVec3 place(kNeck * std::cos(angle), kNeck * std::sin(angle), z);
      if (glm::length(place / kHead) > 1) add(place);
    }
  cloud.storedAs.comments = {"comment units: mm"};
  return cloud;
}

DVec3 vec(const Result& v) { return {v[0].get<double>(), v[1].get<double>(), v[2].get<double>()}; }

void prepare(const std::filesystem::path& folder) { writeCloud(folder / "skin.ply", skin()); }

/// Lowest row of the picture that shows the model, and the widths of its upper and its lower quarter.
struct Silhouette {
  explicit Silhouette(const std::filesystem::path& file) {
    int channels = 0;
    stbi_uc* const data = stbi_load(file.string().c_str(), &width, &height, &channels, 4);
    REQUIRE(data);
    for (int y = 0; y < height; ++y) {
      int across = 0;
      for (int x = 0; x < width; ++x) across += data[4 * (y * width + x) + 3] > 127;
      if (across > 0) widths.push_back(across);
    }
    stbi_image_free(data);
  }
  int at(double share) const { return widths.at(static_cast<std::size_t>(share * static_cast<double>(widths.size()))); }
  int width = 0, height = 0;
  std::vector<int> widths;
};

}  // namespace

TEST_CASE("journey 4: the skin of a CT stands upright and is pressed in true millimetres; depth and force are kept") {
  if (!hasDisplay()) return;
  const auto played = playWell("%/skin.ply --size 900x600 --rate 500 --backend cpu --mm-per-unit 1", prepare, R"(
0.2 key c
0.3 state %/open.json
0.4 mouse 347 260
0.6 key space down
0.8 button left down
2.2 state %/pressed.json
2.3 button left up
2.5 key space up
2.9 click Export CSV
3.3 state %/ended.json
3.4 quit
)");
  const auto open = played->state("open.json"), pressed = played->state("pressed.json"),
             ended = played->state("ended.json");
  CHECK(open["up"] == "z");
  CHECK(open["mm_per_unit"] == 1);
  REQUIRE(pressed["contact"] == true);
  const DVec3 proxy = vec(pressed["proxy"]), hip = vec(pressed["hip"]), force = vec(pressed["force_N"]);
  const double depth_mm = pressed["penetration_mm"].get<double>();
  CHECK(depth_mm == within(2.5, 0.1));  // as deep as the hand aims at
  CHECK(glm::distance(proxy, hip) == within(depth_mm, 0.02));
  // The spring of the hand, 0.8 N/mm.
  CHECK(glm::length(force) == near(0.8 * depth_mm, 0.03));
  // The proxy is on the ellipsoid, and the force along its normal.
  const DVec3 place = proxy - kMiddle, gradient = place / (kHead * kHead);
  const double f = 0.5 * (glm::dot(place, gradient) - 1), off_mm = f / glm::length(gradient);
  CHECK(off_mm == within(0, 0.3));
  CHECK(glm::dot(glm::normalize(force), glm::normalize(gradient)) > 0.98);
  // What was felt is in the table.
  double deepest_mm = 0, strongest_N = 0;
  for (const Row& row : readTrace(played->folder.path() / "skin-ticks-1.csv")) {
    deepest_mm = std::max(deepest_mm, row.penetration_mm);
    strongest_N = std::max(strongest_N, glm::length(row.force));
  }
  CHECK(deepest_mm >= depth_mm - 0.01);
  CHECK(strongest_N >= glm::length(force) - 0.01);
  CHECK(ended["contact"] == false);
  CHECK(glm::length(vec(ended["force_N"])) == 0);  // none is left standing
}

TEST_CASE("journey 4: the film of a head shows it upright from all sides, on its neck") {
  const ScratchFolder folder;
  prepare(folder.path());
  works("--quiet render " + (folder / "skin.ply").string() + " -o " + (folder / "turn-%02d.png").string() +
        " --turntable 8 --background transparent --size 240x320");
  std::size_t least = 320, most = 0;
  for (int k = 0; k < 8; ++k) {
    CAPTURE(k);
    const Silhouette seen(folder / fmt::format("turn-{:02d}.png", k));
    least = std::min(least, seen.widths.size());
    most = std::max(most, seen.widths.size());
    CHECK(seen.at(0.35) > seen.at(0.9) + 20);  // the head is above the neck
    CHECK(seen.at(0.35) > 80);
  }
  CHECK(most - least < 12);
}

}  // namespace palpate::journey_press_test
