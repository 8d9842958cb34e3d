// Named pipes: read if a program writes to them, and refused with an error if none does.
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <thread>

#include "engine/core/clock.hpp"
#include "engine/core/job_stop.hpp"
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

TEST_CASE("waiting for a pipe can be stopped, with a silent writer and without one") {
  for (const bool isOpened : {false, true}) {
    CAPTURE(isOpened);
    const ScratchFolder folder;
    const std::filesystem::path pipe = folder / "a.xyz";
    REQUIRE(::mkfifo(pipe.c_str(), 0600) == 0);
    const int writer = isOpened ? ::open(pipe.c_str(), O_RDWR | O_CLOEXEC) : -1;
    if (isOpened) REQUIRE(::write(writer, "1 2 3\n4 5", 9) == 9);
    std::atomic<bool> stop = false;
    double took_s = 0;
    std::jthread reader([&] {
      const JobStopScope stops({.flag = &stop, .mayCut = true});
      CHECK_THROWS_AS(readCloud(pipe), Stopped);
    });
    ::usleep(300'000);
    const Stopwatch watch;
    stop = true;
    reader.join();
    took_s = watch.elapsed_s();
    CHECK(took_s < 0.2);
    if (isOpened) ::close(writer);
  }
}

}  // namespace palpate::test::pipe_linux_test
