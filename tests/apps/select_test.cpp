// Scans are selected and cleaned on the command line: points that stay are untouched in every format, and failures are
// said.
#include "tests/apps/program.hpp"

#include <algorithm>
#include <cstring>

#include "engine/io/cloud_formats.hpp"
#include "tests/near.hpp"
#include "tests/says.hpp"

namespace palpate::select_app_test {

namespace {

template <class T>
Attribute attributeOf(const char* name, ScalarType type, std::size_t count, T first) {
  Attribute made{name, type, {}};
  made.data.resize(count * sizeof(T));
  for (std::size_t i = 0; i < count; ++i) {
    const T value = static_cast<T>(first + static_cast<T>(i % 100));
    std::memcpy(made.data.data() + i * sizeof(T), &value, sizeof(T));
  }
  return made;
}

// A street far from zero, in millimetres, with classes and 64-bit numbers.
PointCloud street() {
  constexpr std::size_t kPoints = 900;
  PointCloud cloud;
  cloud.origin = {637000, 849000, 0};
  for (std::size_t i = 0; i < kPoints; ++i) {
    const DVec3 p(637000 + 0.1 * static_cast<double>(i % 30) + 0.001 * static_cast<double>(i % 7),
                  849000 + 0.1 * static_cast<double>(i / 30) + 0.001, 0.003 * static_cast<double>(i % 11));
    cloud.exactPositions.push_back(p);
    cloud.positions.emplace_back(p - cloud.origin);
    cloud.colors.push_back({static_cast<std::uint8_t>(i), 2, 3, 255});
  }
  cloud.storedAs.position = ScalarType::f64;
  cloud.storedAs.grid = CoordinateGrid{.step = DVec3(0.001), .offset = {637000, 849000, 0}};
  cloud.extra.push_back(attributeOf<std::uint8_t>("classification", ScalarType::u8, kPoints, 0));
  for (std::size_t i = 0; i < kPoints; ++i) cloud.extra[0].data[i] = std::byte(i % 3);
  cloud.extra.push_back(attributeOf<std::int64_t>("id", ScalarType::i64, kPoints, 9007199254740993));
  cloud.extra.push_back(attributeOf<std::uint64_t>("stamp", ScalarType::u64, kPoints, 18446744073709551500u));
  cloud.extra.push_back(attributeOf<float>("heat", ScalarType::f32, kPoints, 0.1f));
  return cloud;
}

// Compares the points `from` of a cloud with those of another, bit by bit.
void checkSame(const PointCloud& before, const std::vector<std::size_t>& from, const PointCloud& after) {
  REQUIRE(after.size() == from.size());
  REQUIRE(after.extra.size() == before.extra.size());
  bool same = true;
  for (std::size_t i = 0; i < from.size(); ++i) {
    same = same && after.fileCoordinates(i) == before.fileCoordinates(from[i]);
    if (before.hasColors()) same = same && after.colors[i] == before.colors[from[i]];
    for (std::size_t k = 0; k < before.extra.size(); ++k) {
      const std::size_t bytes = sizeOf(before.extra[k].type);
      same = same && after.extra[k].name == before.extra[k].name && after.extra[k].type == before.extra[k].type &&
             std::memcmp(after.extra[k].data.data() + i * bytes, before.extra[k].data.data() + from[i] * bytes,
                         bytes) == 0;
    }
  }
  CHECK(same);
}

}  // namespace

TEST_CASE("what a selection leaves is untouched, bit by bit, in every format that can hold it") {
  const ScratchFolder folder;
  for (const char* ending : {".las", ".laz", ".ply", ".pcd", ".npz", ".csv"}) {
    CAPTURE(ending);
    const std::string in = (folder / "in").string() + ending, out = (folder / "out").string() + ending;
    writeCloud(in, street());
    const PointCloud before = readCloud(in).cloud;
    REQUIRE(before.size() == 900);
    works("convert " + in + " " + out + " --where 'classification == 2 && x > 637001.5' --json " +
          (folder / "c.json").string());
    std::vector<std::size_t> from;
    for (std::size_t i = 0; i < 900; ++i)
      if (i % 3 == 2 && before.fileCoordinates(i).x > 637001.5) from.push_back(i);
    CHECK(from.size() > 100);
    checkSame(before, from, readCloud(out).cloud);
    CHECK(jsonOf(folder / "c.json")["steps"][0]["step"] == "--where");
    CHECK(jsonOf(folder / "c.json")["steps"][0]["points_before"] == 900);
    CHECK(jsonOf(folder / "c.json")["points"] == from.size());
    // A field that is set changes nothing else.
    works("convert " + in + " " + out + " --force --set 'classification = 6 if z > 0.02' --normals keep");
    PointCloud after = readCloud(out).cloud;
    std::vector<std::size_t> all(900);
    std::size_t changed = 0;
    for (std::size_t i = 0; i < 900; ++i) {
      all[i] = i;
      const Attribute* const classes = &*std::ranges::find(after.extra, "classification", &Attribute::name);
      const double value = visitScalar(classes->type, [&]<class T>(std::type_identity<T>) {
        return static_cast<double>(loadScalar<T>(classes->data, i * sizeof(T)));
      });
      changed += value == 6;
      CHECK(value == (i % 11 > 6 ? 6 : static_cast<double>(i % 3)));
    }
    CHECK(changed > 100);
    PointCloud others = before;
    for (PointCloud* const each : {&after, &others})
      std::erase_if(each->extra, [](const Attribute& attribute) { return attribute.name == "classification"; });
    checkSame(others, all, after);
  }
}

TEST_CASE("exact whole numbers, crops and duplicates are selected in files") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.las").string(), json = (folder / "c.json").string();
  writeCloud(in, street());
  const auto left = [&](const std::string& options) {
    works("convert " + in + " " + (folder / "o.las").string() + " --force --json " + json + " " + options);
    return jsonOf(json)["points"].get<int>();
  };
  CHECK(left("--where 'id == 9007199254740993'") == 9);
  CHECK(left("--where 'stamp > 18446744073709551590'") == 81);
  // Sides that are coordinates of points belong to the box: four of the second row have 637000.1.
  CHECK(left("--crop 637000,849000,0:637000.1,849003,1") == 30 + 4);
  CHECK(left("--crop-outside 637000,849000,0:637000.1,849003,1") == 900 - 34);
  CHECK(left("--drop-duplicates") == 900);
  CHECK(left("--random 17 --seed 4") == 17);
  // The file is in metres: 1 m is 1000 mm.
  CHECK(left("--subsample 1000 --unit m") == 9);
  CHECK(left("--radius-outliers 2,150") == 0 + 900);
  CHECK(left("--outliers") < 900);
  CHECK(left("--outliers=4,3") > 800);
}

