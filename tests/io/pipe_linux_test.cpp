// Named pipes: read if a program writes to them, and refused with an error if none does.
#include <sys/stat.h>

#include <thread>

#include "tests/io/file_cases.hpp"

namespace palpate::test::pipe_linux_test {

// ctest: waits
TEST_CASE("a pipe without a writer is refused with an error, and one with a slow writer is read") {
  const ScratchFolder folder;
  const std::filesystem::path pipe = folder / "a.xyz";
  REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
  CHECK_THROWS_WITH_AS(readCloud(pipe), doctest::Contains("is a pipe to which no program has written for 2 s"),
                       FileError);
  std::jthread writer([&] { std::ofstream(pipe) << "1 2 3\n4 5 6\n"; });
  CHECK(readCloud(pipe).cloud.size() == 2);
}

}  // namespace palpate::test::pipe_linux_test
