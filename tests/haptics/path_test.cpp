#include "haptics/path.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "haptics/devices/path_device.hpp"
#include "tests/error_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::path_test {
namespace {

class CsvFile {
 public:
  explicit CsvFile(std::string_view text) : file_(folder_ / "way.csv") {
    std::ofstream(file_, std::ios::binary) << text;
  }
  Path read() const { return readPathCsv(file_); }
  /// The error's text, starting at the file's name.
  std::string error() const {
    const std::string text = errorOf<FileError>([&] { read(); });
    return text.substr(std::min(text.find("way.csv"), text.size()));
  }

 private:
  ScratchFolder folder_;
  std::filesystem::path file_;
};

}  // namespace

TEST_CASE("a path is linear between its keys and at rest outside them") {
  const Path path({{1, {0, 0, 0}}, {2, {10, 0, 0}}, {4, {10, 0, -4}}});
  CHECK(path.duration_s() == 4);
  CHECK(path.at(-1) == DVec3(0));
  CHECK(path.at(0.5) == DVec3(0));
  CHECK(path.at(1.25) == DVec3(2.5, 0, 0));
  CHECK(path.at(2) == DVec3(10, 0, 0));
  CHECK(path.at(3) == DVec3(10, 0, -2));
  CHECK(path.at(4) == DVec3(10, 0, -4));
  CHECK(path.at(1e9) == DVec3(10, 0, -4));
}

TEST_CASE("the path device plays its path and stores the force") {
  PathDevice device(Path({{0, {0, 0, 0}}, {1, {1, 2, 3}}}));
  CHECK(device.read(0.5).ok);
  CHECK(device.read(0.5).position == DVec3(0.5, 1, 1.5));
  CHECK(device.write({1, 2, 3}));
  CHECK(device.lastForce_N() == DVec3(1, 2, 3));
}

TEST_CASE("a CSV path is read with comments, blanks, any line ends and a byte order mark") {
  const Path path =
      CsvFile("\xEF\xBB\xBF# by hand\r\nt_s, x, y, z\r\n\r\n0,1,2,3\r\n  # half a second\n0.5 , -1e2,2.5,\t3").read();
  REQUIRE(path.keys().size() == 2);
  CHECK(path.keys()[0].position == DVec3(1, 2, 3));
  CHECK(path.keys()[1].t_s == 0.5);
  CHECK(path.keys()[1].position == DVec3(-100, 2.5, 3));
}

TEST_CASE("an invalid CSV path is refused with its line") {
  CHECK(CsvFile("").error() == "way.csv:1: the file is empty; it must begin with t_s,x,y,z");
  CHECK(CsvFile("# nothing\n\n").error() == "way.csv:2: the file is empty; it must begin with t_s,x,y,z");
  CHECK(CsvFile("0,1,2,3\n").error() == "way.csv:1: the header is missing; the first line must be t_s,x,y,z");
  CHECK(CsvFile("# a\nx,y,z,t_s\n").error().starts_with("way.csv:2: the header is missing"));
  CHECK(CsvFile("t_s,x,y,z\n").error().starts_with("way.csv:1: no row follows"));
  CHECK(CsvFile("t_s,x,y,z\n0,1,2\n").error() == "way.csv:2: 3 columns; a row has 4 (t_s,x,y,z)");
  CHECK(CsvFile("t_s,x,y,z\n0,0,0,0\n1,1,2,3,4\n").error() == "way.csv:3: 5 columns; a row has 4 (t_s,x,y,z)");
  CHECK(CsvFile("t_s,x,y,z\n\n0,1,two,3\n").error() == "way.csv:3: 'two' is not a number");
  CHECK(CsvFile("t_s,x,y,z\n0,1,,3\n").error() == "way.csv:2: '' is not a number");
  CHECK(CsvFile("t_s,x,y,z\n0,1,2,\n").error() == "way.csv:2: '' is not a number");
  CHECK(CsvFile("t_s,x,y,z\n0,1,2 3,4\n").error() == "way.csv:2: '2 3' is not a number");
  CHECK(CsvFile("t_s,x,y,z\n0,1,nan,3\n").error() == "way.csv:2: 'nan' is not finite");
  CHECK(CsvFile("t_s,x,y,z\n0,-inf,2,3\n").error() == "way.csv:2: '-inf' is not finite");
  CHECK(CsvFile("t_s,x,y,z\n0,1e999,2,3\n").error() == "way.csv:2: '1e999' is out of range");
  CHECK(CsvFile("t_s,x,y,z\n0,0,0,0\n0,1,1,1\n").error() == "way.csv:3: t_s must ascend, and 0 follows 0");
  CHECK(CsvFile("t_s,x,y,z\n1,0,0,0\n# back\n0.5,1,1,1\n").error() == "way.csv:4: t_s must ascend, and 0.5 follows 1");
  CHECK(CsvFile("t_s,x,y,z\n-1,0,0,0\n").error() == "way.csv:2: t_s is negative; a session begins at 0");
  CHECK(CsvFile("t_s,x,y,z\n" + std::string(100'000, '1')).error().starts_with("way.csv:2: the line is too long"));
  CHECK(CsvFile(std::string(64, '\0')).error().starts_with("way.csv:1: "));
}

TEST_CASE("a path that cannot be opened or is a folder is refused") {
  const ScratchFolder folder;
  CHECK_THROWS_AS(readPathCsv(folder / "missing.csv"), FileError);
  CHECK_THROWS_AS(readPathCsv(folder.path()), FileError);
}

}  // namespace palpate::path_test
