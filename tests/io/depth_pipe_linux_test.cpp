// A pipe whose writer is slow, or never writes again.
#include <doctest/doctest.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <future>
#include <string>
#include <thread>

#include "engine/io/depth_pipe.hpp"

namespace palpate::depth_pipe_test {

namespace {

class Pipe {
 public:
  Pipe() { REQUIRE(::pipe(ends_.data()) == 0); }
  ~Pipe() {
    ::close(ends_[0]);
    if (isOpen_) ::close(ends_[1]);
  }
  int reader() const { return ends_[0]; }
  void write(const std::string& bytes) const {
    CHECK(::write(ends_[1], bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  }
  void end() {
    ::close(ends_[1]);
    isOpen_ = false;
  }

 private:
  std::array<int, 2> ends_{};
  bool isOpen_ = true;
};

constexpr const char* kHead =
    R"({"width": 2, "height": 1, "fx": 1, "fy": 1, "cx": 0, "cy": 0, "depth_scale": 1000, "format": "z16"})"
    "\n";

}  // namespace

TEST_CASE("a depth frame is read from a pipe in pieces of any size") {
  Pipe pipe;
  pipe.write(kHead);
  DepthPipe stream(pipe.reader(), "input");
  const std::string bytes = std::string("frame 0.5\n") + std::string("\1\0\2\0", 4);
  auto read = std::async(std::launch::async, [&] {
    DepthFrame frame;
    CHECK(stream.next(frame));
    return frame.depth_m;
  });
  for (const char byte : bytes) {
    pipe.write(std::string(1, byte));
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  CHECK(read.get() == std::vector<float>{0.001f, 0.002f});
  pipe.end();
  DepthFrame frame;
  CHECK_FALSE(stream.next(frame));
}

TEST_CASE("stop ends a pending read of a pipe, between frames or within one, and all later reads") {
  for (const char* there : {"", "fra", "frame 0\n", "frame 0\n\1"}) {
    Pipe pipe;
    pipe.write(kHead);
    DepthPipe stream(pipe.reader(), "input");
    pipe.write(there);
    auto read = std::async(std::launch::async, [&] {
      DepthFrame frame;
      return stream.next(frame);
    });
    CHECK(read.wait_for(std::chrono::milliseconds(20)) == std::future_status::timeout);
    stream.stop();
    CHECK_FALSE(read.get());
    DepthFrame frame;
    CHECK_FALSE(stream.next(frame));
  }
}

}  // namespace palpate::depth_pipe_test
