// Commands, files, exit codes, messages.
#include <algorithm>
#include <cstring>

#include "engine/core/brush.hpp"
#include "engine/io/ply_reader.hpp"
#include "tests/apps/running_program.hpp"
#include "tests/labels.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::palpate_test {

TEST_CASE("a press on a sphere has no force outside, and inside the true normal and the depth that theory gives") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), trace = (folder / "trace.csv").string();
  works("make sphere -n 200000 -o " + model);
  works("touch " + model + " --backend vulkan --surface average --path builtin:press --trace " + trace +
        " --validate=core --json " + (folder / "touch.json").string());
  const auto rows = readTrace(trace);
  const double spacing = std::sqrt(4 * 3.14159265358979 * 50 * 50 / 200000), radius = 4 * spacing;
  const double bias = 0.0694 * radius * radius / 50;
  std::size_t touched = 0;
  for (const Row& row : rows) {
    const double height = glm::length(row.hip) - 50;
    if (height > 0) {
      CHECK(row.force == DVec3(0));
      CHECK_FALSE(row.contact);
    }
    if (!row.contact) continue;
    ++touched;
    CHECK(angleBetween_deg(row.force, row.hip) < 2);
    CHECK(angleBetween_deg(row.normal, row.hip) < 0.5);
    CHECK(50 - glm::length(row.proxy) == near(bias, 0.15));
  }
  CHECK(touched > 200);
  const auto json = jsonOf(folder / "touch.json");
  CHECK(json["points"] == 200000);
  CHECK(json["ticks"] == rows.size());
  CHECK(json["contact_ticks"] == touched);
  CHECK(json["peak_force_N"] > 1.0);
  CHECK(json["contact_error_mm"] < 0.001);
}

TEST_CASE("noise is measured and widens the support radius equally on every back end, unless a radius is given") {
  const ScratchFolder folder;
  const std::string clean = (folder / "clean.ply").string(), noisy = (folder / "noisy.ply").string();
  const std::string json = (folder / "out.json").string();
  works("make sphere -n 20000 -o " + clean);
  works("make sphere -n 20000 --noise 0.3 -o " + noisy);
  works("info " + clean + " --json " + json);
  CHECK(jsonOf(json)["noise_spacings"] < 0.001);
  works("info " + noisy + " --json " + json);
  const double noise = jsonOf(json)["noise_spacings"];
  CHECK(std::abs(noise - 0.236) < 0.02);
  for (const char* backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    const auto touched = [&](const std::string& arguments) {
      works("touch " + arguments + " --path builtin:press --rate 125 --backend " + backend + " --json " + json);
      return jsonOf(json);
    };
    const auto usual = touched(clean), wide = touched(noisy), given = touched(noisy + " --radius 5");
    const double usualSpacings = usual["radius_mm"].get<double>() / usual["spacing_mm"].get<double>();
    const double wideSpacings = wide["radius_mm"].get<double>() / wide["spacing_mm"].get<double>();
    CHECK(std::abs(usualSpacings - 4) < 1e-6);
    CHECK(std::abs(wideSpacings - 30 * noise) < 1e-3);
    CHECK(std::abs(given["radius_mm"].get<double>() - 5) < 1e-9);
    CHECK(wide["contact_ticks"] > 12);
    CHECK(wide["contact_error_mm"] < 0.002);
    CHECK(touched(noisy + " --edit push --penetration 4")["moved_points"] > 10);
  }
}

TEST_CASE("virtual time gives the same trace, cloud and picture, byte by byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string();
  works("make torus -n 5000 -o " + model);
  for (const char* run : {"a", "b"}) {
    const auto file = [&](const char* ending) { return (folder / (std::string(run) + ending)).string(); };
    works("touch " + model +
          " --backend vulkan --path builtin:slide --rate 125 --edit push --yield-depth 0.3 --trace " + file(".csv") +
          " --save " + file(".ply") + " --picture " + file(".png") + " --size 160x100");
  }
  for (const char* ending : {".csv", ".ply", ".png"}) {
    CAPTURE(ending);
    const std::string a = contentOf(folder / ("a" + std::string(ending)));
    CHECK(!a.empty());
    CHECK(a == contentOf(folder / ("b" + std::string(ending))));
  }
}