TEST_CASE("many files are converted into a folder: each is written, or says why not") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  writeCloud(in("a.las"), street());
  writeCloud(in("b.ply"), street());
  std::filesystem::create_directory(folder / "other");
  writeCloud(in("other/a.las"), street());
  std::ofstream(in("broken.las")) << "LASF and no more";
  PointCloud bare = street();
  bare.extra.clear();
  writeCloud(in("bare.ply"), bare);
  const std::string all = in("a.las") + " " + in("broken.las") + " " + in("missing.laz") + " " + in("b.ply") + " " +
                          in("other/a.las") + " " + in("bare.ply");
  const std::string out = in("out"), json = in("m.json");
  checkEnds(1, "convert " + all + " --to " + out + " --where 'classification == 1' --json " + json,
            {"broken.las", "missing.laz: does not exist", "4 of 6 files were not converted", "was already written from",
             "bare.ply: --where: column 1: unknown field 'classification'"});
  CHECK(readCloud(out + "/a.las").cloud.size() == 300);
  CHECK(readCloud(out + "/b.ply").cloud.size() == 300);
  CHECK(std::distance(std::filesystem::directory_iterator(out), {}) == 2);
  const auto result = jsonOf(json);
  CHECK(result["failed"] == 4);
  CHECK(result["files"].size() == 6);
  CHECK(result["files"][0]["points"] == 300);
  CHECK(result["files"][1]["error"].get<std::string>().find("broken.las") != std::string::npos);
  works("convert " + in("a.las") + " " + in("b.ply") + " --to " + in("laz") + " --format laz");
  CHECK(std::filesystem::exists(folder / "laz/a.laz"));
  CHECK(readCloud(in("laz/b.laz")).cloud.size() == 900);
  checkEnds(1, "convert " + in("a.las") + " --to " + in("laz") + " --format laz",
            {"exists; name another file, or add --force"});
  checkEnds(2, "convert a.las b.las c.las", {"c.las is a third file; several files are converted into a folder"});
  checkEnds(2, "convert " + in("a.las"), {"output: is required"});
}

