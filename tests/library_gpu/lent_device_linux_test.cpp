// A Vulkan device created by a program and lent through the C interface: used for contact, sculpting, pictures and
// meshes, and left usable.
#include <atomic>
#include <thread>

#include "tests/gpu/host_program.hpp"
#include "tests/library/ball.hpp"
#include "tests/library/simulating.hpp"
#include "tests/near.hpp"

namespace palpate::lent_device_test {

namespace {

/// The lent device in the form of the C interface.
struct Lent {
  HostDevice host;
  pp_vulkan_device device = pp_default_vulkan_device();

  explicit Lent(HostProgram& program) : host(program.lend()) {
    device.api_version = host.apiVersion;
    device.get_instance_proc_addr = reinterpret_cast<void*>(host.getInstanceProcAddr);
    device.instance = host.instance;
    device.physical_device = host.physical;
    device.device = host.device;
    device.features = host.features;
    device.throughput = {host.throughput.handle, host.throughput.family, 0};
    device.validated = host.validation != Validation::off;
    device.debug_utils = host.debugUtils;
    device.lock = [](void* user, void* queue) { static_cast<Lent*>(user)->host.lock(static_cast<VkQueue>(queue)); };
    device.unlock = [](void* user, void* queue) { static_cast<Lent*>(user)->host.unlock(static_cast<VkQueue>(queue)); };
    device.lock_user = this;
  }
  Lent(const Lent&) = delete;
  Lent& operator=(const Lent&) = delete;
  pp_session_options options() const {
    pp_session_options options = cpuOptions();
    options.gpu = nullptr;
    options.vulkan = &device;
    return options;
  }
};

}  // namespace

TEST_CASE("a session on a lent device gives the forces of any session, beside the program's own work") {
  HostProgram program;
  const Lent lent(program);
  const BallCloud cloud(5'000);
  const auto press = pressPath(1.5);
  pp_session session{};
  const pp_session_options options = lent.options();
  PP_REQUIRE_OK(pp_session_open(cloud.cloud, &options, &session));
  pp_session_info info = pp_default_session_info();
  PP_REQUIRE_OK(pp_session_get_info(session, &info));
  CHECK(std::string(info.backend) == "vulkan");
  std::atomic<bool> well = true;
  std::thread its([&] { well = program.worksItself(50); });
  const auto ticks = touch(session, pathOf(press));
  its.join();
  CHECK(well);
  CHECK(program.holds() > 100);  // at least one submission per tick
  const OpenBall alone(cpuOptions(), 5'000);
  const auto truth = touch(alone.session, pathOf(press));
  REQUIRE(truth.size() == ticks.size());
  for (std::size_t i = 0; i < ticks.size(); ++i) CHECK(ticks[i].force_N[2] == within(truth[i].force_N[2], 1e-3));
  CHECK(ticks.back().force_N[2] > 0.8);
  PP_REQUIRE_OK(pp_session_close(session));
  CHECK(program.worksItself(1));
}

TEST_CASE("a lent device without a requirement is refused by its name and stays usable") {
  const BallCloud cloud(200);
  pp_session session{};
  {
    HostProgram program("scalarBlockLayout");
    const Lent lent(program);
    const pp_session_options options = lent.options();
    CHECK(pp_session_open(cloud.cloud, &options, &session) == PP_ERROR_GPU);
    CHECK(lastErrorSays("scalarBlockLayout"));
    CHECK(program.holds() == 0);
    CHECK(program.worksItself(1));
  }
  HostProgram program;
  const auto refused = [&](auto&& change, pp_status status, const char* words) {
    Lent lent(program);
    change(lent.device);
    const pp_session_options options = lent.options();
    CHECK(pp_session_open(cloud.cloud, &options, &session) == status);
    CHECK_MESSAGE(lastErrorSays(words), std::string(pp_last_error()));
  };
  refused([](pp_vulkan_device& device) { device.instance = nullptr; }, PP_ERROR_GPU, "instance");
  refused([](pp_vulkan_device& device) { device.device = nullptr; }, PP_ERROR_GPU, "device");
  refused([](pp_vulkan_device& device) { device.features = nullptr; }, PP_ERROR_GPU, "features");
  refused([](pp_vulkan_device& device) { device.get_instance_proc_addr = nullptr; }, PP_ERROR_GPU,
          "vkGetInstanceProcAddr");
  refused([](pp_vulkan_device& device) { device.throughput = {}; }, PP_ERROR_GPU, "queue");
  refused(
      [](pp_vulkan_device& device) {
        device.latency = {device.throughput.handle, 99, 0};
      },
      PP_ERROR_GPU, "family 99");
  refused([](pp_vulkan_device& device) { device.unlock = nullptr; }, PP_ERROR_GPU, "unlock");
  refused([](pp_vulkan_device& device) { device.size = 5; }, PP_ERROR_ARGUMENT, "size");
  const pp_vulkan_device nothing = pp_default_vulkan_device();
  pp_session_options options = cpuOptions();
  options.gpu = nullptr;
  options.vulkan = &nothing;
  CHECK(pp_session_open(cloud.cloud, &options, &session) == PP_ERROR_GPU);
  const Lent lent(program);
  options = lent.options();
  options.gpu = "0";
  CHECK(pp_session_open(cloud.cloud, &options, &session) == PP_ERROR_ARGUMENT);
  CHECK(lastErrorSays("lent"));
  CHECK(session.id == 0);
  CHECK(program.worksItself(1));
}

TEST_CASE("strokes, matter and meshes run on a lent device, and several sessions share it") {
  HostProgram program;
  const Lent lent(program);
  const BallCloud cloud(5'000);
  const pp_session_options options = lent.options();
  pp_session one{}, two{};
  PP_REQUIRE_OK(pp_session_open(cloud.cloud, &options, &one));
  PP_REQUIRE_OK(pp_session_open(cloud.cloud, &options, &two));
  const auto before = placesOf(one);
  pp_brush brush = pp_default_brush();
  brush.radius_mm = 10;
  const auto press = pressPath(4, 60, 20);
  stroke(one, pathOf(press), brush);
  CHECK(placesOf(one) != before);
  CHECK(placesOf(two) == before);
  PP_REQUIRE_OK(pp_session_undo(one, 10, nullptr));
  CHECK(placesOf(one) == before);
  pp_mesh_options meshing = pp_default_mesh_options();
  meshing.resolution = 16;
  pp_mesh mesh{};
  PP_REQUIRE_OK(pp_session_mesh(two, &meshing, &mesh));
  PP_REQUIRE_OK(pp_mesh_close(mesh));
  pp_picture_options picture = pp_default_picture_options();
  picture.width = 64;
  picture.height = 48;
  picture.has_background = 1;
  std::vector<std::uint8_t> rgba(std::size_t{4} * 64 * 48, 7);
  PP_REQUIRE_OK(pp_session_render(two, &picture, rgba.data(), rgba.size()));
  CHECK(rgba[0] + rgba[1] + rgba[2] == 0);                              // black background
  CHECK(rgba[4 * (24 * 64 + 32)] + rgba[4 * (24 * 64 + 32) + 1] > 20);  // the ball in the middle
  if (canSimulate()) {
    pp_matter_options alone = pp_default_matter_options();
    alone.vulkan = &lent.device;
    pp_matter water{};
    PP_REQUIRE_OK(pp_matter_open("drop", &alone, &water));
    PP_REQUIRE_OK(pp_matter_step(water, 3));
    PP_REQUIRE_OK(pp_matter_close(water));
  }
  PP_REQUIRE_OK(pp_session_close(one));
  PP_REQUIRE_OK(pp_session_close(two));
  CHECK(program.worksItself(1));
}

}  // namespace palpate::lent_device_test
