// The program as a user meets it: commands, files, exit codes, messages.
#include <doctest/doctest.h>
#include <sys/wait.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>
#include <sstream>

#include "engine/cloud/ply_reader.hpp"
#include "engine/core/vec.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

namespace {

struct Outcome {
  int code = 0;
  std::string text;  // stdout and stderr
};

Outcome palpate(const std::string& arguments) {
  const char* elsewhere = std::getenv("PALPATE_PROGRAM");  // where the tests run on another machine than built them
  const std::string command = std::string(elsewhere ? elsewhere : PALPATE_PROGRAM) + " " + arguments + " 2>&1";
  Outcome outcome;
  std::FILE* pipe = ::popen(command.c_str(), "r");
  REQUIRE(pipe);
  std::array<char, 4096> piece;
  while (const std::size_t size = std::fread(piece.data(), 1, piece.size(), pipe))
    outcome.text.append(piece.data(), size);
  const int status = ::pclose(pipe);
  outcome.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  return outcome;
}

// For commands that have to work: a failing one says what it was and what it said.
void works(const std::string& arguments) {
  const Outcome outcome = palpate(arguments);
  REQUIRE_MESSAGE(outcome.code == 0, "palpate " << arguments << "\n" << outcome.text);
}

std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file, std::ios::binary).rdbuf();
  return text.str();
}

nlohmann::json jsonOf(const std::filesystem::path& file) { return nlohmann::json::parse(contentOf(file)); }

struct Row {
  double t_s = 0, penetration_mm = 0;
  DVec3 hip{0}, proxy{0}, normal{0}, force{0};
  bool contact = false;
};

std::vector<Row> readTrace(const std::filesystem::path& file) {
  std::istringstream lines(contentOf(file));
  std::string line;
  std::getline(lines, line);
  CHECK(line ==
        "t_s,hip_x,hip_y,hip_z,proxy_x,proxy_y,proxy_z,normal_x,normal_y,normal_z,force_x,force_y,force_z,"
        "penetration_mm,contact,neighbours,fresh,gpu_us,step_us");
  std::vector<Row> rows;
  while (std::getline(lines, line)) {
    std::vector<double> cells;
    std::istringstream in(line);
    for (std::string cell; std::getline(in, cell, ',');) cells.push_back(std::stod(cell));
    REQUIRE(cells.size() == 19);
    const auto at = [&](std::size_t i) { return DVec3(cells[i], cells[i + 1], cells[i + 2]); };
    rows.push_back({cells[0], cells[13], at(1), at(4), at(7), at(10), cells[14] != 0});
  }
  return rows;
}

}  // namespace

TEST_CASE("a press on a sphere: no force outside, along the true normal inside, at the depth that theory gives") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), trace = (folder / "trace.csv").string();
  works("make sphere -n 200000 -o " + model);
  works("touch " + model + " --surface average --path builtin:press --trace " + trace + " --validate --json " +
        (folder / "touch.json").string());
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
    CHECK(50 - glm::length(row.proxy) == doctest::Approx(bias).epsilon(0.15));
  }
  CHECK(touched > 200);
  const auto json = jsonOf(folder / "touch.json");
  CHECK(json["points"] == 200000);
  CHECK(json["ticks"] == rows.size());
  CHECK(json["contact_ticks"] == touched);
  CHECK(json["peak_force_N"] > 1.0);
  CHECK(json["contact_error_mm"] < 0.001);
}

TEST_CASE("virtual time gives the same trace, the same cloud and the same picture, byte by byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string();
  works("make torus -n 20000 -o " + model);
  for (const char* run : {"a", "b"}) {
    const auto file = [&](const char* ending) { return (folder / (std::string(run) + ending)).string(); };
    works("touch " + model + " --path builtin:slide --edit push --tau 0.3 --trace " + file(".csv") + " --save " +
          file(".ply") + " --picture " + file(".png") + " --size 320x200");
  }
  for (const char* ending : {".csv", ".ply", ".png"}) {
    CAPTURE(ending);
    const std::string a = contentOf(folder / ("a" + std::string(ending)));
    CHECK(!a.empty());
    CHECK(a == contentOf(folder / ("b" + std::string(ending))));
  }
}

