// Clouds of no points, and folders that are none: said plainly, and nothing is written.
#include <filesystem>
#include <iterator>

#include "tests/apps/program.hpp"
#include "tests/says.hpp"

namespace palpate::empty_models_test {

TEST_CASE("a cloud of no points is said to have 0 points, and nothing is written or done with it") {
  const ScratchFolder folder;
  const auto in = [&](const char* name) { return (folder / name).string(); };
  std::ofstream(folder / "zero.ply") << "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\n"
                                        "property float z\nend_header\n";
  const Outcome info = palpate("info " + in("zero.ply") + " --json " + in("i.json"));
  CHECK(info.code == 0);
  CHECK_MESSAGE(says(info.text, "zero.ply: 0 points, PLY\n"), info.text);
  CHECK_FALSE(says(info.text, "nan"));
  CHECK_FALSE(says(info.text, "bounding box"));
  CHECK(jsonOf(in("i.json"))["points"] == 0);
  std::filesystem::remove(in("i.json"));
  const auto refused = [&](const std::string& arguments) {
    const Outcome outcome = palpate(arguments);
    CAPTURE(arguments);
    CHECK(outcome.code == 1);
    CHECK_MESSAGE(says(outcome.text, "zero.ply: contains no points; "), outcome.text);
  };
  const std::string zero = in("zero.ply");
  refused("render " + zero + " -o " + in("a.png"));
  refused("mesh " + zero + " -o " + in("a.ply"));
  refused("touch " + zero + " --backend cpu --trace " + in("a.csv") + " --picture " + in("b.png"));
  refused("convert " + zero + " " + in("b.ply"));
  refused("serve " + zero + " --name nothing --save " + in("c.ply"));
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), std::filesystem::directory_iterator()) == 1);
}

TEST_CASE("a file without a byte is an error in every format, and no cloud of no points is made") {
  const ScratchFolder folder;
  for (const char* name : {"a.ply", "a.las", "a.laz", "a.e57", "a.pcd", "a.npy", "a.npz", "a.xyz", "a.txt", "a.csv",
                           "a.pts", "a.ptx", "a.obj", "a.stl", "a.off", "a.gltf", "a.glb", "a.splat", "a.spz"}) {
    const std::string file = (folder / name).string();
    std::ofstream(file).close();
    for (const std::string& command : {"info " + file, "convert " + file + " " + (folder / "b.ply").string()}) {
      CAPTURE(command);
      checkEnds(1, command, {file + ": is empty; it contains no points"});
    }
  }
  checkEnds(2, "make sphere -n 0 -o " + (folder / "none.ply").string(),
            {"--points: 0 is not a whole number from 1 to"});
  CHECK_FALSE(std::filesystem::exists(folder / "none.ply"));
}

TEST_CASE("info on an unknown folder names the known kinds of folders and what in it can be read") {
  const ScratchFolder folder;
  const auto refused = [&](const std::string& what) { checkEnds(1, "info " + folder.path().string(), {what}); };
  refused("is not a folder of COLMAP, TUM, ScanNet, Redwood, Replica or 7-Scenes; name a file in it\n");
  std::ofstream(folder / "notes.doc") << "x";
  std::ofstream(folder / "scan.ply") << "ply\n";
  refused("name one of " + (folder / "scan.ply").string() + "\n");
  std::filesystem::create_directories(folder / "parts" / "a");
  std::ofstream(folder / "parts" / "a" / "points3D.txt") << "";
  refused("name one of " + (folder / "parts" / "a").string() + ", " + (folder / "scan.ply").string() + "\n");
  std::ofstream(folder / "metadata.yaml") << "rosbag2_bagfile_information:\n";
  refused("is a folder with a bag of ROS 2, which is not read; play it, and name ros:TOPIC as the model");
}

}  // namespace palpate::empty_models_test
