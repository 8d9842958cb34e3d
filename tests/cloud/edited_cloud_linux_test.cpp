#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>

#include "engine/cloud/edited_cloud.hpp"
#include "engine/core/error.hpp"
#include "engine/io/ply_writer.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::edited_cloud_test {

TEST_CASE("saving to a full disk is an error, and leaves only the older file") {
  const ScratchFolder folder;
  PointCloud cloud;
  for (int i = 0; i < 100; ++i) cloud.positions.emplace_back(i, 0, 0);
  writePly(folder / "saved.ply", cloud);
  const std::string before = contentOf(folder / "saved.ply");
  const pid_t child = ::fork();
  if (child == 0) {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit tiny{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &tiny);
    auto points = statesOf(cloud);
    points[0].position.z = 9;
    try {
      writePly(folder / "saved.ply", editedCloud(cloud, points));
    } catch (const FileError& error) {
      const std::string text = error.what();
      const bool clear =
          text.find("saved.ply") != std::string::npos && text.find("limit of file sizes") != std::string::npos;
      ::_exit(clear ? 0 : 2);
    }
    ::_exit(3);
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(contentOf(folder / "saved.ply") == before);
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

}  // namespace palpate::edited_cloud_test