TEST_CASE("a push leaves a dent in the saved file, and all other properties are kept") {
  const ScratchFolder folder;
  const std::string plain = (folder / "plain.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 10000 --ascii -o " + plain);
  // The same cloud with an unknown property.
  std::istringstream in(contentOf(plain));
  std::ofstream out(folder / "model.ply");
  bool body = false;
  int id = 0;
  for (std::string line; std::getline(in, line);) {
    if (line == "end_header") {
      out << "property int confidence\n" << line << "\n";
      body = true;
    } else {
      out << line;
      if (body) out << " " << id++;
      out << "\n";
    }
  }
  out.close();
  works("touch " + (folder / "model.ply").string() +
        " --backend vulkan --edit push --penetration 4 --rate 500 --save " + saved + " --json " +
        (folder / "touch.json").string());
  const PointCloud before = readPly(folder / "model.ply"), after = readPly(saved);
  REQUIRE(after.size() > before.size());
  REQUIRE(after.extra.size() == 1);
  CHECK(after.extra[0].name == "confidence");
  const auto confidence = [](const PointCloud& cloud, std::size_t i) {
    std::int32_t value;
    std::memcpy(&value, cloud.extra[0].data.data() + i * sizeof value, sizeof value);
    return value;
  };
  // Removed points are missing; added points follow the file's points, with the property of a neighbour.
  std::size_t edited = 0;
  bool isNew = false;  // true from the first point that follows a point of a higher index in the file
  double deepest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const auto of = static_cast<std::size_t>(confidence(after, i));
    REQUIRE(of < before.size());
    isNew = isNew || (i > 0 && confidence(after, i) <= confidence(after, i - 1));
    const double way = glm::distance(after.positions[i], before.positions[of]);
    if (isNew) CHECK(way < 8);
    edited += isNew || way > 0;
    deepest = std::max(deepest, 50.0 - glm::length(DVec3(after.positions[i])));
  }
  CHECK(deepest > 3);
  CHECK(edited > 30);
  CHECK(jsonOf(folder / "touch.json")["moved_points"] >= edited);
}

TEST_CASE("every brush sculpts on the CPU, and the report states the number of edited points") {
  const ScratchFolder folder;
  const std::string model = (folder / "plain.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 20000 -o " + model);
  const PointCloud before = readPly(model);
  for (const auto& [edit, kind] : kBrushKinds) {
    CAPTURE(edit);
    works("touch " + model + " --backend cpu --penetration 4 --strength 1 --falloff 2 --paint-color 0,0,255 --edit " +
          std::string(edit) + " --save " + saved + " --json " + (folder / "touch.json").string());
    const PointCloud after = readPly(saved);
    CHECK(jsonOf(folder / "touch.json")["moved_points"] > 10);
    CHECK(after.hasColors() == (edit == "paint"));
    CHECK((after.positions == before.positions) == (edit == "paint"));
    if (edit == "push" || edit == "carve") CHECK(after.size() > before.size());
  }
}

TEST_CASE("sculpting in real time with a picture and a saved cloud ends cleanly" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 5000 -o " + model);
  works("touch " + model + " --backend vulkan --path builtin:press --penetration 4 --edit push --realtime --picture " +
        (folder / "touched.png").string() + " --size 320x200 --save " + saved + " --json " +
        (folder / "t.json").string() + byTier(" --validate=core", " --validate"));
  CHECK(readPly(saved).size() >= 4900);
  CHECK(jsonOf(folder / "t.json")["ticks"] > 0);
  CHECK(std::filesystem::exists(folder / "touched.png"));
}

