// Splat scenes in a picture, against the reference in double precision, and how their Gaussians follow the points.
#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <limits>
#include <random>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/cloud/edited_gaussians.hpp"
#include "engine/cloud/shortest_rotation.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/render/gaussian_reference.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::gaussians_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

constexpr std::array<std::uint8_t, 3> kBackground{40, 90, 200};

/// The Gaussians beside a sheet of points at z = 0, which are what is felt.
PointCloud sceneOf(const std::vector<FileGaussian>& gaussians) {
  PointCloud cloud;
  for (int y = -10; y <= 10; ++y)
    for (int x = -10; x <= 10; ++x) {
      cloud.positions.emplace_back(0.1f * static_cast<float>(x), 0.1f * static_cast<float>(y), 0);
      cloud.normals.emplace_back(0, 0, 1);
      cloud.colors.push_back({120, 120, 120, 255});
    }
  cloud.storedAs.baggage = recordsOf(gaussians);
  return cloud;
}

class Strewn {
 public:
  explicit Strewn(std::uint32_t seed) : random_(seed) {}

  double in(double low, double high) { return std::uniform_real_distribution(low, high)(random_); }
  DVec3 vector(double most) {
    const double z = in(-most, most), y = in(-most, most);
    return {in(-most, most), y, z};
  }
  FileGaussian gaussian(std::size_t harmonics, double logScale = -2.5) {
    FileGaussian g{.center = vector(1),
                   .logScales = DVec3(logScale) + vector(1.5),
                   .rotation = DVec4(vector(1), in(-1, 1)),
                   .opacityLogit = in(-4, 5),
                   .color = vector(1.7)};
    for (std::size_t k = 0; k < harmonics; ++k) g.harmonics.push_back(vector(0.4));
    for (int k = 0; k < 3; ++k) g.center[k] = static_cast<double>(static_cast<float>(g.center[k]));
    return g;
  }
  std::vector<FileGaussian> gaussians(std::size_t count, std::size_t harmonics, double logScale = -2.5) {
    std::vector<FileGaussian> all;
    while (all.size() < count) all.push_back(gaussian(harmonics, logScale));
    return all;
  }

 private:
  std::mt19937 random_;
};

Camera pinhole() {
  Camera camera{.eye = DVec3(1.6, 1.1, 2.4), .up = {0, 1, 0}, .nearDepth = 0.05};
  return camera;
}
Camera orthographic() {
  Camera camera{.eye = DVec3(1.6, 1.1, 2.4), .up = {0, 1, 0}, .height = 2.6, .nearDepth = 0.05};
  return camera;
}

const FrameOptions kUnlit{.pass = ImagePass::color, .gaussians = true, .background = kBackground};

struct Fixture : PictureFixture {
  using PictureFixture::PictureFixture;

  /// The largest difference of a channel, of 255; depths are compared as well.
  double errorOf(const std::vector<FileGaussian>& gaussians, const Camera& camera, const UVec2& size_px,
                 FrameOptions options = kUnlit, std::uint32_t supersample = 1) {
    Frame frame(device, size_px.x, size_px.y, supersample);
    const PointCloud cloud = sceneOf(gaussians);
    draw(frame, DrawnCloud(device, cloud), camera, options);
    const Image image = frame.readColor();
    const DepthImage depths = frame.readDepth();
    const std::vector<CompositedPixel> expected = composited(gaussians, camera, size_px);
    double largest = 0;
    std::size_t wrongDepths = 0;
    for (std::size_t i = 0; i < expected.size(); ++i) {
      const double behind = options.transparent ? 0 : expected[i].transmittance,
                   opacity = 1 - expected[i].transmittance;
      const bool isClear = options.transparent && opacity < 0.05;  // a colour of few steps
      for (int c = 0; c < 3 && !isClear; ++c) {
        const double background = kBackground[static_cast<std::size_t>(c)] / 255.0;
        const double color = (expected[i].color[c] + behind * background) / (options.transparent ? opacity : 1);
        const double seen = image.rgba[i][static_cast<std::size_t>(c)];
        largest =
            std::max(largest, (options.transparent ? opacity : 1) * std::abs(seen - 255 * std::clamp(color, 0.0, 1.0)));
      }
      largest = std::max(largest, std::abs(image.rgba[i][3] - 255 * (options.transparent ? opacity : 1.0)));
      wrongDepths += std::abs(static_cast<double>(depths.depth[i]) - expected[i].depth) > 1e-3 * expected[i].depth;
    }
    // Where transmittance is one half but for rounding another Gaussian may be the one that blocks it.
    CHECK(wrongDepths <= expected.size() / 500);
    return largest;
  }
};

}  // namespace