TEST_CASE(
    "every query method gives the same trace, byte by byte; brute, which adds up in another order, the same force") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 20000 -o " + model);
  const auto traceOf = [&](const std::string& method) {
    const std::string trace = (folder / (method + ".csv")).string(), json = (folder / (method + ".json")).string();
    works("touch " + model + " --path builtin:slide --method " + method + " --trace " + trace + " --json " + json);
    CHECK(jsonOf(json).at("method") == method);
    return trace;
  };
  const std::string fused = traceOf("fused");
  CHECK(!contentOf(fused).empty());
  for (const char* method : {"indirect", "naive", "two-step"}) {
    CAPTURE(method);
    CHECK(contentOf(traceOf(method)) == contentOf(fused));
  }
  const auto rows = readTrace(fused), brute = readTrace(traceOf("brute"));
  REQUIRE(brute.size() == rows.size());
  double worst_N = 0;
  for (std::size_t i = 0; i < rows.size(); ++i)
    worst_N = std::max(worst_N, glm::distance(rows[i].force, brute[i].force));
  CHECK(worst_N < 1e-3);
  CHECK(std::ranges::any_of(rows, &Row::contact));
}

TEST_CASE("a push leaves a dent in the saved file, and carries everything else through") {
  const ScratchFolder folder;
  const std::string plain = (folder / "plain.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 30000 --ascii -o " + plain);
  // The same cloud with a property that nobody knows.
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
  works("touch " + (folder / "model.ply").string() + " --edit push --penetration 4 --save " + saved + " --json " +
        (folder / "touch.json").string());
  const PointCloud before = readPly(folder / "model.ply"), after = readPly(saved);
  REQUIRE(after.size() == before.size());
  REQUIRE(after.extra.size() == 1);
  CHECK(after.extra[0].name == "confidence");
  CHECK(after.extra[0].data == before.extra[0].data);
  std::size_t moved = 0;
  double deepest = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    moved += after.positions[i] != before.positions[i];
    deepest = std::max(deepest, 50.0 - glm::length(DVec3(after.positions[i])));
  }
  CHECK(deepest > 3);
  CHECK(moved > 50);
  CHECK(jsonOf(folder / "touch.json")["moved_points"] == moved);
}

TEST_CASE("sculpting in real time with a picture and a saved cloud ends cleanly") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), saved = (folder / "saved.ply").string();
  works("make sphere -n 5000 -o " + model);
  works("touch " + model + " --path builtin:press --penetration 4 --edit push --realtime --validate --picture " +
        (folder / "touched.png").string() + " --size 320x200 --save " + saved + " --json " +
        (folder / "t.json").string());
  CHECK(readPly(saved).size() == 5000);
  CHECK(jsonOf(folder / "t.json")["ticks"] > 0);
  CHECK(std::filesystem::exists(folder / "touched.png"));
}

TEST_CASE("the CPU answers as the GPU does: the same press gives the same forces, on a still and on a yielding cloud") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 30000 -o " + model);
  for (const std::string edit : {"", " --edit push --penetration 3"}) {
    CAPTURE(edit);
    std::vector<Row> traces[2];
    std::size_t moved[2] = {0, 0};
    for (const int k : {0, 1}) {
      const std::string backend = k == 0 ? "vulkan" : "cpu";
      const auto trace = folder / (backend + ".csv"), json = folder / (backend + ".json");
      works("touch " + model + edit + " --backend " + backend + " --trace " + trace.string() + " --json " +
            json.string());
      traces[k] = readTrace(trace);
      moved[k] = jsonOf(json)["moved_points"];
      CHECK(jsonOf(json)["backend"] == backend);
      CHECK(jsonOf(json)["contact_error_mm"] < 0.001);
    }
    REQUIRE(traces[0].size() == traces[1].size());
    double worst_N = 0;
    std::size_t touched = 0;
    for (std::size_t i = 0; i < traces[0].size(); ++i) {
      worst_N = std::max(worst_N, glm::distance(traces[0][i].force, traces[1][i].force));
      touched += traces[1][i].contact;
      CHECK(traces[0][i].contact == traces[1][i].contact);
    }
    CHECK(touched > 200);
    CHECK(worst_N < 1e-3);
    CHECK((moved[1] > 0) == !edit.empty());
    CHECK(std::abs(static_cast<double>(moved[0]) - static_cast<double>(moved[1])) < 5);
  }
}

