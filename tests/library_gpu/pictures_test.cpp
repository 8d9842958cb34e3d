// Sessions on a GPU, pictures and meshes through the C interface.
#include <algorithm>
#include <atomic>
#include <thread>

#include "tests/library/ball.hpp"
#include "tests/library_gpu/gpu_options.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::pictures_test {

namespace {

struct Picture {
  std::uint32_t width = 160, height = 120;
  std::vector<std::uint8_t> rgba;

  pp_picture_options options() const {
    pp_picture_options options = pp_default_picture_options();
    options.width = width;
    options.height = height;
    options.has_background = 1;
    options.background[0] = 255;
    options.background[1] = 0;
    options.background[2] = 255;
    return options;
  }
  void take(pp_session session, const pp_picture_options& options) {
    rgba.assign(std::size_t{4} * width * height, 7);
    PP_REQUIRE_OK(pp_session_render(session, &options, rgba.data(), rgba.size()));
  }
  bool isBackground(std::uint32_t x, std::uint32_t y) const {
    const std::uint8_t* p = &rgba[4 * (std::size_t{y} * width + x)];
    return p[0] == 255 && p[1] == 0 && p[2] == 255;
  }
};

}  // namespace

TEST_CASE("on a GPU only a brush that maintains density adds and removes points, in any order of brushes") {
  checkDensityIsOfTheBrush(gpuOptions());
}

TEST_CASE("each GPU has a name, and an invalid number or name is refused") {
  std::uint32_t count = 0;
  PP_REQUIRE_OK(pp_gpu_count(&count));
  REQUIRE(count > 0);
  char name[200] = "", cut[5] = "";
  PP_REQUIRE_OK(pp_gpu_name(0, name, sizeof name));
  CHECK(std::string(name).size() > 3);
  PP_REQUIRE_OK(pp_gpu_name(0, cut, sizeof cut));
  CHECK(std::string(name).starts_with(cut));
  CHECK(std::string(cut).size() == 4);
  CHECK(pp_gpu_name(count, name, sizeof name) == PP_ERROR_ARGUMENT);
  const BallCloud ball(100);
  pp_session_options options = gpuOptions();
  options.gpu = "no such chip";
  pp_session session{};
  CHECK(pp_session_open(ball.cloud, &options, &session) == PP_ERROR_GPU);
  CHECK(lastErrorSays(name));  // lists the available GPUs
}

TEST_CASE("a GPU and the CPU give the same forces") {
  const OpenBall gpu(gpuOptions()), cpu;
  const auto press = pressPath(1, 60, 40);
  const auto there = touch(gpu.session, pathOf(press)), here = touch(cpu.session, pathOf(press));
  REQUIRE(there.size() == here.size());
  for (std::size_t i = 0; i < here.size(); ++i) {
    CHECK(there[i].contact == here[i].contact);
    for (int k = 0; k < 3; ++k) CHECK(std::abs(there[i].force_N[k] - here[i].force_N[k]) < 2e-3);
  }
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(gpu.session, &info));
  CHECK(std::string(info.backend) == "vulkan");
}

