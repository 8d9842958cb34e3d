// Columns of text as programs, scanners and surveyors write them: without names, with names of any kind, with words,
// dates and colours as on the web among them.
#include <doctest/doctest.h>

#include <array>
#include <cmath>

#include "engine/cloud/length_unit.hpp"
#include "tests/io/file_cases.hpp"
#include "tests/near.hpp"

namespace palpate::test::text_columns_test {

namespace {

/// Rows of the sheet; `row` adds what is behind the position.
template <class Row>
std::string sheetRows(const std::string& between, Row&& row, const std::string& names = "") {
  std::string text = names;
  for (int k = 0; k < Sheet::kPoints; ++k) {
    const DVec3 p = Sheet::place(k);
    std::string line = fmt::format("{:.8f} {:.8f} {:.8f}", p.x, p.y, p.z);
    if (const std::string more = row(k); !more.empty()) line += ' ' + more;
    for (const char c : line) text += c == ' ' ? between : std::string(1, c);
    text += '\n';
  }
  return text;
}

std::string bytes(int k) {
  const auto [r, g, b] = Sheet::color(k);
  return fmt::format("{} {} {}", r, g, b);
}
std::string shares(int k) {
  const auto [r, g, b] = Sheet::color(k);
  return fmt::format("{:.6f} {:.6f} {:.6f}", r / 255.0, g / 255.0, b / 255.0);
}
std::string normal(int k) {
  const double angle = 0.3 * k;
  return fmt::format("{:.6f} {:.6f} {:.6f}", 0.6 * std::cos(angle), 0.6 * std::sin(angle), 0.8);
}
std::string real(int k) { return fmt::format("{:.6f}", -3.5 + 7.25 * k); }
std::string label(int k) { return fmt::format("{}", k % 13); }
std::string level(int k) { return fmt::format("{}", (37 * k) % 256); }

struct Nameless {
  const char* program;
  const char* file;
  std::string text;
  const char* assumed;  ///< null: refused
};

std::string checked(const Nameless& one) {
  CAPTURE(one.program);
  CAPTURE(one.file);
  const StoredCloud stored = readingFile(one.file, one.text);
  checkSheetPlaces(stored.cloud);
  if (stored.cloud.hasColors()) checkSheetColors(stored.cloud);
  for (std::size_t i = 0; i < stored.cloud.normals.size(); ++i) CHECK(stored.cloud.normals[i].z == near(0.8f, 1e-3));
  return stored.assumed;
}

std::string numbered(int first) {
  std::string text;
  for (int k = 0; k < Sheet::kPoints; ++k)
    text += fmt::format("{} {} {} {:.3f}\n", first + k, 4400 + k % 5, 500 + k / 5, 12 + 0.1 * (k % 5) * (k / 5));
  return text;
}

bool isSaid(const StoredCloud& stored, const std::string& words) {
  return std::ranges::any_of(stored.lost, [&](const std::string& what) { return what.find(words) != what.npos; });
}

}  // namespace

TEST_CASE("of 20 nameless text files as CloudCompare, MeshLab and S3DIS write them 17 are read, none wrongly") {
  const auto none = [](int) { return std::string(); };
  const auto both = [](auto first, auto second) { return [=](int k) { return first(k) + ' ' + second(k); }; };
  const std::vector<Nameless> files{
      {"CloudCompare", "a.asc", sheetRows(" ", none), ""},
      {"CloudCompare", "a.csv", sheetRows(",", none), ""},
      {"CloudCompare", "a.txt", sheetRows(";", none), ""},
      {"CloudCompare", "a.txt", sheetRows("\t", none, "20\n"), ""},
      {"CloudCompare", "a.txt", sheetRows(" ", real), "x,y,z,intensity"},
      {"CloudCompare", "a.txt", sheetRows(" ", bytes), "x,y,z,red,green,blue"},
      {"CloudCompare", "a.txt", sheetRows(" ", shares), "x,y,z,red,green,blue"},
      {"CloudCompare", "a.txt", sheetRows(",", both(bytes, real)), "x,y,z,red,green,blue,scalar"},
      {"CloudCompare", "a.asc", sheetRows(" ", both(bytes, label)), "x,y,z,red,green,blue,scalar"},
      {"CloudCompare", "a.asc", sheetRows(" ", normal), "x,y,z,nx,ny,nz"},
      {"CloudCompare", "a.asc", sheetRows(" ", both(real, normal)), "x,y,z,intensity,nx,ny,nz"},
      {"CloudCompare", "a.asc", sheetRows(" ", both(bytes, normal)), "x,y,z,red,green,blue,nx,ny,nz"},
      {"CloudCompare", "a.asc", sheetRows(" ", both(both(bytes, real), normal)),
       "x,y,z,red,green,blue,scalar,nx,ny,nz"},
      {"CloudCompare, two scalars", "a.asc", sheetRows(" ", both(real, label)), nullptr},
      {"MeshLab", "a.xyz", sheetRows(" ", none), ""},
      {"MeshLab", "a.xyz", sheetRows(" ", normal), "x,y,z,nx,ny,nz"},
      {"MeshLab", "a.pts", sheetRows(" ", both(level, bytes), "20\n"), "x,y,z,intensity,red,green,blue"},
      {"S3DIS", "office_1.txt", sheetRows(" ", bytes), "x,y,z,red,green,blue"},
      {"S3DIS with classes", "office_1.txt", sheetRows(" ", both(bytes, label)), "x,y,z,red,green,blue,scalar"},
      {"a scan with intensities, or a scalar", "a.txt", sheetRows(" ", both(level, bytes)), nullptr},
  };
  REQUIRE(files.size() == 20);
  int read = 0;
  for (const Nameless& one : files) {
    CAPTURE(one.program);
    if (one.assumed) {
      CHECK(checked(one) == one.assumed);
      ++read;
    } else {
      refuses(one.file, one.text, "...--columns does...");
    }
  }
  CHECK(read >= 17);
}

TEST_CASE("nameless columns that may mean two things are refused with both") {
  refuses(
      "a.txt", sheetRows(" ", [](int k) { return level(k) + ' ' + bytes(k); }),
      ":1: columns 4 to 7 have no names, and may be x,y,z,red,green,blue,scalar or x,y,z,intensity,red,green,blue...");
  refuses("a.txt", numbered(101),
          ":1: column 1 counts up by one and may number the points: number,x,y,z or x,y,z,intensity...");
  const StoredCloud named = readingFile("a.txt", numbered(101), {.columns = {"number", "x", "y", "z"}});
  CHECK(named.cloud.fileCoordinates(0) == DVec3(4400, 500, 12));
  CHECK(named.cloud.extra.at(0).name == "number");
  refuses("a.txt", "1,2,3,TREE\n", ":1: column 4 of a point without names has words like 'TREE'...");
  refuses("a.txt", "1,20,30,4,TREE\n2,21,31,5,EP\n", ":1: column 5 of a point without names has words like...");
  const StoredCloud survey =
      readingFile("a.txt", "1,20,30,4,TREE\n2,21,31,5,old oak\n", {.columns = {"number", "y", "x", "z", "what"}});
  CHECK(survey.cloud.fileCoordinates(1) == DVec3(31, 21, 5));
  CHECK(isSaid(survey, "'what', which has words like 'TREE'"));
}

TEST_CASE("commas between thousands are read, and commas that may be decimal ones or thousands are refused") {
  const auto second = [](const char* name, const std::string& text) {
    return readingFile(name, text).cloud.fileCoordinates(1);
  };
  const DVec3 there(412051, 5231101, 89);
  CHECK(second("a.txt", "412,050 5,231,100 88\n412,051 5,231,101 89\n") == there);
  CHECK(second("a.csv", "x;y;z\n412,050;5,231,100;88\n412,051;5,231,101;89\n") == there);
  CHECK(second("a.csv", "x,y,z\n\"412,050.0\",\"5,231,100.0\",88\n\"412,051.0\",\"5,231,101.0\",89\n") == there);
  CHECK(second("a.txt", "-412,050.5 5,231,100 8\n-1,412,050.5 5,231,101 9\n") == DVec3(-1412050.5, 5231101, 9));
  refuses("a.txt", "412,050 231,100 88\n412,051 231,101 89\n", ":1: commas that may be decimal ones...");
  CHECK(second("a.txt", "412,050 231,100 88\n0,125 231,101 89\n") == DVec3(0.125, 231.101, 89));
  CHECK(second("a.txt", "412,050 231,100 88\n1412,05 231,101 89\n") == DVec3(1412.05, 231.101, 89));
  CHECK(second("a.csv", "what;x;y;z\ntree 1;1,5;2,5;3,5\ntree 2;4,5;5,5;6,5\n") == DVec3(4.5, 5.5, 6.5));
}

TEST_CASE("quoted numbers, and points between thousands, are read as they stand") {
  const auto second = [](const std::string& text) { return readingFile("a.csv", text).cloud.fileCoordinates(1); };
  CHECK(second("x,y,z\n\"1,234,567\",\"5,399,957\",\"292\"\n\"1,234,568\",\"5,399,957\",\"292\"\n") ==
        DVec3(1234568, 5399957, 292));
  CHECK(second("x,y,z\n\"1,234,567\",\"12,345\",\"2\"\n\"1,234,568\",\"12,346\",\"3\"\n") == DVec3(1234568, 12346, 3));
  CHECK(second("x;y;z\n\"1,5\";\"2,5\";\"3,5\"\n\"4,25\";\"5\";\"6\"\n") == DVec3(4.25, 5, 6));
  CHECK(second("1.999,5;2.000,25;3,5\n1.998,5;2.000,5;3,75\n") == DVec3(1998.5, 2000.5, 3.75));
  CHECK(second("x;y;z\n1.234.567,89;5.000.123,25;12,5\n1.234.568,89;5.000.124;1.013\n") ==
        DVec3(1234568.89, 5000124, 1013));
  CHECK(second("999,5;2;3,5\n1.001,5;2;3\n") == DVec3(1001.5, 2, 3));
  for (const char* text : {"x,y,z\n\"12,345\",\"1,000\",\"1,500\"\n\"12,346\",\"1,001\",\"1,501\"\n",
                           "x;y;z\n1,234;2,345;3,456\n1,235;2,346;3,457\n"})
    refuses("a.csv", text, ":2: commas that may be decimal ones...");
  refuses("a.csv", "x;y;z\n1,234;2;3\n1,234,567;2;3\n",
          ":3: found '1,234,567' where the commas of other numbers may be decimal ones...");
  refuses("a.csv", "x;y;z\n1,234,567;2;3\n1,5;2;3\n",
          ":3: found '1,5' where the commas of other numbers stand between thousands...");
  refuses("a.csv", "x;y;z\n1,5;2;3\n1.234;2;3\n", ":3: found '1.234' where...");
  const StoredCloud names = readingFile("a.csv", "\"x\",\"y\",\"z\",\"name\"\n\"1\",\"2\",\"3\",\"c \"\"q\"\"\"\n");
  CHECK(isSaid(names, "'name', which has words like 'c \"q\"'"));
}

TEST_CASE("axes of different units become those of x, and German names are known") {
  const StoredCloud mixed = readingFile("a.csv", "x (m);y (m);z (mm)\n-25.5;-42.25;-7919.5\n");
  CHECK(mixed.cloud.fileCoordinates(0) == DVec3(-25.5, -42.25, -7.9195));
  CHECK(unitSaidIn(mixed.cloud.storedAs.comments) == LengthUnit::m);
  const PointCloud german =
      readingFile("a.csv", "Punkt;Rechts;Hoch;Höhe;Rot;Grün;Blau\nP1;3500000,12;5400000,5;100,5;9;8;7\n").cloud;
  CHECK(german.fileCoordinates(0) == DVec3(3500000.12, 5400000.5, 100.5));
  CHECK(german.colors.at(0) == std::array<std::uint8_t, 4>{9, 8, 7, 255});
  const StoredCloud dates = readingFile("a.csv", "time,x,y,z\n2024-01-01 10:00:00,1,2,3\n2024-01-01 10:00:01,4,5,6\n");
  CHECK(dates.cloud.fileCoordinates(1) == DVec3(4, 5, 6));
  refuses("a.csv", "x,y,z\nP1,P2,P3\n", ":2: found 'P1', expected a point of the columns x,y,z");
}

TEST_CASE("lines of titles and separators may precede the names, and a DOS end sign follows the points") {
  const StoredCloud titled = readingFile("a.txt", "Survey of the old quarry\nby hand\n\nX Y Z\n1 2 3\n4 5 6\n");
  CHECK(titled.cloud.size() == 2);
  CHECK(isSaid(titled, "2 title lines"));
  CHECK(readingFile("a.txt", "Survey of the old quarry\n1 2 3\n").cloud.size() == 1);
  refuses("a.txt", "one two three\n1 2 3\n", ":1: found 'one', expected the coordinates...");
  for (const char* line : {"sep=;\n", "\"sep=;\"\n", "sep=;\r\n"})
    CHECK(readingFile("a.csv", std::string(line) + "x;y;z\n1,5;2;3\n").cloud.fileCoordinates(0) == DVec3(1.5, 2, 3));
  for (const char* text : {"1 2 3\r\n4 5 6\r\n\x1a", "1 2 3\n4 5 6\x1a", "x y z\n1 2 3\n4 5 6\n\x1a"})
    CHECK(readingFile("a.txt", text).cloud.size() == 2);
  CHECK(readingFile("a.obj", "v 1 2 3\r\nv 4 5 6\r\nv 7 8 9\r\n\x1a").cloud.size() == 3);
}

TEST_CASE("words and dates in carried columns are named, and positions still need numbers") {
  const std::string rows = "oak 1,2024-05-01T10:00:00Z,1,2,3,7\noak 2,2024-05-01T10:00:01Z,4,5,6,8\n";
  const StoredCloud stored = readingFile("a.csv", "name,DateTime,X,Y,Z,GPSTime\n" + rows);
  REQUIRE(stored.cloud.size() == 2);
  CHECK(stored.cloud.fileCoordinates(1) == DVec3(4, 5, 6));
  REQUIRE(stored.cloud.extra.size() == 1);
  CHECK(stored.cloud.extra[0].name == "GPSTime");
  CHECK(isSaid(stored, "'name', which has words like 'oak 1'"));
  CHECK(isSaid(stored, "'DateTime', which has words like '2024-05-01T10:00:00Z'"));
  const StoredCloud few = readingFile("a.csv", "x,y,z,q\n1,2,3,4\n1,2,4,bad\n1,2,5,-\n");
  REQUIRE(few.cloud.extra.size() == 1);
  CHECK(few.lost == std::vector<std::string>{"1 word in the column 'q', which count as missing (line 3: 'bad')"});
  refuses("a.csv", "name,x,y,z\noak,1,five,3\n", ":2: ...");
  refuses("a.csv", "name,x,y,z\noak,1,2,3\noak,1,five,3\n", ":3: found 'five' for 'y', expected a number");
  const StoredCloud tabs = readingFile("a.txt", "Point name\tX\tY\tZ\nold oak\t1\t2\t3\ntree\t4\t5\t6\n");
  CHECK(tabs.cloud.fileCoordinates(0) == DVec3(1, 2, 3));
  CHECK(isSaid(tabs, "'Point_name', which has words like 'old oak'"));
}

TEST_CASE("colours as on the web are read from a column with and without names") {
  const auto hex = [](int k) {
    const auto [r, g, b] = Sheet::color(k);
    return fmt::format("#{:02x}{:02X}{:02x}", r, g, b);
  };
  std::string before, named = "colour,x,y,z\n", behind;
  for (int k = 0; k < Sheet::kPoints; ++k) {
    const DVec3 p = Sheet::place(k);
    before += fmt::format("{},{},{},{}\n", hex(k), p.x, p.y, p.z);
    behind += fmt::format("{} {} {} {}\n", p.x, p.y, p.z, hex(k));
  }
  for (const std::string& text : {before, named + before, behind, "# a remark\n" + before}) {
    const PointCloud cloud = readingFile("a.csv", text).cloud;
    checkSheetPlaces(cloud);
    checkSheetColors(cloud);
  }
  refuses("a.csv", "x,y,z,colour\n1,2,3,#102030\n1,2,3,red\n", ":3: found 'red', expected a colour like #ff8000");
}

TEST_CASE("names of surveyors, VeloView, Ouster and spreadsheets are recognized, with their units") {
  struct Names {
    const char* names;
    LengthUnit unit;
  };
  for (const auto& [names, unit] : {Names{"X_mm,Y_mm,Z_mm", LengthUnit::mm},
                                    {"X [cm],Y [cm],Z [cm]", LengthUnit::cm},
                                    {"X [m] Y [m] Z [m]", LengthUnit::unknown},
                                    {"E,N,H", LengthUnit::unknown},
                                    {"Easting (ft),Northing (ft),Elev (ft)", LengthUnit::foot},
                                    {"Rechtswert;Hochwert;Elevation", LengthUnit::unknown},
                                    {"# X1 (mm), Y1 (mm), Z1 (mm)", LengthUnit::mm},
                                    {"X Coordinate,Y Coordinate,Z Coordinate", LengthUnit::unknown},
                                    {"\"Points_m_XYZ:0\",\"Points_m_XYZ:1\",\"Points_m_XYZ:2\"", LengthUnit::m}}) {
    CAPTURE(names);
    const PointCloud cloud = readingFile("a.csv", std::string(names) + "\n1,2,3\n").cloud;
    CHECK(cloud.fileCoordinates(0) == DVec3(1, 2, 3));
    CHECK(cloud.extra.empty());
    CHECK(unitSaidIn(cloud.storedAs.comments) == unit);
  }
  for (const char* names : {"latitude,longitude,height", "Lat Lon Alt", "lon_deg;lat_deg;z"})
    refuses("a.csv", std::string(names) + "\n48.1,11.5,500\n",
            ":1: contains latitudes and longitudes in degrees, not lengths...");
  const StoredCloud latin = readingFile("a.csv", "x,y,z,h\xf6he\n1,2,3,4\n");
  CHECK(latin.cloud.extra.at(0).name == "h\xc3\xb6he");
}

TEST_CASE("grids, molecules, volumes and indices of tiles are refused with what they are and what to do") {
  struct Foreign {
    const char *name, *bytes, *what;
  };
  for (const auto& [name, bytes, what] :
       {Foreign{"a.asc", "ncols 2\nnrows 2\nxllcorner 0\nyllcorner 0\ncellsize 1\n1 2\n3 4\n", "(ESRI ASCII)"},
        {"a.grd", "DSAA\n2 2\n0 1\n0 1\n0 1\n1 2\n3 4\n", "(Surfer)"},
        {"ept.json", "{\"hierarchyType\": \"json\", \"points\": 3}", "Entwine tree (EPT)"},
        {"metadata.json", "{\"version\": \"2.0\", \"hierarchy\": {}, \"spacing\": 1}", "Potree"},
        {"cloud.js", "{\"octreeDir\": \"data\", \"spacing\": 1}", "Potree"},
        {"tileset.json", "{\"root\": {}, \"geometricError\": 1}", "3D Tiles"},
        {"a.pnts", "pnts\1\0\0\0", "3D Tiles"},
        {"a.pdb", "HEADER    HYDROLASE\nATOM      1  N   VAL A   1       1.0 2.0 3.0\n", "molecule (PDB)"},
        {"b.pdb", "ATOM      1  N   VAL A   1       1.0 2.0 3.0\n", "molecule (PDB)"},
        {"a.nrrd", "NRRD0004\ntype: float\n", "volume (NRRD)"}}) {
    const std::string said = refusalOf(name, bytes);
    CAPTURE(said);
    CHECK(said.find(what) != said.npos);
    CHECK(
        ((said.find("export") != said.npos) || said.find("write") != said.npos || said.find("read the") != said.npos));
  }
}

}  // namespace palpate::test::text_columns_test
