// palpate mesh, and render --mode mesh: output files, messages and errors.
#include <fstream>

#include "tests/apps/program.hpp"
#include "tests/near.hpp"

namespace palpate::mesh_test {

TEST_CASE("mesh writes a closed mesh of a closed shape, and reports it as closed") {
  const ScratchFolder folder;
  const std::string cloud = (folder / "torus.ply").string(), mesh = (folder / "mesh.ply").string();
  works("make torus -n 20000 -o " + cloud);
  works("mesh " + cloud + " -o " + mesh + " --resolution 50 --json " + (folder / "m.json").string());
  const auto said = jsonOf(folder / "m.json");
  CHECK(said["closed"] == true);
  CHECK(said["euler"] == 0);
  CHECK(said["parts"] == 1);
  CHECK(said["border_edges"] == 0);
  CHECK(said["flat_triangles"] == 0);
  CHECK(said["volume_mm3"].get<double>() == near(155'446, 0.01));
  CHECK(said["gpu_bytes"].get<double>() <= 1.1 * said["gpu_bytes_predicted"].get<double>());
  CHECK(contentOf(mesh).substr(0, 4) == "ply\n");
  works("info " + mesh + " --json " + (folder / "i.json").string());
  const auto info = jsonOf(folder / "i.json");
  CHECK(info["elements"]["vertex"] == said["vertices"]);
  CHECK(info["elements"]["face"] == said["triangles"]);
  CHECK(info["normals"] == true);
}

TEST_CASE("mesh writes the same mesh each time, also in ASCII") {
  const ScratchFolder folder;
  const std::string cloud = (folder / "c.ply").string();
  works("make bumpy-sphere -n 8000 -o " + cloud);
  for (const char* name : {"a.ply", "b.ply"})
    works("mesh " + cloud + " --resolution 24 -o " + (folder / name).string());
  CHECK(contentOf(folder / "a.ply") == contentOf(folder / "b.ply"));
  works("mesh " + cloud + " --resolution 24 --ascii -o " + (folder / "t.ply").string());
  CHECK(contentOf(folder / "t.ply").find("format ascii") != std::string::npos);
}

TEST_CASE("mesh refuses what it cannot do with a reason, and leaves no file") {
  const ScratchFolder folder;
  const std::string cloud = (folder / "c.ply").string(), out = (folder / "m.ply").string();
  works("make sphere -n 4000 -o " + cloud);
  for (const char* resolution : {"0", "-4", "2049", "many"}) {
    checkEnds(2, "mesh " + cloud + " -o " + out + " --resolution " + resolution, {"--resolution"});
  }
  CHECK(palpate("mesh " + cloud + " -o " + out + " --surface potato").code == 2);
  CHECK(palpate("mesh " + cloud + " -o " + out + " --radius wide").code == 2);
  // A support radius of four spacings covers many blocks of such small cells.
  checkEnds(1, "mesh " + cloud + " -o " + out + " --resolution 2048 --radius 30", {"resolution"});
  std::ofstream(folder / "none.ply") << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                                        "property float z\nend_header\n";
  checkEnds(1, "mesh " + (folder / "none.ply").string() + " -o " + out, {"no points"});
  works("make sphere -n 1 -o " + (folder / "one.ply").string());
  checkEnds(1, "mesh " + (folder / "one.ply").string() + " -o " + out, {"too few for a surface"});
  CHECK_FALSE(std::filesystem::exists(out));
  std::ofstream(folder / "two.xyz") << "0 0 0\n1 0 0\n";
  checkEnds(1, "mesh " + (folder / "two.xyz").string() + " -o " + out,
            {"too few for a surface, which needs at least 25"});
  CHECK(palpate("mesh " + cloud + " -o /nowhere/m.ply").code == 1);
}

TEST_CASE("render draws the mesh of a model") {
  const ScratchFolder folder;
  const std::string cloud = (folder / "c.ply").string();
  works("make sphere -n 5000 -o " + cloud);
  works("render " + cloud + " --mode mesh --resolution 32 --size 160x120 -o " + (folder / "mesh.png").string());
  std::ofstream(folder / "one.xyz") << "1 2 3\n";
  const std::string one = (folder / "one.xyz").string();
  checkEnds(1, "render " + one + " --mode mesh -o " + (folder / "one.png").string(),
            {"one.xyz: 1 point: too few for a surface, so there is no mesh"});
  CHECK_FALSE(std::filesystem::exists(folder / "one.png"));
  CHECK(std::filesystem::file_size(folder / "mesh.png") > 3000);
  CHECK(palpate("render " + cloud + " --mode clay -o " + (folder / "x.png").string()).code == 2);
}

TEST_CASE("bench mesh measures each pass and an edit, and compares the mesh with shapes") {
  if (isLeftOut("bench")) {
    MESSAGE("skipped: this palpate was built without PALPATE_STUDY");
    return;
  }
  const ScratchFolder folder;
  const Outcome outcome =
      palpate("bench mesh --sizes 5000 --resolution 16 32 --repeat 2 --truth-points 5000 --shapes sphere,cube --json " +
              (folder / "b.json").string());
  REQUIRE_MESSAGE(outcome.code == 0, outcome.text);
  const auto mesh = jsonOf(folder / "b.json")["mesh"];
  REQUIRE(mesh["records"].size() == 2);
  for (const auto& record : mesh["records"]) {
    for (const char* pass : {"index", "list", "field", "classify", "scan", "vertices", "triangles", "in all"})
      CHECK(record["gpu_us"][pass]["n"] == 2);
    CHECK(record["gpu_bytes"] > 0);
    CHECK(record["edit"]["treated_blocks"] > 0);
    CHECK(record["edit"]["treated_blocks"] <= record["blocks"]);
  }
  REQUIRE(mesh["truth"].size() == 4);
  for (const auto& judgement : mesh["truth"]) CHECK(judgement["closed"] == true);
  CHECK(mesh["truth"][1]["distance_spacings"]["rms"] < 0.01);
  CHECK(mesh["truth"][1]["normal_deg"]["mean"] < 0.1);
  CHECK(palpate("bench mesh step --sizes 2000").code == 2);
  CHECK(palpate("bench mesh --sizes 2000 --backend cpu").code == 2);
}

}  // namespace palpate::mesh_test