TEST_CASE("a signal while a file is written leaves the older file, and no temporary one") {
  const ScratchFolder folder;
  works("--quiet make sphere -n 1000000 -o " + (folder / "model.ply").string());
  std::ofstream(folder / "points.csv") << "old";
  const auto temporaries = [&] {
    return std::ranges::count_if(std::filesystem::directory_iterator(folder.path()),
                                 [](const auto& entry) { return entry.path().extension() == ".tmp"; });
  };
  RunningProgram convert(
      "convert " + (folder / "model.ply").string() + " " + (folder / "points.csv").string() + " --force",
      folder / "said");
  REQUIRE_MESSAGE(convert.waitFor([&] { return temporaries() > 0; }), contentOf(folder / "said"));
  const int status = convert.wait(SIGINT);
  CHECK(WIFSIGNALED(status));
  CHECK(WTERMSIG(status) == SIGINT);
  CHECK(temporaries() == 0);
  CHECK(contentOf(folder / "points.csv") == "old");
}

TEST_CASE("an interrupted session keeps its trace and reports the interruption") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  std::ofstream(folder / "long.csv") << "t_s,x,y,z\n0,0,0,60\n60,0,0,60\n";
  const auto file = [&](const char* name) { return (folder / name).string(); };
  RunningProgram session("touch " + model + " --backend vulkan --realtime --path " + file("long.csv") + " --trace " +
                             file("t.csv") + " --json " + file("t.json") + " --log " + file("log") + " --picture " +
                             file("t.png"),
                         folder / "said");
  REQUIRE_MESSAGE(session.waitForTicks(folder / "log"), contentOf(folder / "said"));
  CHECK(WEXITSTATUS(session.wait(SIGINT)) == 130);
  CHECK(says(contentOf(folder / "said"), "t.png: not drawn, because the session was interrupted"));
  CHECK(!std::filesystem::exists(folder / "t.png"));
  CHECK(jsonOf(folder / "t.json")["interrupted"] == true);
  CHECK(readTrace(folder / "t.csv").size() > 10);
}

TEST_CASE("outputs follow links, keep permissions, and never replace a device") {
  const ScratchFolder folder;
  const auto real = folder / "real.ply", link = folder / "link.ply";
  std::ofstream(real) << "old";
  std::filesystem::permissions(real, std::filesystem::perms::owner_read | std::filesystem::perms::owner_write);
  std::filesystem::create_symlink(real, link);
  works("make plane -n 10 -o " + link.string());
  CHECK(std::filesystem::is_symlink(link));
  CHECK(readPly(real).size() == 10);
  CHECK((std::filesystem::status(real).permissions() & std::filesystem::perms::others_read) ==
        std::filesystem::perms::none);
  works("make plane -n 10 -o /dev/null");
  CHECK(std::filesystem::is_character_file("/dev/null"));
  if (std::filesystem::exists("/dev/full")) CHECK(palpate("make plane -n 10 -o /dev/full").code == 1);
}

TEST_CASE("a session in real time ends after its path and reports its ticks") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 20000 -o " + model);
  const auto outcome = palpate("touch " + model + " --backend vulkan --path builtin:press --realtime --picture " +
                               (folder / "p.png").string() + " --size 160x100 --json " + (folder / "t.json").string());
  CHECK(outcome.code == 0);
  CHECK(jsonOf(folder / "t.json")["ticks"] > 0);
  CHECK(std::filesystem::exists(folder / "p.png"));
}

// Otherwise a software driver compiles the shaders during the first ticks, for ten seconds, without a force on the
// hand.
TEST_CASE("a session in real time starts after the driver has compiled every shader" * kClock) {
  if (std::getenv("PALPATE_GPU") == nullptr || std::string(std::getenv("PALPATE_GPU")) != "llvmpipe") {
    MESSAGE("skipped: for lavapipe, which PALPATE_GPU does not name");
    return;
  }
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  const auto played = [&] {
    const Outcome outcome =
        palpate("touch " + model + " --backend vulkan --edit push --penetration 4 --realtime --json " +
                (folder / "t.json").string());
    REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
    return jsonOf(folder / "t.json");
  };
  const auto isStale = [](const Result& json) {
    return json["safety"]["stale_ticks"].get<int>() >= json["ticks"].get<int>() / 4;
  };
  ::setenv("MESA_SHADER_CACHE_DISABLE", "true", 1);
  const auto json = played();
  ::unsetenv("MESA_SHADER_CACHE_DISABLE");
  CHECK(json["moved_points"] > 0);
  if (!isStale(json)) return;
  // This machine may be too slow even with compiled shaders.
  works("touch " + model + " --backend vulkan --edit push --penetration 4");
  const bool tooBusy = isStale(played());
  CHECK(tooBusy);
  if (tooBusy) MESSAGE("this machine is too busy to tell: answers are late even when no shader is compiled");
}