TEST_CASE("what is wrong with an option is said with its column, and nothing is written") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.las").string(), out = (folder / "out.las").string();
  writeCloud(in, street());
  const std::string convert = "convert " + in + " " + out + " ";
  checkEnds(2, convert + "--where 'z >'", {"--where: column 4: a value is expected after '>'; fields: x, y, z, red"});
  checkEnds(2, convert + "--where 'clasification == 2'", {"did you mean 'classification'?"});
  checkEnds(2, convert + "--set 'classification = 300'",
            {"--set: classification = 300 of point 0 is not a whole number"});
  checkEnds(2, convert + "--crop 0,0,0", {"--crop: '0,0,0' is not two corners of a box, as in 0,0,0:1.5,2,1"});
  checkEnds(2, convert + "--outliers=0", {"--outliers: '0,1' is not K or K,SIGMA"});
  checkEnds(2, convert + "--outliers=8,x", {"--outliers: '8,x' is not K or K,SIGMA, as in 8,1"});
  checkEnds(2, convert + "--outliers 8,1000", {"--outliers: '8,1000' is not K or K,SIGMA, as in 8,1: 1000 is not a"});
  checkEnds(2, convert + "--radius-outliers 4,-1", {"--radius-outliers: '4,-1' is not N,MM, as in 4,2.5: -1 is not a"});
  checkEnds(2, convert + "--radius-outliers 4", {"--radius-outliers: '4' is not N,MM, as in 4,2.5"});
  checkEnds(2, convert + "--subsample -1", {"--subsample"});
  checkEnds(1, convert + "--where 'z > 99'",
            {"--where keeps 0 of 900 points; nothing is left, and nothing is written"});
  checkEnds(1, convert + "--normals flip", {"has no normals to flip; use --normals estimate"});
  CHECK_FALSE(std::filesystem::exists(out));
  checkEnds(2, "touch water --backend cpu --where 'z > 1'", {"only the points of a file are selected and cleaned"});
}

TEST_CASE("the numbers of --outliers follow it with a blank or =, and may be left out") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.las").string();
  writeCloud(in, street());
  const auto converted = [&](const char* option, const char* name) {
    works("convert " + in + " " + option + " " + (folder / name).string());
    return contentOf(folder / name);
  };
  const std::string usual = converted("--outliers 8,1", "a.ply");
  CHECK(converted("--outliers=8,1", "b.ply") == usual);
  CHECK(converted("--outliers", "c.ply") == usual);
  CHECK(converted("--outliers 8", "d.ply") == usual);
}

TEST_CASE("a part of a model is in the hand as it was in the whole, in one command and after saving") {
  const ScratchFolder folder;
  const auto file = [&](const char* name) { return (folder / name).string(); };
  works("make sphere -n 4000 --size 40 -o " + file("m.ply"));
  works("convert " + file("m.ply") + " " + file("part.ply") + " --where 'z > 15' --json " + file("c.json"));
  CHECK(contentOf(folder / "part.ply").find("comment touch_scale: 2.5") != std::string::npos);
  checkEnds(0, "convert " + file("m.ply") + " " + file("part.npy") + " --where 'z > 15'",
            {"NPY cannot hold the up axis and the touch scale of the whole model"});
  const auto scaleOf = [&](const std::string& model) {
    works("touch " + model + " --backend cpu --duration 0.05 --json " + file("t.json"));
    return jsonOf(folder / "t.json")["mm_per_unit"].get<double>();
  };
  const double whole = scaleOf(file("m.ply"));
  CHECK(scaleOf(file("m.ply") + " --where 'z > 15'") == whole);
  CHECK(scaleOf(file("part.ply")) == near(whole, 1e-6));
}

