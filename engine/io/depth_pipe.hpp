// Depth frames written by another program, in real time.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "engine/core/depth_stream.hpp"
#include "engine/io/interruptible_input.hpp"

namespace palpate {

/// Raw frames from a pipe. The first line is JSON (parseCamera()) with `depth_scale` and `format`: "z16", 16-bit depth,
/// little-endian, or "z16+rgb8", followed by red, green and blue of each pixel. Each frame is a line `frame TIME_S`,
/// optionally with the 16 numbers of the camera-to-world matrix, and its bytes. A frame that is incomplete or out of
/// order is lost; the next frame begins at its line.
class DepthPipe final : public DepthStream {
 public:
  /// Waits for the first line. `descriptor` remains the caller's and must outlive the object; `name` is for messages.
  /// `depthScale`: values per metre, overriding the line; 0: as in the line. Throws Error if the line is not a valid
  /// camera.
  DepthPipe(int descriptor, std::string name, double depthScale = 0);

  const DepthCamera& camera() const override { return camera_; }
  bool next(DepthFrame& frame) override;
  void stop() noexcept override { input_.stop(); }
  bool isRecorded() const override { return false; }
  /// Not possible: throws Error.
  void rewind() override;

 private:
  struct FrameLine {
    double time_s = 0;
    std::optional<CameraPose> pose;
  };
  bool fill(std::size_t wanted);
  std::string_view unread() const;
  std::optional<std::string> peekLine(std::size_t longest);
  static std::optional<FrameLine> parseLine(std::string_view line);
  std::optional<FrameLine> findLine();
  void skipToFrame();
  std::size_t tornAt(std::size_t bytes) const;
  void take(const std::byte* pixels, DepthFrame& frame) const;
  [[noreturn]] void lose(std::string_view why) const;

  InterruptibleInput input_;
  std::string name_;
  DepthCamera camera_;
  double depthScale_ = 0;
  bool hasColors_ = false, hasPoses_ = false;
  std::optional<CameraPose> pose_;  // of all frames that have none
  std::vector<std::byte> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // unread part of buffer_
  std::optional<double> first_s_, last_s_;
  std::uint64_t count_ = 0;
};

}  // namespace palpate
