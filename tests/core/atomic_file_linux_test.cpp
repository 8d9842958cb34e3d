// Links, files of other users and full disks.
#include <doctest/doctest.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <fstream>

#include "engine/core/atomic_file.hpp"
#include "engine/core/error.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::atomic_file_test {

TEST_CASE("repeated saves keep each older file under a new name, and none is lost") {
  const ScratchFolder folder;
  const auto target = folder / "out.txt";
  const auto save = [&](const char* text) {
    AtomicFile file(target);
    file.write(text);
    return file.commitAndKeep();
  };
  CHECK(AtomicFile::nameToKeep(target).empty());
  CHECK(save("1").empty());
  CHECK(AtomicFile::nameToKeep(target) == folder / "out.txt.bak");
  CHECK(save("2") == folder / "out.txt.bak");
  std::filesystem::create_symlink("nowhere", folder / "out.txt.bak2");  // taken, too
  CHECK(AtomicFile::nameToKeep(target) == folder / "out.txt.bak3");
  CHECK(save("3") == folder / "out.txt.bak3");
  CHECK(contentOf(target) == "3");
  CHECK(contentOf(folder / "out.txt.bak") == "1");
  CHECK(contentOf(folder / "out.txt.bak3") == "2");
  std::ofstream(target, std::ios::app) << "+";  // the kept file is not a hard link to the target
  CHECK(contentOf(folder / "out.txt.bak3") == "2");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 4);
}

TEST_CASE("saving through a link keeps the older target file, and the link stays") {
  const ScratchFolder folder;
  std::ofstream(folder / "real.txt") << "old";
  std::filesystem::create_symlink("real.txt", folder / "link.txt");
  AtomicFile file(folder / "link.txt");
  file.write("new");
  CHECK(file.commitAndKeep() == std::filesystem::canonical(folder.path()) / "real.txt.bak");
  CHECK(std::filesystem::is_symlink(folder / "link.txt"));
  CHECK(contentOf(folder / "link.txt") == "new");
  CHECK(contentOf(folder / "real.txt.bak") == "old");
}

TEST_CASE("a file of another user, which cannot be hard-linked, is kept as a copy") {
  if (::geteuid() != 0) {
    MESSAGE("skipped: only root can create a file of another user");
    return;
  }
  const ScratchFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::all);
  const auto target = folder / "out.txt";
  std::ofstream(target) << "old";
  std::filesystem::permissions(target, std::filesystem::perms(0444));
  const pid_t child = ::fork();
  if (child == 0) {
    constexpr uid_t kNobody = 65534;
    if (::setuid(kNobody) != 0) ::_exit(2);
    try {
      AtomicFile file(target);
      file.write("new");
      ::_exit(file.commitAndKeep() == std::filesystem::canonical(folder.path()) / "out.txt.bak" ? 0 : 3);
    } catch (const FileError&) {
      ::_exit(4);
    }
  }
  int status = 0;
  REQUIRE(::waitpid(child, &status, 0) == child);
  CHECK(WIFEXITED(status));
  CHECK(WEXITSTATUS(status) == 0);
  CHECK(contentOf(target) == "new");
  CHECK(contentOf(folder / "out.txt.bak") == "old");
  CHECK(std::filesystem::hard_link_count(folder / "out.txt.bak") == 1);
}

TEST_CASE("a full disk is an error that names the file and leaves the older file unchanged") {
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
  const auto keepTooMuch = [&] {
    AtomicFile file(folder / "out.txt");
    file.write(std::string(64, 'x'));  // in memory until the commit
    file.commitAndKeep();
  };
  CHECK_THROWS_WITH_AS(keepTooMuch(), doctest::Contains("out.txt"), FileError);
  setrlimit(RLIMIT_FSIZE, &before);
  CHECK(contentOf(folder / "out.txt") == "old");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

}  // namespace palpate::atomic_file_test
