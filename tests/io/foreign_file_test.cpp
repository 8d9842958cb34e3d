// Files are identified by their content, whatever their name, and files of other kinds are refused by kind.
#include "tests/io/file_cases.hpp"
#include "tests/io/gltf_bytes.hpp"

namespace palpate::test::foreign_file_test {
namespace {

std::string kindOf(const std::string& name, const std::string& bytes) {
  const ScratchFolder folder;
  std::ofstream(folder / name, std::ios::binary) << bytes;
  const CloudFormat* format = cloudFormats().recognised(folder / name);
  return format ? std::string(format->name) : "unknown";
}

const std::string kPly =
    "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nend_header\n1 2 "
    "3\n";

}  // namespace

TEST_CASE("the content of a file determines its format, whatever its ending") {
  CHECK(kindOf("a.xyz", kPly) == "PLY");
  CHECK(kindOf("a", kPly) == "PLY");
  CHECK(kindOf("a.ply", "1 2 3\n4 5 6\n") == "XYZ");
  CHECK(kindOf("a.dat", "x,y,z\n1,2,3\n") == "XYZ");
  CHECK(kindOf("a.csv", "x,y,z\n1,2,3\n") == "CSV");
  CHECK(kindOf("a.txt", "v 1 2 3\nv 4 5 6\nf 1 2 1\n") == "OBJ");
  CHECK(kindOf("a.stl", "OFF\n3 1 0\n0 0 0\n") == "OFF");
  CHECK(kindOf("a.obj", "solid a\nfacet normal 0 0 1\n") == "STL");
  CHECK(kindOf("a.las", "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z\n") == "PCD");
  CHECK(kindOf("a.xyz", "2\n1 2 3 4\n1 2 3 4\n") == "PTS");
  CHECK(kindOf("a.pts", "1\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n1 1 1 1\n") == "PTX");
  CHECK(kindOf("a.bin", "ASTM-E57") == "E57");
  CHECK(kindOf("a.obj", gltfTriangle(true)) == "glTF");
  CHECK(kindOf("a.bin", gltfTriangle(false)) == "glTF");
  CHECK(kindOf("a.gz", "\x1f\x8b\x08") == "SPZ");
  CHECK(kindOf("a.dat", "Dear reader\n") == "unknown");
}

TEST_CASE("a file of another kind is refused with its kind and advice") {
  const std::string png = "\x89PNG\r\n\x1a\n";
  for (const char* name : {"a.png", "a.ply", "a.xyzzy"}) {
    CAPTURE(name);
    refuses(name, png + std::string(40, '\0'), ": is an image (PNG), not a 3D file");
  }
  refuses("a.jpg", "\xff\xd8\xff\xe0", ": is an image (JPEG), not a 3D file");
  refuses("a.ply", "%PDF-1.7\n", ": is a document (PDF), not a 3D file");
  refuses("a.zip", "PK\3\4" + std::string(26, '\0') + "a.txt", ": is an archive (ZIP); unpack it first");
  refuses("a.sog", "PK\3\4" + std::string(26, '\0') + "meta.json", "...is SOG...");
  refuses("a.ksplat", std::string(64, '\1'), "...export it as an uncompressed PLY...");
  refuses("a.drc", "DRACO\2\2", "...Draco...");
  refuses("a.fbx", "Kaydara FBX Binary", "...is FBX...");
  refuses("a.ply", "<!DOCTYPE html><html>", "...web page...");
  refuses("a.ply", std::string("\x7f") + "ELF", ": is a program, not a 3D file");
  refuses("a.mp4", std::string("\0\0\0\x18", 4) + "ftypmp42", ": is a video, not a 3D file");
  refuses("a.las", "", ": is empty; it contains no points");
  refuses("a.ply.gz", "\x1f\x8b\x08" + std::string(40, '\0'), "...byte...");
  refuses("a.dat", "Dear reader\n", ": is text, not a 3D file that can be read (it begins with 'Dear...");
  refuses("a.dat", std::string("\1\2\3\0\4", 5), ": is of an unknown kind...");
  CHECK(refusalOf("a.ply", "Dear reader\n").find("not a PLY file") == std::string::npos);
  CHECK_THROWS_WITH_AS(readCloud("-"), doctest::Contains("standard input"), FileError);
}

}  // namespace palpate::test::foreign_file_test