TEST_CASE_FIXTURE(Fixture, "Gaussians of each degree are drawn as the reference draws them") {
  for (const std::size_t harmonics : {0, 3, 8, 15})
    for (const Camera& camera : {pinhole(), orthographic()}) {
      CAPTURE(harmonics);
      CAPTURE(camera.isOrthographic());
      Strewn strewn(static_cast<std::uint32_t>(7 + harmonics));
      CHECK(errorOf(strewn.gaussians(300, harmonics), camera, {131, 77}) < 1.5);
    }
}

TEST_CASE_FIXTURE(Fixture, "pictures of Gaussians of odd and tiny sizes are right to the last pixel") {
  Strewn strewn(3);
  const std::vector<FileGaussian> gaussians = strewn.gaussians(120, 3, -2);
  for (const UVec2& size_px : {UVec2(1, 1), UVec2(1, 40), UVec2(33, 1), UVec2(17, 31), UVec2(64, 64), UVec2(65, 33)}) {
    CAPTURE(size_px.x);
    CHECK(errorOf(gaussians, pinhole(), size_px) < 1.5);
  }
}

TEST_CASE_FIXTURE(Fixture, "Gaussians are composited over the background, and have their opacity without one") {
  Strewn strewn(5);
  const std::vector<FileGaussian> gaussians = strewn.gaussians(60, 3);
  FrameOptions options = kUnlit;
  options.transparent = true;
  CHECK(errorOf(gaussians, pinhole(), {90, 70}, options) < 1.5);
  options = kUnlit;
  options.pass = ImagePass::final;  // with dither
  CHECK(errorOf(gaussians, pinhole(), {90, 70}, options) < 1.5);
  CHECK(errorOf(gaussians, pinhole(), {90, 70}, options, 2) < 1.5);
}

TEST_CASE_FIXTURE(Fixture, "no Gaussians, and a single one, are drawn") {
  CHECK(errorOf({}, pinhole(), {20, 20}) < 1.5);
  CHECK(errorOf({FileGaussian{.color = DVec3(1, 0, -1)}}, pinhole(), {40, 40}) < 1.5);
  CHECK(errorOf({FileGaussian{.logScales = DVec3(-9), .opacityLogit = 30}}, pinhole(), {41, 41}) <
        1.5);  // far below a pixel
}

TEST_CASE_FIXTURE(Fixture, "Gaussians that are flat, huge, behind the eye or not numbers harm no others") {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN(), kInf = std::numeric_limits<double>::infinity();
  Strewn strewn(11);
  std::vector<FileGaussian> gaussians = strewn.gaussians(50, 0);
  const auto add = [&](FileGaussian g) { gaussians.push_back(std::move(g)); };
  add({.logScales = {-1, -1, -100}, .color = DVec3(1)});                             // a disc
  add({.center = {0.3, 0, 0}, .logScales = {-1, -100, -100}, .color = {1, -1, 0}});  // a line
  add({.logScales = DVec3(-100), .color = DVec3(1)});                                // a position
  add({.center = {0, 0, -1}, .logScales = DVec3(3), .opacityLogit = -1});            // wider than the picture
  add({.center = {0, 0, -2},
       .logScales = {5, -4, -4},
       .rotation = {0.9, 0.1, 0.3, 0.2},
       .color = DVec3(-1)});                                // a streak
  add({.center = {3.2, 2.2, 4.8}, .logScales = DVec3(1)});  // behind the eye
  add({.center = {1.6, 1.1, 2.4}});                         // at it
  add({.center = {kNan, 0, 0}});
  add({.center = {0, kInf, 0}});
  add({.logScales = {kNan, 0, 0}});
  add({.rotation = DVec4(0)});
  add({.opacityLogit = kNan});
  add({.opacityLogit = kInf, .color = {0.5, 1, 0}});  // opaque
  add({.color = {kNan, 0, 0}});
  for (const Camera& camera : {pinhole(), orthographic()}) CHECK(errorOf(gaussians, camera, {97, 65}) < 1.5);
}

