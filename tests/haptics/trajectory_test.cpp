#include "haptics/trajectory.hpp"

#include <doctest/doctest.h>

#include <algorithm>
#include <fstream>

#include "tests/content_of.hpp"
#include "tests/error_of.hpp"
#include "tests/near.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::trajectory_test {
namespace {

class TextFile {
 public:
  explicit TextFile(std::string_view text) : file_(folder_ / "hand.txt") {
    std::ofstream(file_, std::ios::binary) << text;
  }
  Trajectory read() const { return readTrajectory(file_); }
  /// The error's text, starting at the file's name.
  std::string error() const {
    const std::string text = errorOf<FileError>([&] { read(); });
    return text.substr(std::min(text.find("hand.txt"), text.size()));
  }

 private:
  ScratchFolder folder_;
  std::filesystem::path file_;
};

Trace someTrace() {
  Trace trace;
  for (int i = 0; i < 5; ++i)
    trace.rows.push_back({.time_s = 0.001 * i, .hip = {1.0 / 3 * i, -i, 1e-9 * i}, .force_N = {0, 0.1 * i, -0.3}});
  return trace;
}

}  // namespace

TEST_CASE("a trajectory is read by its column names, or by its number of columns") {
  for (const char* text :
       {"t_s,x,y,z,force_x,force_y,force_z\n0,1,2,3,4,5,6\n0.5,2,3,4,5,6,7\n", "0 1 2 3 4 5 6\n0.5 2 3 4 5 6 7\n",
        "# time position force\n0;1;2;3;4;5;6\n\n0.5; 2; 3; 4; 5; 6; 7\r\n",
        "time\tpx\tpy\tpz\tfx\tfy\tfz\n0\t1\t2\t3\t4\t5\t6\n0.5\t2\t3\t4\t5\t6\t7",
        "\xEF\xBB\xBFnote,fz,fy,fx,pos_z,pos_y,pos_x,t\n9,6,5,4,3,2,1,0\nabc,7,6,5,4,3,2,0.5\n"}) {
    const Trajectory trajectory = TextFile(text).read();
    REQUIRE(trajectory.samples.size() == 2);
    CHECK(trajectory.hasForces);
    CHECK(trajectory.samples[0].t_s == 0);
    CHECK(trajectory.samples[0].position == DVec3(1, 2, 3));
    CHECK(trajectory.samples[0].force_N == DVec3(4, 5, 6));
    CHECK(trajectory.samples[1].t_s == 0.5);
    CHECK(trajectory.samples[1].position == DVec3(2, 3, 4));
    CHECK(trajectory.samples[1].force_N == DVec3(5, 6, 7));
    CHECK(trajectory.path().at(0.25) == DVec3(1.5, 2.5, 3.5));
    CHECK(trajectory.force_N(0.25) == DVec3(4.5, 5.5, 6.5));
    CHECK(trajectory.force_N(9) == DVec3(5, 6, 7));
  }
  CHECK_FALSE(TextFile("0 1 2 3\n1 2 3 4\n").read().hasForces);
}

TEST_CASE("an invalid trajectory is refused with its line") {
  CHECK(TextFile("").error().find("the file is empty") != std::string::npos);
  CHECK(TextFile("t_s,x,y,z\n").error() == "hand.txt:1: no sample follows the names of the columns");
  CHECK(TextFile("x,y,z\n1,2,3\n").error().find("hand.txt:1: no column of times") == 0);
  CHECK(TextFile("t,a,b,c\n1,2,3,4\n").error().find("hand.txt:1: no columns of positions") == 0);
  CHECK(TextFile("0 1 2\n").error().find("hand.txt:1: 3 columns") == 0);
  CHECK(TextFile("0 1 2 3\n1 2 3\n").error() == "hand.txt:2: 3 columns; the lines before have 4");
  CHECK(TextFile("0 1 2 3\n1 2 x 3\n").error() == "hand.txt:2: 'x' is not a number");
  CHECK(TextFile("0 1 2 3\n1 2 nan 3\n").error() == "hand.txt:2: 'nan' is not finite");
  CHECK(TextFile("0 1 2 3\n0 1 2 3\n").error() == "hand.txt:2: times must ascend, and 0 follows 0");
  CHECK(TextFile("-1 1 2 3\n").error().find("hand.txt:1: the time is negative") == 0);
}

TEST_CASE("a written trajectory reads back to the same numbers") {
  const ScratchFolder folder;
  const Trace trace = someTrace();
  for (const char* name : {"out.csv", "out.txt"}) {
    writeTrajectory(folder / name, trace);
    const Trajectory back = readTrajectory(folder / name);
    REQUIRE(back.samples.size() == trace.rows.size());
    CHECK(back.hasForces);
    for (std::size_t i = 0; i < trace.rows.size(); ++i) {
      CHECK(back.samples[i].t_s == trace.rows[i].time_s);
      CHECK(back.samples[i].position == trace.rows[i].hip);
      CHECK(back.samples[i].force_N == trace.rows[i].force_N);
    }
    CHECK(compareForces(trace, back).worst_N < 1e-12);
    CHECK(compareForces(trace, back).ticks == 5);
  }
  CHECK(contentOf(folder / "out.txt").starts_with("0 0 0 0 0 0 -0.3\n"));
}

TEST_CASE("forces are compared if the trajectory has forces") {
  Trajectory recorded;
  recorded.hasForces = true;
  for (const double t : {0.001, 0.003}) recorded.samples.push_back({.t_s = t, .force_N = {0, 0, -0.3}});
  const ForceDifference difference = compareForces(someTrace(), recorded);
  CHECK(difference.ticks == 3);
  CHECK(difference.worst_N == near(0.3, 1e-6));
  CHECK(difference.rms_N == near(std::sqrt((0.01 + 0.04 + 0.09) / 3), 1e-6));
}

}  // namespace palpate::trajectory_test