TEST_CASE("info reports points, bounds and memory of a made model, as JSON in a file and on standard output") {
  const ScratchFolder folder;
  const std::string model = (folder / "cube.ply").string();
  works("make cube -n 1000 -o " + model + " --center 10,20,30 --size 2 --noise 0.01 --seed 3");
  works("info " + model + " --json " + (folder / "info.json").string());
  const auto json = jsonOf(folder / "info.json");
  CHECK(json["points"] == 1000);
  CHECK(json["normals"] == true);
  CHECK(json["bounds"]["min"][1].get<double>() == within(19, 0.05));
  CHECK(json["gpu_bytes"]["total"] > 100'000);
  CHECK(palpate("info " + model + " --json -").text.find("\"points\": 1000") != std::string::npos);
}

TEST_CASE("render writes a picture and a depth file, with any pass, colour and camera" * kMoreInFull) {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string(), image = (folder / "i.png").string();
  works("make torus -n 5000 -o " + model);
  for (const char* options : {"--depth DEPTH --validate", "--pass normal", "--pass depth", "--color height",
                              "--camera 'eye=0,0,300 target=0,0,0 up=0,1,0 fov=30'", "--background 255,255,255",
                              "--splat-radius 3", "--print-frame", "--raster hardware --validate"}) {
    CAPTURE(options);
    std::string text = options;
    if (const auto at = text.find("--validate"); at != std::string::npos && !inFullTier()) text += "=core";
    if (const auto at = text.find("DEPTH"); at != std::string::npos) text.replace(at, 5, (folder / "d.pfm").string());
    CHECK(palpate("render " + model + " -o " + image + " --size 160x100 " + text).code == 0);
    CHECK(contentOf(image).starts_with("\x89PNG"));
    std::filesystem::remove(image);
  }
  works("render " + model + " -o " + (folder / "i.jpg").string() + " --size 160x100");
  CHECK(contentOf(folder / "i.jpg").starts_with("\xff\xd8\xff"));
  CHECK(contentOf(folder / "d.pfm").starts_with("Pf"));
}

TEST_CASE("wrong usage exits with 2 and a reason; a failed command with 1, in one line, and leaves no file") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), out = (folder / "o.png").string();
  works("make sphere -n 5000 -o " + model);
  const auto fails = [&](const std::string& arguments, int code, const std::string& reason) {
    CAPTURE(arguments);
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == code);
    CHECK_MESSAGE(outcome.text.find(reason) != std::string::npos, outcome.text);
  };
  fails("fly", 2, "fly");
  fails("touch " + model + " --rate none", 2, "--rate");
  fails("touch " + model + " --path builtin:dance", 2, "press");
  fails("touch " + model + " --edit push --push-rate 2", 2, "--push-rate");
  fails("touch " + model + " --radius -1", 2, "--radius");
  fails("touch " + model + " --passivity on", 2, "does not yield to forces");
  fails("touch " + model + " --hand-stiffness 1", 2, "--device sim");
  fails("touch " + model + " --device sim --map large", 2, "--map");
  fails("touch " + model + " --device hid --duration 1", 2, "--device hid requires --realtime");
  fails("touch " + model + " --device hid --realtime", 2, "--duration");
  fails("touch " + model + " --device hid --realtime --duration 1 --hand-damping 1", 2, "--device sim");
  fails("touch " + model + " --device hid:none --realtime --duration 1", 1, "no DualSense that is 'none'");
  fails("touch " + model + " --device joystick", 2, "joystick");
  fails("touch " + model + " --rumble", 2, "--rumble requires --realtime");
  fails("touch " + model + " --save x.ply", 2, "--edit");
  fails("render " + model + " -o " + (folder / "o.tif").string(), 2, ".png, .jpg, .jpeg");
  fails("touch " + model + " --picture " + (folder / "o.bmp").string(), 2, ".png, .jpg, .jpeg");
  fails("render " + model + " -o " + out + " --size 10", 2, "--size");
  fails("render " + model + " -o " + out + " --camera 'eye=1,2'", 2, "eye");
  fails("render " + model + " -o " + out + " --pass none", 2, "none");
  fails("render " + model + " -o " + out + " --raster brush", 2, "raster");
  fails("touch " + model + " --edit push --yield-depth nan", 2, "--yield-depth");
  fails("touch " + model + " --edit scratch", 2, "--edit");
  fails("touch " + model + " --edit carve --strength 2", 2, "--strength");
  fails("touch " + model + " --backend cpu --edit smooth --falloff 0.5", 2, "--falloff");
  fails("touch " + model + " --backend cpu --edit smooth --falloff 17", 2, "--falloff");
  fails("touch " + model + " --backend cpu --edit paint --paint-color 300,0,0", 2, "--paint-color");
  fails("touch " + model + " --surface sharpest", 2, "--surface");
  fails("touch " + model + " --surface sphere --backend cuda", 2, "--surface");
  fails("touch " + model + " --friction -1", 2, "--friction");
  fails("touch " + model + " --backend abacus", 2, "--backend");
  fails("touch " + model + " --backend cpu --method fused", 2, "--method");
  for (const char* former : {"--wait spin", "--sort radix", "--grid 64", "--spare 9"})
    fails("touch " + model + " --backend cpu " + former, 2, std::string(former).substr(0, 6));
  fails("touch " + model + " --backend cpu --print-tick", 2, "--print-tick");
  fails("touch " + model + " --mm-per-unit inf", 2, "--mm-per-unit");
  fails("touch " + model + " --picture " + out + " --size 0x0", 2, "size: 0 pixels");
  fails("touch " + model + " --trace " + (folder / "no/where.csv").string(), 1, "where.csv");
  std::filesystem::create_directory(folder / "folder.png");
  fails("render " + model + " -o " + (folder / "folder.png").string(), 1, "is a folder");
  fails("render " + model + " -o " + out + " --splat-radius 1e9", 2, "--splat-radius");
  fails("make sphere -n -5 -o " + out, 2, "--points");
  fails("make sphere -n 10 --size 1e38 -o " + out, 2, "--size");
  fails("make ball -n 10 -o " + (folder / "o.ply").string(), 2, "sphere");
  fails("make sphere -n 10 --center 1,2 -o " + out, 2, "--center");
  fails("info " + (folder / "none.ply").string(), 1, "none.ply");
  fails("touch " + model + " --path " + (folder / "none.csv").string(), 1, "none.csv");
  fails("render " + model + " -o " + (folder / "no/where.png").string(), 1, "where.png");
  fails("render " + model + " -o " + out + " --gpu 'no such card'", 1, "no such card");
  std::ofstream(folder / "bad.ply") << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                                       "property float z\nend_header\n0 0 0\n1 x 1\n";
  fails("render " + (folder / "bad.ply").string() + " -o " + out, 1, "bad.ply:9");
  std::ofstream(folder / "bad.csv") << "t_s,x,y,z\n0,0,0,0\n1,2,x,0\n";
  fails("touch " + model + " --path " + (folder / "bad.csv").string(), 1, "bad.csv:3");
  CHECK_FALSE(std::filesystem::exists(out));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    CHECK(entry.path().extension() != ".tmp");
}

TEST_CASE("options may name their default values") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 5000 -o " + model);
  works("touch " + model + " --device path --backend vulkan --method fused --surface sharp --index rebuild");
}

TEST_CASE("doctor, --version and --help print their information") {
  CHECK(palpate("--version").text.find("palpate ") == 0);
  CHECK(palpate("--help").code == 0);
  for (const char* name : {"info", "make", "touch", "render", "bench", "doctor"}) {
    CHECK(palpate("--help").text.find(name) != std::string::npos);
    CHECK(palpate(std::string(name) + " --help").code == 0);
  }
  const Outcome outcome = palpate("doctor");
  CHECK(outcome.code == 0);
  CHECK(outcome.text.find("touch: family") != std::string::npos);
}

}  // namespace palpate::palpate_test
