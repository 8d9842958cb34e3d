// Pictures of triangles: their position, their lighting, and no gaps between them.
#include <algorithm>
#include <numbers>

#include "engine/gpu/transfer.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/render/picture_fixture.hpp"

namespace palpate::mesh_picture_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

// A sphere of triangles between meridians and circles of latitude; its vertices have radius 1.
struct SphereMesh {
  std::vector<shared::MeshVertex> vertices;
  std::vector<std::array<std::uint32_t, 3>> triangles;
};

SphereMesh sphereMesh(std::uint32_t rings) {
  SphereMesh mesh;
  const std::uint32_t around = 2 * rings;
  for (std::uint32_t i = 0; i <= rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const double latitude = std::numbers::pi * i / rings, longitude = 2 * std::numbers::pi * j / around;
      const Vec3 place(DVec3(std::sin(latitude) * std::cos(longitude), std::cos(latitude),
                             std::sin(latitude) * std::sin(longitude)));
      mesh.vertices.push_back({place, place, place.x > 0 ? 0xff0000ffu : 0xffff0000u});
    }
  for (std::uint32_t i = 0; i < rings; ++i)
    for (std::uint32_t j = 0; j < around; ++j) {
      const std::uint32_t a = i * around + j, b = i * around + (j + 1) % around;
      mesh.triangles.push_back({a, b, a + around});
      mesh.triangles.push_back({b, b + around, a + around});
    }
  return mesh;
}

class MeshPictureFixture : public PictureFixture {
 protected:
  // Colour and depth of the mesh, seen by a camera in front of it.
  struct Picture {
    Image color;
    DepthImage depth;
  };
  Picture draw(const SphereMesh& mesh, const Camera& camera, const FrameOptions& options, double cell = 0.1) {
    const Buffer vertices = Buffer::of<shared::MeshVertex>(device, mesh.vertices.size(), Memory::device, "vertices");
    const Buffer triangles = Buffer::of<std::uint32_t>(device, 3 * mesh.triangles.size(), Memory::device, "triangles");
    upload(device, vertices, mesh.vertices);
    upload(device, triangles, mesh.triangles);
    Frame& frame = frameOf(200, 200, 2);
    CommandList list(device, device.throughputQueue(), "test mesh");
    list.begin();
    frame.record(list,
                 DrawnMesh{.vertices = vertices.address(),
                           .triangles = triangles.address(),
                           .triangleCount = static_cast<std::uint32_t>(mesh.triangles.size()),
                           .hasColors = true,
                           .bounds = {DVec3(-1), DVec3(1)},
                           .cell = cell},
                 camera, options);
    list.end();
    device.throughputQueue().run(list);
    return {frame.readColor(), frame.readDepth()};
  }
  const Camera camera_ = Camera::fitting({DVec3(-1), DVec3(1)}, 1);
};

}  // namespace

TEST_CASE_FIXTURE(MeshPictureFixture, "every sample of a closed mesh is covered at the depth of the surface") {
  for (const double cell : {0.1, 1e-4}) {  // with a share for each tile, and with all tiles in one
    const Picture picture = draw(sphereMesh(40), camera_, {}, cell);
    const Camera::Axes axes = camera_.axes();
    std::size_t inside = 0;
    for (std::uint32_t y = 0; y < 200; ++y)
      for (std::uint32_t x = 0; x < 200; ++x) {
        // Intersection of the pixel's ray with the unit sphere.
        const double focal = camera_.focal_px(200);
        const DVec3 ray = axes.forward + (x + 0.5 - 100) / focal * axes.right - (y + 0.5 - 100) / focal * axes.up;
        const double b = glm::dot(camera_.eye, ray) / glm::dot(ray, ray);
        const double c = (glm::dot(camera_.eye, camera_.eye) - 1) / glm::dot(ray, ray);
        const double root = b * b - c;
        const float depth = picture.depth.at(x, y);
        if (root > 0.02) {
          ++inside;
          REQUIRE(std::abs(static_cast<double>(depth) - (-b - std::sqrt(root))) < 0.03);
        }
        if (root < -0.01) REQUIRE(depth == 0);
      }
    CHECK(inside > 10'000);
  }
}

TEST_CASE_FIXTURE(MeshPictureFixture,
                  "mesh normals are interpolated from the vertices and flipped towards the eye from inside") {
  Camera before = camera_;
  before.eye = DVec3(0, 0, 3);
  before.target = DVec3(0);
  before.setDepthRange({DVec3(-1), DVec3(1)}, 2);
  const Picture outside = draw(sphereMesh(40), before, {.pass = ImagePass::normal});
  // In the centre of the picture the sphere faces the eye.
  CHECK(outside.color.at(100, 100)[0] == within(128, 3));
  CHECK(outside.color.at(100, 100)[1] == within(128, 3));
  CHECK(outside.color.at(100, 100)[2] > 250);
  Camera within = camera_;
  within.eye = DVec3(0);
  within.target = DVec3(0, 0, -1);
  within.setDepthRange({DVec3(-1), DVec3(1)}, 2);
  const Picture inside = draw(sphereMesh(20), within, {.pass = ImagePass::normal}, 0.2);
  CHECK(inside.color.at(100, 100)[2] > 250);
  CHECK(std::ranges::none_of(inside.depth.depth, [](float depth) { return depth == 0; }));
  // With hidden backs it is seen from outside as before, and not from inside.
  CHECK(draw(sphereMesh(40), before, {.pass = ImagePass::normal, .hidesBacks = true}).depth.depth ==
        outside.depth.depth);
  CHECK(std::ranges::all_of(draw(sphereMesh(20), within, {.hidesBacks = true}, 0.2).depth.depth,
                            [](float depth) { return depth == 0; }));
}

TEST_CASE_FIXTURE(MeshPictureFixture,
                  "mesh colours come from the vertices, and the same mesh gives the same picture bit by bit") {
  const Picture once = draw(sphereMesh(40), camera_, {.pass = ImagePass::color});
  CHECK(once.color.at(150, 100)[0] > 250);
  CHECK(once.color.at(150, 100)[2] < 5);
  CHECK(once.color.at(50, 100)[2] > 250);
  const Picture again = draw(sphereMesh(40), camera_, {.pass = ImagePass::color});
  CHECK(once.color.rgba == again.color.rgba);
  CHECK(once.depth.depth == again.depth.depth);
}

TEST_CASE_FIXTURE(MeshPictureFixture, "no triangles, and triangles that are not finite, leave the background") {
  SphereMesh none;
  CHECK(std::ranges::all_of(draw(none, camera_, {}).depth.depth, [](float depth) { return depth == 0; }));
  const float nan = std::nanf("");
  none.vertices.assign(3, {Vec3(nan), Vec3(0, 0, 1), 0});
  none.triangles.push_back({0, 1, 2});
  CHECK(std::ranges::all_of(draw(none, camera_, {}).depth.depth, [](float depth) { return depth == 0; }));
}

TEST_SUITE_END();

}  // namespace palpate::mesh_picture_test