TEST_CASE("the CPU needs no GPU unless a picture is asked for, sculpts and saves, and the same again byte by byte") {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string();
  works("make torus -n 20000 -o " + model);
  for (const std::string run : {"a", "b"})
    works("touch " + model + " --gpu 'no such card' --backend cpu --path builtin:slide --edit push --tau 0.3 --trace " +
          (folder / (run + ".csv")).string() + " --save " + (folder / (run + ".ply")).string() +
          (run == "a" ? " --threads 1" : " --threads 3"));
  CHECK(contentOf(folder / "a.csv") == contentOf(folder / "b.csv"));
  CHECK(contentOf(folder / "a.ply") == contentOf(folder / "b.ply"));
  CHECK(readPly(folder / "a.ply").positions != readPly(model).positions);
  works("touch " + model + " --backend cpu --bucket-key morton --grid 64 --edit push --realtime --picture " +
        (folder / "p.png").string() + " --size 320x200 --validate");
  CHECK(contentOf(folder / "p.png").starts_with("\x89PNG"));
}

TEST_CASE("an interrupted session keeps its trace and says that it was interrupted") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 5000 -o " + model);
  std::ofstream(folder / "long.csv") << "t_s,x,y,z\n0,0,0,60\n60,0,0,60\n";
  const char* elsewhere = std::getenv("PALPATE_PROGRAM");
  const std::string command = "timeout -s INT 2 " + std::string(elsewhere ? elsewhere : PALPATE_PROGRAM) + " touch " +
                              model + " --realtime --path " + (folder / "long.csv").string() + " --trace " +
                              (folder / "t.csv").string() + " --json " + (folder / "t.json").string() +
                              " 2>/dev/null >&2";
  CHECK(std::system(command.c_str()) != 0);
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

TEST_CASE("real time ends by itself and reports its ticks") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string();
  works("make sphere -n 20000 -o " + model);
  const auto outcome = palpate("touch " + model + " --path builtin:press --realtime --picture " +
                               (folder / "p.png").string() + " --size 160x100 --json " + (folder / "t.json").string());
  CHECK(outcome.code == 0);
  CHECK(jsonOf(folder / "t.json")["ticks"] > 0);
  CHECK(std::filesystem::exists(folder / "p.png"));
}