TEST_CASE("touch, render and mesh prepare their model by the same options, and a log repeats it") {
  const ScratchFolder folder;
  const std::string model = (folder / "m.ply").string(), saved = (folder / "s.ply").string();
  const std::string log = (folder / "l").string();
  works("make sphere -n 4000 --size 40 -o " + model);
  checkEnds(0,
            "touch " + model + " --backend cpu --path builtin:press --edit push --penetration 3 --duration 0.3 " +
                "--where 'z > -5' --subsample 1.5 --save " + saved + " --log " + log,
            {"--where keeps", "--subsample keeps"});
  const PointCloud after = readCloud(saved).cloud;
  CHECK(after.size() < 3000);
  CHECK(std::ranges::all_of(after.positions, [](const Vec3& p) { return p.z > -6; }));
  works("replay " + log);
  checkEnds(1, "touch " + model + " --backend cpu --where 'z > 900'",
            {"--where keeps 0 of 4000 points; no point is left"});
}

TEST_CASE("a scan is leveled, its up axis stated, and its normals are flipped") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.ply").string(), out = (folder / "out.ply").string();
  PointCloud cloud;
  for (int i = 0; i < 4000; ++i) {  // a ground with y up, 10 degrees off, and a block on it
    const float u = 0.1f * static_cast<float>(i % 80), v = 0.1f * static_cast<float>(i / 80);
    const float h = i % 80 > 40 && i % 80 < 60 && i / 80 > 20 && i / 80 < 35 ? 1.f : 0.f;
    cloud.positions.emplace_back(u * 0.98481f - h * 0.17365f, h * 0.98481f + u * 0.17365f, v);
    cloud.normals.emplace_back(-0.17365f, 0.98481f, 0.f);
  }
  writeCloud(in, cloud);
  works("convert " + in + " " + out + " --level --up y");
  const PointCloud level = readCloud(out).cloud;
  CHECK(level.normals[5].z == near(1, 1e-4));
  std::vector<double> heights;
  for (const Vec3& p : level.positions) heights.push_back(p.z);
  std::ranges::sort(heights);
  CHECK(heights[3000] - heights[10] == within(0, 1e-3));
  CHECK(heights.back() - heights.front() == near(1, 1e-2));
  works("convert " + in + " " + out + " --force --up -z --normals flip");
  CHECK(contentOf(out).find("comment up: -z") != std::string::npos);
  const PointCloud flipped = readCloud(out).cloud;
  for (std::size_t i = 0; i < 4000; ++i) CHECK(flipped.normals[i] == -cloud.normals[i]);
  CHECK(flipped.positions == cloud.positions);
}

TEST_CASE("info shows the statistics of fields and expressions") {
  const ScratchFolder folder;
  const std::string in = (folder / "in.las").string(), json = (folder / "i.json").string();
  writeCloud(in, street());
  checkEnds(0, "info " + in + " --statistics classification --statistics 'z * 1000' --json " + json,
            {"classification: 900 values, 0 missing", "standard deviation", "percentiles"});
  const auto found = jsonOf(json)["statistics"];
  CHECK(found["classification"]["mean"] == 1.0);
  CHECK(found["classification"]["count"] == 900);
  CHECK(found["z * 1000"]["max"].get<double>() == near(30, 1e-12));
  CHECK(found["z * 1000"]["percentiles"]["50"].get<double>() == near(15, 1e-12));
  CHECK(found["classification"]["histogram"].size() == 20);
  checkEnds(2, "info " + in + " --statistics 'z >'", {"--statistics: column 3: a number is expected"});
  works("info " + in + " --json " + json);
  CHECK_FALSE(jsonOf(json).contains("statistics"));
}

}  // namespace palpate::select_app_test
