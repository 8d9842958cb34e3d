#include "engine/core/atomic_file.hpp"

#include <doctest/doctest.h>

#include <fstream>

#include "engine/core/error.hpp"
#include "tests/content_of.hpp"
#include "tests/scratch_folder.hpp"

namespace palpate::atomic_file_test {

TEST_CASE("a file that is not committed leaves the older one unchanged and no temporary file") {
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

TEST_CASE("a committed file is written under its name and leaves no temporary file") {
  const ScratchFolder folder;
  AtomicFile file(folder / "out.txt");
  file.write("new");
  file.commit();
  CHECK(contentOf(folder / "out.txt") == "new");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 1);
}

TEST_CASE("an older file with a non-ASCII name can be kept beside the new one") {
  const ScratchFolder folder;
  const auto target = folder / u8"gr\u00f6\u00dfer \u70b9\u4e91.txt";
  for (const char* text : {"1", "2"}) {
    AtomicFile file(target);
    file.write(text);
    const std::filesystem::path kept = file.commitAndKeep();
    CHECK(kept.empty() == (*text == '1'));
    if (*text == '2') CHECK(contentOf(kept) == "1");
  }
  CHECK(contentOf(target) == "2");
  CHECK(std::distance(std::filesystem::directory_iterator(folder.path()), {}) == 2);
}

TEST_CASE("a missing folder is an error that names the file") {
  const ScratchFolder folder;
  CHECK_THROWS_WITH_AS(AtomicFile(folder / "none" / "out.txt"), doctest::Contains("out.txt"), FileError);
}

}  // namespace palpate::atomic_file_test