TEST_CASE("info and make tell what there is") {
  const ScratchFolder folder;
  const std::string model = (folder / "cube.ply").string();
  works("make cube -n 1000 -o " + model + " --center 10,20,30 --size 2 --noise 0.01 --seed 3");
  works("info " + model + " --json " + (folder / "info.json").string());
  const auto json = jsonOf(folder / "info.json");
  CHECK(json["points"] == 1000);
  CHECK(json["normals"] == true);
  CHECK(json["bounds"]["min"][1].get<double>() == doctest::Approx(19).epsilon(0.01));
  CHECK(json["gpu_bytes"]["total"] > 100'000);
  CHECK(palpate("info " + model + " --json -").text.find("\"points\": 1000") != std::string::npos);
}

TEST_CASE("render writes a picture and a depth file; every pass, colour and camera can be asked for") {
  const ScratchFolder folder;
  const std::string model = (folder / "torus.ply").string(), image = (folder / "i.png").string();
  works("make torus -n 5000 -o " + model);
  for (const char* options : {"--depth DEPTH --validate", "--pass normal", "--pass depth", "--color height",
                              "--camera 'eye=0,0,300 target=0,0,0 up=0,1,0 fov=30'", "--background 255,255,255",
                              "--splat-radius 3", "--print-frame"}) {
    CAPTURE(options);
    std::string text = options;
    if (const auto at = text.find("DEPTH"); at != std::string::npos) text.replace(at, 5, (folder / "d.pfm").string());
    CHECK(palpate("render " + model + " -o " + image + " --size 160x100 " + text).code == 0);
    CHECK(contentOf(image).starts_with("\x89PNG"));
    std::filesystem::remove(image);
  }
  CHECK(contentOf(folder / "d.pfm").starts_with("Pf"));
}

TEST_CASE("wrong usage is exit code 2 with a reason; what could not be done is 1, in one line, and leaves no file") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string(), out = (folder / "o.png").string();
  works("make sphere -n 5000 -o " + model);
  const auto fails = [&](const std::string& arguments, int code, const std::string& reason) {
    CAPTURE(arguments);
    const Outcome outcome = palpate(arguments);
    CHECK(outcome.code == code);
    CHECK_MESSAGE(outcome.text.find(reason) != std::string::npos, outcome.text);
  };
  fails("", 2, "subcommand");
  fails("fly", 2, "fly");
  fails("touch " + model + " --rate none", 2, "--rate");
  fails("touch " + model + " --path builtin:dance", 2, "press");
  fails("touch " + model + " --edit push --beta 2", 2, "--beta");
  fails("touch " + model + " --radius -1", 2, "--radius");
  fails("touch " + model + " --passivity on", 2, "yields to no force");
  fails("touch " + model + " --hand-stiffness 1", 2, "--device sim");
  fails("touch " + model + " --device sim --map large", 2, "--map");
  fails("touch " + model + " --save x.ply", 2, "--edit");
  fails("render " + model + " -o " + out + " --size 10", 2, "--size");
  fails("render " + model + " -o " + out + " --camera 'eye=1,2'", 2, "eye");
  fails("render " + model + " -o " + out + " --pass none", 2, "none");
  fails("touch " + model + " --edit push --tau nan", 2, "--tau");
  fails("touch " + model + " --surface sharpest", 2, "--surface");
  fails("touch " + model + " --surface sphere --backend cuda", 2, "--surface");
  fails("touch " + model + " --friction 0.3 --backend cuda", 2, "--friction");
  fails("touch " + model + " --friction -1", 2, "--friction");
  fails("touch " + model + " --backend abacus", 2, "--backend");
  fails("touch " + model + " --backend cpu --method fused", 2, "--method");
  fails("touch " + model + " --backend cpu --wait spin", 2, "--wait");
  fails("touch " + model + " --backend cpu --print-tick", 2, "--print-tick");
  fails("touch " + model + " --mm-per-unit inf", 2, "--mm-per-unit");
  fails("touch " + model + " --picture " + out + " --size 0x0", 2, "--size");
  fails("touch " + model + " --trace " + (folder / "no/where.csv").string(), 1, "where.csv");
  fails("render " + model + " -o " + folder.path().string(), 1, "folder");
  fails("render " + model + " -o " + out + " --splat-radius 1e9", 2, "--splat-radius");
  fails("make sphere -n -5 -o " + out, 2, "--points");
  fails("make sphere -n 10 --size 1e38 -o " + out, 2, "--size");
  fails("make ball -n 10 -o " + out, 2, "sphere");
  fails("make sphere -n 10 --center 1,2 -o " + out, 2, "--center");
  fails("info " + (folder / "none.ply").string(), 1, "none.ply");
  fails("touch " + model + " --path " + (folder / "none.csv").string(), 1, "none.csv");
  fails("render " + model + " -o " + (folder / "no/where.png").string(), 1, "where.png");
  fails("render " + model + " -o " + out + " --gpu 'no such card'", 1, "no such card");
  std::ofstream(folder / "bad.ply") << "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                                       "property float z\nend_header\n0 0 0\n1 nan 1\n";
  fails("render " + (folder / "bad.ply").string() + " -o " + out, 1, "bad.ply:9");
  std::ofstream(folder / "bad.csv") << "t_s,x,y,z\n0,0,0,0\n1,2,x,0\n";
  fails("touch " + model + " --path " + (folder / "bad.csv").string(), 1, "bad.csv:3");
  CHECK_FALSE(std::filesystem::exists(out));
  for (const auto& entry : std::filesystem::directory_iterator(folder.path()))
    CHECK(entry.path().extension() != ".tmp");
}

