// Clouds from arrays and files, and back, through the C interface.
#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <limits>
#include <thread>

#include "tests/content_of.hpp"
#include "tests/library/ball.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::clouds_test {

TEST_CASE("a cloud has the points of its arrays, and gives access to them without a copy") {
  const BallArrays<float> ball(1'000);
  pp_cloud_arrays arrays = ball.arrays();
  std::vector<std::uint8_t> colors(3 * ball.count());
  for (std::size_t i = 0; i < colors.size(); ++i) colors[i] = static_cast<std::uint8_t>(i * 7);
  arrays.colors = {colors.data(), PP_UINT8, 0, 0};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  pp_points points{}, again{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  PP_REQUIRE_OK(pp_cloud_view(cloud, &again));
  REQUIRE(points.count == 1'000);
  CHECK(points.positions == again.positions);
  CHECK(std::equal(ball.positions.begin(), ball.positions.end(), points.positions));
  for (std::size_t i = 0; i < 3 * points.count; ++i) CHECK(std::abs(points.normals[i] - ball.normals[i]) < 1e-6f);
  for (std::size_t i = 0; i < points.count; ++i) {
    for (std::size_t k = 0; k < 3; ++k) CHECK(points.colors[4 * i + k] == colors[3 * i + k]);
    CHECK(points.colors[4 * i + 3] == 255);
  }
  CHECK(points.max[2] == near(kBallRadius, 5e-3));
  CHECK(points.min[0] == near(-kBallRadius, 5e-3));
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("doubles far from the origin keep their last bit") {
  const BallArrays<double> ball(500, {4.5e6, -3e5, 1234.5});
  const pp_cloud_arrays arrays = ball.arrays();
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  std::vector<double> places(3 * ball.count());
  PP_REQUIRE_OK(pp_cloud_copy_positions(cloud, places.data(), ball.count()));
  CHECK(places == ball.positions);
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  CHECK(points.origin[0] != 0);
  CHECK(points.min[0] > 4.4e6);
  for (std::size_t i = 0; i < 3 * points.count; ++i) CHECK(std::abs(points.positions[i]) < 1e3f);
  CHECK(pp_cloud_copy_positions(cloud, places.data(), ball.count() - 1) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("rows of an array may have any stride, also a negative one") {
  const std::vector<double> table{1, 2, 3, -1, 4, 5, 6, -1, 7, 8, 9, -1};  // with a fourth column, which is skipped
  pp_cloud_arrays arrays = pp_default_cloud_arrays();
  arrays.count = 3;
  arrays.positions = {table.data() + 8, PP_FLOAT64, 0, -4 * static_cast<std::int64_t>(sizeof(double))};
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  const std::vector<float> wanted{7, 8, 9, 4, 5, 6, 1, 2, 3};
  CHECK(std::equal(wanted.begin(), wanted.end(), points.positions));
  CHECK(points.normals == nullptr);
  CHECK(points.colors == nullptr);
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("arrays with invalid positions or types are refused with the row") {
  BallArrays<float> ball(100);
  ball.positions[3 * 42 + 1] = std::numeric_limits<float>::quiet_NaN();
  pp_cloud_arrays arrays = ball.arrays();
  pp_cloud cloud{};
  PP_CHECK_FAILS(pp_cloud_create(&arrays, &cloud), PP_ERROR_ARGUMENT, "row 42");
  CHECK(cloud.id == 0);
  arrays.positions.data = nullptr;
  PP_CHECK_FAILS(pp_cloud_create(&arrays, &cloud), PP_ERROR_ARGUMENT, "positions");
  arrays.positions = {ball.positions.data(), PP_UINT8, 0, 0};
  CHECK(pp_cloud_create(&arrays, &cloud) == PP_ERROR_ARGUMENT);
  arrays.positions.type = 77;
  CHECK(pp_cloud_create(&arrays, &cloud) == PP_ERROR_ARGUMENT);
  CHECK(pp_cloud_create(nullptr, &cloud) == PP_ERROR_ARGUMENT);
  arrays = ball.arrays();
  ball.positions[3 * 42 + 1] = 0;
  CHECK(pp_cloud_create(&arrays, nullptr) == PP_ERROR_ARGUMENT);
}

TEST_CASE("a struct of an older program has defaults for the rest, and one of unknown size is refused") {
  const BallArrays<float> ball(10);
  pp_cloud_arrays arrays = ball.arrays();
  arrays.normals = {reinterpret_cast<const void*>(16), 77, 0, 0};  // beyond the size that the program passes
  arrays.size = offsetof(pp_cloud_arrays, normals);
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  CHECK(points.normals == nullptr);
  PP_CHECK_OK(pp_cloud_close(cloud));
  for (const std::uint32_t size : {0u, 4u, static_cast<std::uint32_t>(sizeof arrays) + 8, 3'000'000'000u}) {
    arrays.size = size;
    PP_CHECK_FAILS(pp_cloud_create(&arrays, &cloud), PP_ERROR_ARGUMENT, "pp_default");
  }
}

TEST_CASE("defaults are written up to the size of a struct that the program knows, and no further") {
  alignas(pp_session_options) std::array<unsigned char, sizeof(pp_session_options) + 32> room{};
  room.fill(0x5a);
  auto* const options = reinterpret_cast<pp_session_options*>(room.data());
  constexpr std::uint32_t kOlder = offsetof(pp_session_options, rate_Hz);
  pp_init_session_options(options, kOlder);
  CHECK(options->size == kOlder);
  CHECK(std::all_of(room.begin() + kOlder, room.end(), [](unsigned char byte) { return byte == 0x5a; }));
  pp_init_session_options(options, sizeof(pp_session_options) + 16);  // a newer program
  CHECK(options->rate_Hz == 1000);
  CHECK(std::all_of(room.begin() + sizeof(pp_session_options), room.end() - 16,
                    [](unsigned char byte) { return byte == 0; }));
  CHECK(room.back() == 0x5a);
  pp_init_session_options(nullptr, 8);
  CHECK(pp_default_session_options().size == sizeof(pp_session_options));
}

TEST_CASE("a cloud written and read again is unchanged, in each format that keeps all of it") {
  const ScratchFolder folder;
  const BallArrays<float> ball(300);
  const pp_cloud_arrays arrays = ball.arrays();
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  for (const char* name : {"ball.ply", "ball.pcd", "ball.npy"}) {
    CAPTURE(name);
    const std::string file = (folder / name).string();
    PP_REQUIRE_OK(pp_cloud_write(cloud, file.c_str(), nullptr));
    pp_cloud back{};
    PP_REQUIRE_OK(pp_cloud_read(file.c_str(), nullptr, &back));
    pp_points points{};
    PP_REQUIRE_OK(pp_cloud_view(back, &points));
    REQUIRE(points.count == ball.count());
    CHECK(std::equal(ball.positions.begin(), ball.positions.end(), points.positions));
    CHECK(points.normals != nullptr);
    PP_CHECK_OK(pp_cloud_close(back));
  }
  PP_CHECK_FAILS(pp_cloud_write(cloud, (folder / "ball.xlsx").string().c_str(), nullptr), PP_ERROR_ARGUMENT, ".ply");
  CHECK(std::string(pp_formats_written()).find(".las") != std::string::npos);
  CHECK(std::string(pp_formats_read()).find(".npz") != std::string::npos);
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("an existing file is replaced, or kept as a backup on request") {
  const ScratchFolder folder;
  const BallCloud ball(100);
  const std::string file = (folder / "ball.ply").string();
  std::ofstream(file) << "mine";
  pp_write_options options = pp_default_write_options();
  options.backup = 1;
  PP_REQUIRE_OK(pp_cloud_write(ball.cloud, file.c_str(), &options));
  CHECK(std::filesystem::exists(folder / "ball.ply.bak"));
  options.backup = 0;
  PP_REQUIRE_OK(pp_cloud_write(ball.cloud, file.c_str(), &options));
  CHECK_FALSE(std::filesystem::exists(folder / "ball.ply.bak2"));
}

TEST_CASE("an invalid file is refused with its name and line") {
  const ScratchFolder folder;
  const std::string file = (folder / "bad.ply").string();
  std::ofstream(file)
      << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
         "end_header\n0 0 0\n1 two 3\n";
  pp_cloud cloud{};
  CHECK(pp_cloud_read(file.c_str(), nullptr, &cloud) == PP_ERROR_FILE);
  CHECK(pp_last_status() == PP_ERROR_FILE);
  CHECK(std::string(pp_last_error_file()) == file);
  CHECK(pp_last_error_line() == 9);
  CHECK(lastErrorSays("bad.ply:9"));
  CHECK(pp_cloud_read((folder / "none.ply").string().c_str(), nullptr, &cloud) == PP_ERROR_FILE);
  CHECK(pp_cloud_read(nullptr, nullptr, &cloud) == PP_ERROR_ARGUMENT);
  CHECK(std::string(pp_last_error_file()).empty());
}

TEST_CASE("additional attributes of a file are listed and can be read") {
  const ScratchFolder folder;
  const std::string file = (folder / "scan.ply").string();
  std::ofstream(file)
      << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
         "property ushort intensity\nend_header\n0 0 0 17\n1 2 3 60000\n";
  pp_cloud cloud{};
  PP_REQUIRE_OK(pp_cloud_read(file.c_str(), nullptr, &cloud));
  std::uint64_t count = 0;
  PP_REQUIRE_OK(pp_cloud_attribute_count(cloud, &count));
  REQUIRE(count == 1);
  pp_attribute attribute{};
  PP_REQUIRE_OK(pp_cloud_get_attribute(cloud, 0, &attribute));
  CHECK(std::string(attribute.name) == "intensity");
  CHECK(std::string(attribute.type) == "uint16");
  CHECK(static_cast<const std::uint16_t*>(attribute.data)[1] == 60000);
  CHECK(pp_cloud_get_attribute(cloud, 1, &attribute) == PP_ERROR_ARGUMENT);
  PP_CHECK_OK(pp_cloud_close(cloud));
}

TEST_CASE("a splat scene stays one: its Gaussians are prepared, and a mask is of the points of their surface") {
  const ScratchFolder folder;
  const std::string file = (folder / "scene.ply").string(), copy = (folder / "copy.ply").string();
  std::string head = "ply\nformat ascii 1.0\n", rows;
  for (const char* name : {"x", "y", "z", "f_dc_0", "f_dc_1", "f_dc_2", "opacity", "scale_0", "scale_1", "scale_2",
                           "rot_0", "rot_1", "rot_2", "rot_3", "f_rest_0"})
    rows += std::string("property float ") + name + "\n";
  rows += "end_header\n";
  std::size_t right = 0;
  for (int i = 0; i < 400; ++i) {
    const int x = i % 20;
    right += x > 9 ? 1 : 0;
    rows += std::to_string(x) + " " + std::to_string(i / 20) + " 0 1 0 -1 2 -0.25 -0.25 -1 1 0 0 0 0." +
            std::to_string(1000 + i) + "1\n";
  }
  std::ofstream(file) << head + "element vertex 400\n" + rows;
  const auto written = [&](pp_cloud cloud) {
    pp_write_options options = pp_default_write_options();
    options.ascii = 1;
    PP_REQUIRE_OK(pp_cloud_write(cloud, copy.c_str(), &options));
    return contentOf(copy);
  };
  pp_cloud cloud{}, part{}, chosen{};
  PP_REQUIRE_OK(pp_cloud_read(file.c_str(), nullptr, &cloud));
  CHECK(written(cloud).ends_with(rows));
  pp_points points{};
  PP_REQUIRE_OK(pp_cloud_view(cloud, &points));
  CHECK(points.count != 400);
  std::vector<std::uint8_t> kept(points.count);
  pp_prepare_options prepare = pp_default_prepare_options();
  prepare.steps = R"({"where": "x > 9.5"})";
  PP_REQUIRE_OK(pp_cloud_prepare(cloud, &prepare, kept.data(), kept.size(), &part));
  for (std::size_t i = 0; i < kept.size(); ++i)
    CHECK((kept[i] != 0) == (static_cast<double>(points.positions[3 * i]) + points.origin[0] > 9.5));
  const auto count = [](const std::string& text) {
    return std::ranges::count(text.substr(text.find("end_header")), '\n') - 1;
  };
  CHECK(static_cast<std::size_t>(count(written(part))) == right);
  PP_REQUIRE_OK(pp_cloud_choose(cloud, kept.data(), kept.size(), &chosen));
  CHECK(std::abs(count(written(chosen)) - static_cast<long>(right)) <=
        20);  // a column, whose nearest points are on both sides
  for (const pp_cloud each : {cloud, part, chosen}) PP_CHECK_OK(pp_cloud_close(each));
}

TEST_CASE("each thread has the message of its own last failure") {
  pp_cloud cloud{};
  CHECK(pp_cloud_read("/nowhere/none.ply", nullptr, &cloud) == PP_ERROR_FILE);
  const std::string mine = pp_last_error();
  pp_status theirs = PP_ERROR_BUG;
  std::thread([&] { theirs = pp_last_status(); }).join();
  CHECK(theirs == PP_OK);
  std::thread([&] { pp_cloud_close({}); }).join();
  CHECK(mine == pp_last_error());
  CHECK(pp_last_status() == PP_ERROR_FILE);
}

TEST_CASE("the text of a failure stays readable during calls that succeed and failures of other threads") {
  pp_cloud cloud{};
  REQUIRE(pp_cloud_read("/nowhere/none.ply", nullptr, &cloud) == PP_ERROR_FILE);
  const char* const text = pp_last_error();
  const char* const file = pp_last_error_file();
  const std::string before = text;
  const BallArrays<float> ball(100);
  const pp_cloud_arrays arrays = ball.arrays();
  PP_REQUIRE_OK(pp_cloud_create(&arrays, &cloud));
  std::thread([] {
    for (int k = 0; k < 100; ++k) pp_cloud_read(std::string(500, 'x').c_str(), nullptr, nullptr);
  }).join();
  PP_CHECK_OK(pp_cloud_close(cloud));
  CHECK(text == pp_last_error());  // the same address
  CHECK(text == before);
  CHECK(std::string(file) == "/nowhere/none.ply");
  CHECK(pp_cloud_close(cloud) == PP_ERROR_HANDLE);
  CHECK(std::string(pp_last_error()) != before);
}

TEST_CASE("the text of a failure can stand in one expression with other calls that fail") {
  pp_cloud cloud{};
  REQUIRE(pp_cloud_read(("/nowhere/" + std::string(200, 'x') + ".ply").c_str(), nullptr, &cloud) == PP_ERROR_FILE);
  const char* const text = pp_last_error();
  const char* const file = pp_last_error_file();
  for (const std::size_t length : {10u, 4000u, 100'000u}) {
    CHECK(pp_cloud_read(("/nowhere/" + std::string(length, 'y')).c_str(), nullptr, &cloud) == PP_ERROR_FILE);
    CHECK(text == pp_last_error());
    CHECK(file == pp_last_error_file());
    CHECK(std::string(text).starts_with("/nowhere/yyy"));
    CHECK(std::string(text).size() < 8192);
  }
}

TEST_CASE("the version of the header is that of the library, and each status has a name") {
  const std::string version = std::to_string(PALPATE_VERSION_MAJOR) + "." + std::to_string(PALPATE_VERSION_MINOR) +
                              "." + std::to_string(PALPATE_VERSION_PATCH);
  CHECK(pp_version() == version);
  for (int status = PP_OK; status <= PP_ERROR_BUG; ++status) CHECK(std::string(pp_status_name(status)) != "unknown");
  CHECK(std::string(pp_status_name(99)) == "unknown");
}

}  // namespace palpate::clouds_test
