#include "engine/core/atomic_file.hpp"

#include <doctest/doctest.h>
#include <sys/resource.h>

#include <csignal>
#include <fstream>
#include <sstream>

#include "engine/core/error.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate {

namespace {
std::string contentOf(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}
}  // namespace

TEST_CASE("a file that is not committed leaves the older one as it was, and nothing else") {
  const ScratchFolder folder;
  const auto target = folder / "out.txt";
  std::ofstream(target) << "old";
  {
    AtomicFile file(target);
    file.write("new");
    CHECK(contentOf(target) == "old");
  }
  CHECK(contentOf(target) == "old");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a committed file stands under its name, alone") {
  const ScratchFolder folder;
  AtomicFile file(folder / "out.txt");
  file.write("new");
  file.commit();
  CHECK(contentOf(folder / "out.txt") == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("a folder that is not there is an error that names the file") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(AtomicFile(folder / "none" / "out.txt"), doctest::Contains("out.txt"), FileError);
}

TEST_CASE("a disk that takes no more is an error that names the file and keeps the older one") {
  const ScratchFolder folder;
  std::ofstream(folder / "out.txt") << "old";
  std::signal(SIGXFSZ, SIG_IGN);
  rlimit before{};
  getrlimit(RLIMIT_FSIZE, &before);
  const rlimit tiny{16, before.rlim_max};
  setrlimit(RLIMIT_FSIZE, &tiny);
  const auto writeTooMuch = [&] {
    AtomicFile file(folder / "out.txt");
    file.write(std::string(1 << 20, 'x'));
    file.commit();
  };
  CHECK_THROWS_WITH_AS(writeTooMuch(), doctest::Contains("out.txt"), FileError);
  setrlimit(RLIMIT_FSIZE, &before);
  CHECK(contentOf(folder / "out.txt") == "old");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

}  // namespace palpate