TEST_CASE("a simulated Touch presses, slides and rests, the same every time, and makes no energy") {
  const ScratchFolder folder;
  const std::string model = (folder / "sphere.ply").string(), json = (folder / "t.json").string();
  works("make sphere -n 20000 -o " + model);
  for (const std::string backend : {"cpu", "vulkan"}) {
    CAPTURE(backend);
    for (const std::string run : {"a", "b"})
      works("touch " + model + " --device sim --backend " + backend + " --trace " + (folder / run).string() +
            " --json " + json);
    CHECK(contentOf(folder / "a") == contentOf(folder / "b"));
    const auto rows = readTrace(folder / "a");
    CHECK(rows.front().force == DVec3(0));
    // The hand means to be 2 mm deep, and yields: its own 0.4 N/mm against the surface's 0.8.
    CHECK(rows.back().penetration_mm > 0.3);
    CHECK(rows.back().penetration_mm < 1);
    CHECK(glm::length(rows.back().force) == doctest::Approx(0.8 * rows.back().penetration_mm).epsilon(0.01));
    const auto result = jsonOf(json);
    CHECK(result["passivity_energy_mJ"] > -0.1);
    std::size_t counted = 0;
    for (const std::size_t ticks : result["tick_histogram_us"]["ticks"]) counted += ticks;
    CHECK(counted == rows.size());
    CHECK(result["safety"]["errors"] == 0);
  }
  works("touch " + model +
        " --device sim --path builtin:scan --hand-stiffness 0.8 --hand-damping 0.004 --map identity "
        "--passivity observe --backend cpu --duration 0.3 --realtime --rate 4000 --json " +
        json);
  CHECK(jsonOf(json)["ticks"].get<int>() + jsonOf(json)["missed_ticks"].get<int>() == 1201);
  works("touch " + model + " --backend cpu --json " + json);
  CHECK(jsonOf(json)["passivity_energy_mJ"].is_null());
}

TEST_CASE("a script may name the way that is the default") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 5000 -o " + model);
  works("touch " + model + " --device path --backend vulkan --method fused --surface sharp --index rebuild --grid 128");
}

TEST_CASE("a back end that is not there, and a method that it does not have, are told apart") {
  const ScratchFolder folder;
  const std::string model = (folder / "s.ply").string();
  works("make sphere -n 5000 -o " + model);
  const Outcome cuda = palpate("touch " + model + " --backend cuda --method graph");
  if (cuda.code != 0) {
    CHECK(cuda.code == 1);
    CHECK(cuda.text.find("CUDA") != std::string::npos);
  }
  const Outcome wrong = palpate("touch " + model + " --backend cuda --method nothing");
  CHECK(wrong.code == 2);
  CHECK(wrong.text.find("array-dp") != std::string::npos);
  CHECK(palpate("touch " + model + " --method naive-dp").code == 2);
}