TEST_CASE("a picture shows the ball from the requested view, with its dents") {
  pp_session_options options = cpuOptions();
  SUBCASE("with a session on the CPU") {}
  SUBCASE("with a session on a GPU") { options = gpuOptions(); }
  const OpenBall ball(options, 6'000);
  Picture picture;
  pp_picture_options view = picture.options();
  view.ground = "off";  // its shadow darkens the background
  picture.take(ball.session, view);
  CHECK_FALSE(picture.isBackground(80, 60));
  CHECK(picture.isBackground(2, 2));
  CHECK(picture.isBackground(157, 117));
  const auto first = picture.rgba;
  picture.take(ball.session, view);
  CHECK(picture.rgba == first);

  view.has_eye = view.has_target = 1;
  view.eye[0] = 0.3;
  view.eye[1] = -0.2;
  view.eye[2] = 120;
  view.target[0] = 0.3;
  view.target[1] = -0.2;
  picture.take(ball.session, view);
  const auto above = picture.rgba;
  CHECK(above != first);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  const auto press = pressPath(6, 60, 20);
  stroke(ball.session, pathOf(press), brush);
  picture.take(ball.session, view);
  const auto dented = picture.rgba;
  CHECK(dented != above);
  PP_REQUIRE_OK(pp_session_undo(ball.session, 1, nullptr));
  picture.take(ball.session, view);
  std::size_t different = 0;
  for (std::size_t i = 0; i < above.size(); ++i) different += std::abs(picture.rgba[i] - above[i]) > 3;
  CHECK(different < above.size() / 100);  // the discs around the stroke were measured again
}

TEST_CASE("a picture shows a field of the present points in the colours of a map over a range") {
  const OpenBall ball(cpuOptions(), 6'000);
  Picture picture;
  pp_picture_options view = picture.options();
  view.color = "y";  // up
  view.color_map = "red-blue";
  const auto redOf = [&](int y) {
    const std::size_t at = (static_cast<std::size_t>(y) * 160 + 80) * 4;
    return static_cast<int>(picture.rgba[at]) - static_cast<int>(picture.rgba[at + 2]);
  };
  picture.take(ball.session, view);
  CHECK(redOf(92) > 20);   // low
  CHECK(redOf(40) < -20);  // high
  view.color_range = "1000,2000";
  picture.take(ball.session, view);
  CHECK(redOf(40) > 20);
  view.color_map = view.color_range = nullptr;
  view.color = "verticality";
  picture.take(ball.session, view);
  CHECK(redOf(60) > 0);  // yellow
}

TEST_CASE("a picture has the light, the projection and the transparency that are asked for") {
  const OpenBall ball(cpuOptions(), 6'000);
  Picture picture;
  pp_picture_options view = picture.options();
  view.has_background = 0;
  view.transparent = 1;
  const auto opaque = [&] {
    std::size_t count = 0;
    for (std::size_t i = 3; i < picture.rgba.size(); i += 4) count += picture.rgba[i] > 127;
    return count;
  };
  picture.take(ball.session, view);
  CHECK(picture.rgba[3] == 0);
  const auto clay = picture.rgba;
  const std::size_t near = opaque();
  view.projection = "orthographic";
  view.ortho_height = 1000;
  picture.take(ball.session, view);
  CHECK(opaque() < near / 10);
  view = picture.options();
  view.has_background = 0;
  view.transparent = 1;
  view.material = "metal";
  picture.take(ball.session, view);
  CHECK(opaque() == near);
  CHECK(picture.rgba != clay);
  view.material = "gold";
  std::vector<std::uint8_t> rgba(picture.rgba.size());
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("plaster"));
  view = picture.options();
  view.ortho_height = 3;
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("ortho_height"));
}

TEST_CASE("a picture with an invalid size, buffer or camera is refused, and a valid one can be written") {
  const OpenBall ball(cpuOptions(), 2'000);
  Picture picture;
  pp_picture_options view = picture.options();
  std::vector<std::uint8_t> rgba(std::size_t{4} * 160 * 120);
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size() - 1) == PP_ERROR_ARGUMENT);
  CHECK(pp_session_render(ball.session, &view, nullptr, rgba.size()) == PP_ERROR_ARGUMENT);
  view.color = "plaid";
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("color: unknown field 'plaid'"));
  CHECK(lastErrorSays("height"));
  view = picture.options();
  view.color_map = "plaid";
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("red-blue"));
  view = picture.options();
  view.color = "y";
  view.color_range = "3";
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("color_range: '3' is not LOW,HIGH"));
  view = picture.options();
  view.splats = "gaussians";
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("splats: the model contains no Gaussians"));
  view = picture.options();
  view.width = 0;
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  view = picture.options();
  view.height = PP_MAX_PICTURE_SIDE + 1;
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("size: 16385 pixels is not between 1 and 16384"));
  view = picture.options();
  view.samples = 3;
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  view = picture.options();
  view.has_eye = view.has_target = 1;  // both at the origin
  CHECK(pp_session_render(ball.session, &view, rgba.data(), rgba.size()) == PP_ERROR_ARGUMENT);
  picture.take(ball.session, picture.options());
  const ScratchFolder folder;
  const std::string file = (folder / "ball.png").string();
  PP_REQUIRE_OK(pp_image_write(file.c_str(), picture.rgba.data(), picture.width, picture.height));
  CHECK(std::filesystem::file_size(file) > 500);
  CHECK(pp_image_write(file.c_str(), picture.rgba.data(), 0, 5) == PP_ERROR_ARGUMENT);
  CHECK(pp_image_write("/nowhere/ball.png", picture.rgba.data(), picture.width, picture.height) == PP_ERROR_FILE);
}