TEST_CASE_FIXTURE(CoreValidated<Fixture>, "ten thousand translucent Gaussians in one tile are all composited") {
  Strewn strewn(13);
  std::vector<FileGaussian> gaussians = strewn.gaussians(10'000, 0, -3);
  for (FileGaussian& g : gaussians) {
    g.center *= 0.05;
    for (int k = 0; k < 3; ++k) g.center[k] = static_cast<double>(static_cast<float>(g.center[k]));
    g.opacityLogit = -5.2;  // 0.0055
  }
  Camera camera = pinhole();
  camera.eye *= 3.0;
  CHECK(errorOf(gaussians, camera, {48, 48}) < 1.5);
}

TEST_CASE_FIXTURE(CoreValidated<Fixture>, "more Gaussians than a list of small bins holds are drawn in larger bins") {
  Strewn strewn(17);
  // At 32 pixels 1,216 bins, each with a list of 9,375 words: 46 MB.
  std::vector<FileGaussian> gaussians = strewn.gaussians(60, 0, -3);
  while (gaussians.size() < 300'000) gaussians.push_back({.center = DVec3(0, 0, 100)});  // behind the eye
  CHECK(errorOf(gaussians, pinhole(), {1201, 1000}) < 1.5);
}

TEST_CASE_FIXTURE(Fixture, "the same Gaussians give the same bytes") {
  Strewn strewn(19);
  std::vector<FileGaussian> gaussians = strewn.gaussians(2'000, 3);
  for (std::size_t i = 1; i < gaussians.size(); i += 2) gaussians[i].center = gaussians[i - 1].center;  // equal depths
  const PointCloud cloud = sceneOf(gaussians);
  const Image first = picture(cloud, pinhole(), kUnlit, 80, 60, 1);
  for (int k = 0; k < 3; ++k) CHECK(picture(cloud, pinhole(), kUnlit, 80, 60, 1).rgba == first.rgba);
}

TEST_CASE_FIXTURE(Fixture, "the depth of Gaussians is that of their surface") {
  // Flat, opaque Gaussians in the plane z = 0: the median depth is that of the plane, also beside their centres.
  std::vector<FileGaussian> gaussians;
  for (int y = -3; y <= 3; ++y)
    for (int x = -3; x <= 3; ++x)
      gaussians.push_back({.center = DVec3(0.3 * x, 0.3 * y, 0), .logScales = {-1.5, -1.5, -9}, .opacityLogit = 4});
  const Camera camera = pinhole();
  Frame& frame = frameOf(80, 60, 1);
  draw(frame, DrawnCloud(device, sceneOf(gaussians)), camera, kUnlit);
  const DepthImage depths = frame.readDepth();
  const DVec2 size_px(80, 60);
  for (const DVec3& place : {DVec3(0), DVec3(0.3, 0.2, 0), DVec3(-0.4, 0.1, 0), DVec3(0.15, -0.45, 0)}) {
    const DVec3 at = *camera.project(place, size_px);
    const std::size_t pixel = static_cast<std::size_t>(at.y) * 80 + static_cast<std::size_t>(at.x);
    CHECK(static_cast<double>(depths.depth[pixel]) == within(at.z, 0.03));
  }
}

TEST_CASE_FIXTURE(Fixture, "fields, heights and normals are those of the surface, not of the Gaussians") {
  Strewn strewn(23);
  const DrawnCloud drawn(device, sceneOf(strewn.gaussians(10, 0)));
  CHECK(showsGaussians(drawn, kUnlit));
  FrameOptions options = kUnlit;
  options.color = ColorSource::height;
  CHECK_FALSE(showsGaussians(drawn, options));
  options = kUnlit;
  options.pass = ImagePass::normal;
  CHECK_FALSE(showsGaussians(drawn, options));
  CHECK_FALSE(showsGaussians(drawn, {}));
  CHECK_FALSE(showsGaussians(DrawnCloud(device, strewnCloud(5)), kUnlit));
}

namespace {

/// Gaussians in the sheet of points, away from its border, and one far above it.
std::vector<FileGaussian> sheetOfGaussians(std::size_t harmonics) {
  Strewn strewn(29);
  std::vector<FileGaussian> gaussians = strewn.gaussians(150, harmonics, -3);
  for (FileGaussian& g : gaussians) g.center *= DVec3(0.9, 0.9, 0.05), g.opacityLogit = 2;
  gaussians.push_back({.center = {0, 0, 1.5}, .logScales = DVec3(-3), .color = DVec3(1.5)});
  gaussians.back().harmonics.resize(harmonics);
  return gaussians;
}

struct EditedFixture : Fixture {
  /// The picture after edits that a drawn cloud followed.
  Image followed(const PointCloud& cloud, const std::vector<PointState>& states) {
    DrawnCloud drawn(device, cloud, {.spare = 100, .painted = true, .edited = true});
    drawn.catchUp(states);
    Frame& frame = frameOf(120, 90, 1);
    draw(frame, drawn, pinhole(), kUnlit);
    return frame.readColor();
  }
  /// The picture of what is saved.
  Image saved(const PointCloud& cloud, const std::vector<PointState>& states) {
    return picture(editedCloud(cloud, states), pinhole(), kUnlit, 120, 90, 1);
  }
  static double meanDifference(const Image& a, const Image& b) {
    double sum = 0;
    for (std::size_t i = 0; i < a.rgba.size(); ++i)
      for (std::size_t c = 0; c < 3; ++c) sum += std::abs(int{a.rgba[i][c]} - int{b.rgba[i][c]});
    return sum / (3.0 * static_cast<double>(a.rgba.size()));
  }
};

}  // namespace

TEST_CASE_FIXTURE(EditedFixture, "Gaussians move and rotate with their points, as they are saved") {
  const PointCloud cloud = sceneOf(sheetOfGaussians(8));
  std::vector<PointState> states = statesOf(cloud);
  SUBCASE("nothing") {}
  SUBCASE("shifted") {
    for (PointState& state : states) state.position += Vec3(0.2f, -0.1f, 0.15f);
  }
  SUBCASE("tilted") {
    const DQuat rotation = glm::angleAxis(0.7, glm::normalize(DVec3(1, 0.3, 0)));
    for (PointState& state : states)
      state.position = Vec3(rotation * DVec3(state.position)), state.normal = Vec3(rotation * DVec3(state.normal));
  }
  SUBCASE("rotated about its normal") {
    const DQuat rotation = glm::angleAxis(1.2, DVec3(0, 0, 1));
    for (PointState& state : states) state.position = Vec3(rotation * DVec3(state.position));
  }
  SUBCASE("scaled, and tilted") {
    const DQuat rotation = glm::angleAxis(0.4, glm::normalize(DVec3(1, 0.3, 0.2)));
    for (PointState& state : states) {
      state.position = Vec3(1.6 * (rotation * DVec3(state.position)) + DVec3(0.1, 0, 0.2));
      state.normal = Vec3(rotation * DVec3(state.normal));
    }
  }
  SUBCASE("scaled down") {
    for (PointState& state : states) state.position *= 0.6f;
  }
  SUBCASE("painted") {
    for (std::size_t i = 0; i < states.size(); i += 2) states[i].color = bitsOfColor(250, 10, 10) | 0xff000000u;
  }
  SUBCASE("removed in part") {
    for (PointState& state : states) state.gone = state.position.x > 0.05f;
  }
  const Image before = followed(cloud, statesOf(cloud)), now = followed(cloud, states), expected = saved(cloud, states);
  CAPTURE(meanDifference(before, now));
  CHECK(meanDifference(now, expected) < 0.05);
}

TEST_CASE_FIXTURE(EditedFixture, "Gaussians follow whole frames of points that a source moves") {
  const PointCloud cloud = sceneOf(sheetOfGaussians(3));
  std::vector<PointState> states = statesOf(cloud);
  CloudFrame frame{.positions = cloud.positions, .normals = cloud.normals};
  for (std::size_t i = 0; i < cloud.size(); ++i)
    frame.positions[i] += Vec3(0.2f, 0.1f, 0.1f), states[i].position = frame.positions[i];
  DrawnCloud drawn(device, cloud);
  drawn.place(frame);
  Frame& picture = frameOf(120, 90, 1);
  draw(picture, drawn, pinhole(), kUnlit);
  CHECK(meanDifference(picture.readColor(), saved(cloud, states)) < 0.05);
}

TEST_CASE_FIXTURE(EditedFixture, "an undone edit gives back the same picture of the Gaussians") {
  const PointCloud cloud = sceneOf(sheetOfGaussians(3));
  const std::vector<PointState> loaded = statesOf(cloud);
  std::vector<PointState> moved = loaded;
  for (PointState& state : moved) state.position.z += 0.3f, state.gone = state.position.x < -0.5f;
  DrawnCloud drawn(device, cloud, {.painted = true, .edited = true});
  Frame& frame = frameOf(120, 90, 1);
  const auto now = [&] {
    draw(frame, drawn, pinhole(), kUnlit);
    return frame.readColor();
  };
  const Image before = now();
  drawn.catchUp(moved);
  CHECK(meanDifference(now(), before) > 2);
  drawn.catchUp(loaded);
  CHECK(now().rgba == before.rgba);
}

TEST_CASE_FIXTURE(EditedFixture, "Gaussians of hidden points are hidden, and those of selected ones tinted") {
  const PointCloud cloud = sceneOf(sheetOfGaussians(0));
  const PointSet all = PointSet::range(0, cloud.size());
  DrawnCloud drawn(device, cloud);
  Frame& frame = frameOf(120, 90, 1);
  const auto now = [&] {
    draw(frame, drawn, pinhole(), kUnlit);
    return frame.readColor();
  };
  const Image before = now();
  const AttributeChange selects = MaskFlip{.role = MaskRole::selected, .points = all};
  const AttributeChange hides = MaskFlip{.role = MaskRole::hidden, .points = all};
  drawn.attributes().follow({&selects, 1});
  const Image selected = now();
  CHECK(meanDifference(selected, before) > 1);
  drawn.attributes().follow({&hides, 1});
  CHECK(now().rgba == picture(sceneOf({}), pinhole(), kUnlit, 120, 90, 1).rgba);
}

TEST_CASE_FIXTURE(EditedFixture, "points that an edit adds are seen among the Gaussians") {
  const PointCloud cloud = sceneOf({});
  std::vector<PointState> added;
  for (std::uint32_t k = 0; k < 9; ++k)
    added.push_back({.position = Vec3(0.1f * static_cast<float>(k % 3), 0.1f * static_cast<float>(k / 3), 0.2f),
                     .number = cloud.size() + k,
                     .normal = Vec3(0, 0, 1),
                     .color = bitsOfColor(255, 0, 0) | 0xff000000u});
  const Image image = followed(cloud, added);
  std::size_t red = 0;
  for (const auto& pixel : image.rgba) red += pixel[0] > 200 && pixel[2] < 60 ? 1 : 0;
  CHECK(red > 60);  // about 0.3 x 0.3 units, of 2.5 in 90 rows
  for (PointState& state : added) state.gone = true;
  CHECK(followed(cloud, added).rgba == followed(cloud, {}).rgba);
}

TEST_SUITE_END();

}  // namespace palpate::gaussians_test
