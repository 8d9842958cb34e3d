#pragma once

#include <optional>

#include "engine/gpu/buffer.hpp"
#include "engine/motion/cloud_source.hpp"
#include "engine/touch/frame_writer.hpp"

namespace palpate {

/// Frames that a source makes on the host, copied to the GPU as a whole.
class HostFrames final : public FrameWriter {
 public:
  /// `source` must outlive it.
  HostFrames(Device& device, CloudSource& source);

  std::size_t size() const override { return source_.size(); }
  MadeFrame make(double time_s, const LiveCloud::Half& incoming) override;
  void record(CommandList& list, const Front& front, const LiveCloud::Half& incoming,
              const Buffer& velocities) const override;
  double time_s() const override { return frame_.time_s; }
  bool turnsNormals() const override { return source_.turnsNormals(); }
  double extrapolationLimit_s() const override { return frame_.extrapolationLimit_s; }
  double comes_s() const override { return frame_.comes_s; }
  bool isColored() const override { return !frame_.colors.empty(); }
  std::uint64_t points() const override { return frame_.size(); }

 private:
  void stage();

  CloudSource& source_;
  CloudFrame frame_;
  std::optional<double> made_s_;             // last requested time
  Buffer positions_, normals_, velocities_;  // staging buffers
};

}  // namespace palpate