TEST_CASE("a mesh of the ball is closed, accurate and can be written") {
  const OpenBall ball(cpuOptions(), 5'000);
  pp_mesh_options options = pp_default_mesh_options();
  options.resolution = 32;
  pp_mesh mesh{};
  PP_REQUIRE_OK(pp_session_mesh(ball.session, &options, &mesh));
  pp_triangles triangles{};
  PP_REQUIRE_OK(pp_mesh_view(mesh, &triangles));
  CHECK(triangles.closed == 1);
  REQUIRE(triangles.count > 500);
  double volume = 0;
  const float* const p = triangles.vertices.positions;
  for (std::uint64_t i = 0; i < triangles.vertices.count; ++i)
    CHECK(std::abs(std::hypot(p[3 * i], p[3 * i + 1], p[3 * i + 2]) - kBallRadius) < 0.5);
  for (std::uint64_t t = 0; t < triangles.count; ++t) {
    const float *a = p + 3 * triangles.triangles[3 * t], *b = p + 3 * triangles.triangles[3 * t + 1],
                *c = p + 3 * triangles.triangles[3 * t + 2];
    volume +=
        (a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])) /
        6.0;
  }
  CHECK(volume == near(4.0 / 3 * std::numbers::pi * std::pow(kBallRadius, 3), 0.02));
  const ScratchFolder folder;
  const std::string file = (folder / "ball.ply").string();
  PP_REQUIRE_OK(pp_mesh_write(mesh, file.c_str(), nullptr));
  pp_cloud back{};
  PP_REQUIRE_OK(pp_cloud_read(file.c_str(), nullptr, &back));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(back, &points));
  CHECK(points.count == triangles.vertices.count);
  PP_CHECK_OK(pp_cloud_close(back));
  PP_CHECK_OK(pp_mesh_close(mesh));
  CHECK(pp_mesh_view(mesh, &triangles) == PP_ERROR_HANDLE);
  options.resolution = 0;
  CHECK(pp_session_mesh(ball.session, &options, &mesh) == PP_ERROR_ARGUMENT);
  options = pp_default_mesh_options();
  options.surface = "jelly";
  CHECK(pp_session_mesh(ball.session, &options, &mesh) == PP_ERROR_ARGUMENT);
}

TEST_CASE("pictures can be rendered while another thread touches and sculpts on the same GPU") {
  pp_session_options options = gpuOptions();
  options.budget_us = 1e6;  // a software driver takes long for an edit
  const OpenBall ball(options, 5'000);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 8;
  PP_REQUIRE_OK(pp_session_set_brush(ball.session, &brush));
  Picture picture;
  const pp_picture_options view = picture.options();
  picture.take(ball.session, view);
  const auto first = picture.rgba;
  std::atomic<int> wrong = 0;
  std::atomic<bool> done = false;
  const auto press = pressPath(8, 40, 10);
  std::thread servo([&] {
    pp_contact contact{};
    for (std::size_t i = 0; i < press.size() / 3; ++i) {
      const pp_pose pose{.t_s = 0.2 * static_cast<double>(i),
                         .hip = {press[3 * i], press[3 * i + 1], press[3 * i + 2]}};
      wrong += pp_touch(ball.session, &pose, &contact) != PP_OK;
    }
    done = true;
  });
  while (!done) picture.take(ball.session, view);
  servo.join();
  CHECK(wrong == 0);
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(ball.session, &info));
  CHECK(info.edits > 0);
}

}  // namespace palpate::pictures_test
