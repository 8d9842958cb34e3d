#pragma once

#include "engine/cuda/query_method.hpp"

namespace palpate::cu {

/// A kernel that stays on the GPU, on a stream of its own, and reads poses from host memory. It starts with the first
/// query and ends if no query arrives for a while, or at rest(); the next query starts it again.
class ResidentMethod final : public QueryMethod {
 public:
  ResidentMethod(const StepBuffers& buffers, const shared::CloudView (&views)[2]);
  ~ResidentMethod() override;

  void ask(const shared::ContactPose& pose, unsigned parity, bool timed) override;
  bool ended() override { return stream_.idle("answering from the resident kernel"); }
  /// For a kernel that ended before it saw the message.
  void revive() override;
  double time_us() override;
  void rest() override;
  bool inStreamOrder() const override { return false; }

 private:
  void begin();
  void post();

  const StepBuffers& buffers_;
  shared::CloudView views_[2];
  Stream stream_;
  bool begun_ = false;
  int revivals_ = 0;            // for the present query
  std::uint32_t posted_ = 0;    // sequence of the last message
  std::uint32_t answered_ = 0;  // of the message before it, which needs no answer any more
};

}  // namespace palpate::cu