TEST_CASE("doctor, version and help answer") {
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

TEST_CASE("bench measures every job by every way of the back ends that are asked for, and plots it") {
  const ScratchFolder folder;
  const std::string json = (folder / "b.json").string(), plot = (folder / "b.png").string();
  const Outcome outcome =
      palpate("bench build sort query step --sizes 2000 5000 --backend vulkan,cpu --repeat 5 --json " + json +
              " --plot " + plot);
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  std::map<std::string, std::set<std::string>> ways;  // by bench and back end
  const auto result = jsonOf(json);
  for (const auto& record : result["records"]) {
    CAPTURE(record.dump());
    const auto& time = record["wall_us"].is_null() ? record["gpu_us"] : record["wall_us"];
    CHECK(time["n"] == 5);
    CHECK(time["p50"] > 0);
    CHECK(time["p999"] >= time["p50"]);
    CHECK((record["points"] == 2000 || record["points"] == 5000));
    ways[record["bench"].get<std::string>() + " " + record["backend"].get<std::string>()].insert(record["way"]);
  }
  CHECK(ways["build vulkan"].contains("radix"));
  CHECK(ways["build vulkan"].contains("counting"));
  CHECK(ways["build cpu"] == std::set<std::string>{"multimap", "sorted grid", "k-d tree"});
  CHECK(ways["sort vulkan"].contains("radix"));
  for (const char* bench : {"query vulkan", "step vulkan"})
    CHECK(ways[bench] == std::set<std::string>{"brute", "two-step", "naive", "indirect", "fused"});
  CHECK(ways["step cpu"] == std::set<std::string>{"direct"});
  for (const char* title : {"step, vulkan, static, in all", "step, vulkan, edited, in all", "build, cpu, last order"})
    CHECK(outcome.text.find(title) != std::string::npos);
  CHECK(std::filesystem::file_size(plot) > 20'000);
}

TEST_CASE("bench refuses a method or a back end that there is not, and measures only what it is told") {
  CHECK(palpate("bench step --sizes 2000 --backend quantum").code == 2);
  const Outcome wrong = palpate("bench step --sizes 2000 --method persistent");
  CHECK(wrong.code == 2);
  CHECK(wrong.text.find("two-step") != std::string::npos);
  const Outcome brute = palpate("bench query --sizes 2000 --method brute --repeat 5");
  CHECK(brute.code == 0);
  CHECK(brute.text.find("brute") != std::string::npos);
  CHECK(brute.text.find("fused") == std::string::npos);
}

TEST_CASE("bench touch judges what is felt: nothing in the air, the same twice, along the true normal") {
  const ScratchFolder folder;
  works("bench touch --backend cpu --sizes 5000 --shapes sphere,cube --conditions clean,uneven --json " +
        (folder / "t.json").string());
  const auto touch = jsonOf(folder / "t.json")["touch"];
  REQUIRE(touch["judgements"].size() == 4 * 3);  // shapes and conditions, for every surface
  for (const auto& judgement : touch["judgements"]) {
    for (const char* key : {"surface", "subject", "condition", "M7_step_us", "M10_friction", "M11_edit", "slide_N"})
      CHECK_MESSAGE(judgement.contains(key), key);
    CHECK(judgement["M8_free_force_N"] == 0.0);
    CHECK(judgement["M12_sameness"]["identical"] == true);
    REQUIRE(judgement["slides"].size() == 3);
    for (const auto& slide : judgement["slides"])
      for (const char* key : {"M1_angle_deg", "M2_height", "M3_force_relative_rms", "M4_continuity", "M6_lag"})
        CHECK_MESSAGE(slide.contains(key), key);
  }
  const auto sphere = touch["judgements"][0];
  const double radius = sphere["radius_mm"];
  CHECK(sphere["slides"][1]["held_share"] == 1.0);
  CHECK(sphere["slides"][1]["M1_angle_deg"]["max"] < 1);
  CHECK(sphere["slides"][1]["M2_height"]["bias_mm"].get<double>() ==
        doctest::Approx(-0.0694 * radius * radius / 50).epsilon(0.1));
  CHECK(sphere["M11_edit"]["ticks_until_equal"] == 0);
  CHECK(touch["M5_plates"].size() == 3 * 15);
  CHECK(touch["M5_plates"].back()["through_share"] == 0.0);
  CHECK(touch["M9_stability"].size() == 24);
  for (const auto& study : touch["M9_stability"]) {
    CHECK(study["largest_stiffness_N_per_mm"] > 0.4);
    // Much damping on old data is what makes energy.
    if (study["damping_N_s_per_mm"] <= 0.008) CHECK(study["least_energy_mJ"] > -0.1);
  }
}

TEST_CASE("bench touch holds a scan against its mesh, and refuses one without the other") {
  const ScratchFolder folder;
  const std::string scan = (folder / "scan.ply").string(), mesh = (folder / "mesh.ply").string();
  works("make plane -n 20000 -o " + scan);
  std::ofstream(mesh)
      << "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
         "-50 -50 0\n50 -50 0\n50 50 0\n-50 50 0\n4 0 1 2 3\n";
  works("bench touch --backend cpu --quick --models " + scan + " --truth " + mesh + " --json " +
        (folder / "t.json").string());
  const auto judgement = jsonOf(folder / "t.json")["touch"]["judgements"][0];
  CHECK(judgement["subject"] == "scan");
  CHECK(judgement["slides"][0]["M3_force_relative_rms"] < 1e-3);
  CHECK(palpate("bench touch --backend cpu --models " + scan).code == 2);
  CHECK(palpate("bench touch build --backend cpu").code == 2);
  CHECK(palpate("bench touch --shapes ball").code == 2);
}

}  // namespace palpate
