#include "engine/cuda/resident_method.hpp"

#include <array>
#include <bit>
#include <thread>

#include "engine/core/clock.hpp"
#include "engine/cuda/cuda_error.hpp"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {
constexpr int kMaxRevivals = 3;      // for one query; more indicates an error
constexpr double kLongestEnd_s = 2;  // a step takes some us, and an idle kernel ends after 50 ms
}  // namespace

ResidentMethod::ResidentMethod(const StepBuffers& buffers, const shared::CloudView (&views)[2])
    : buffers_(buffers), views_{views[0], views[1]} {}

ResidentMethod::~ResidentMethod() {
  try {
    rest();
  } catch (const CudaError&) {  // the GPU has failed, and with it the kernel
  }
}

void ResidentMethod::ask(const shared::ContactPose& pose, unsigned parity, bool) {
  revivals_ = 0;
  Message& message = buffers_.message();
  message.pose = pose;
  message.parity = parity;
  message.stop = 0;
  post();
  if (!begun_) begin();
}

void ResidentMethod::post() {
  answered_ = posted_++;
  Message& message = buffers_.message();
  message.sequence = posted_;
  auto words = std::bit_cast<std::array<std::uint32_t, kMessageWords>>(message);
  words.back() = 0;
  for (std::uint32_t i = 0; i + 1 < kMessageWords; ++i) words.back() += shared::questionShare(words[i], i);
  storeRelease(message.seal, words.back());
}

void ResidentMethod::begin() {
  launchResident(buffers_.argsFor(views_[0]), views_, answered_, stream_.get());
  begun_ = true;
}

void ResidentMethod::revive() {
  if (++revivals_ > kMaxRevivals) throw CudaError("CUDA: the resident kernel ends without an answer");
  begin();
}

double ResidentMethod::time_us() {
  // The step is measured by the processor's clock, whose rate changes; its mean rate so far is derived from the global
  // timer, once that has ticked often enough.
  constexpr std::uint64_t kMin_ns = 100'000;
  const Answer& answer = buffers_.answer();
  if (answer.alive_ns < kMin_ns || answer.alive_clocks == 0) return 0;
  const double clocks_per_ns = static_cast<double>(answer.alive_clocks) / static_cast<double>(answer.alive_ns);
  return 1e-3 * static_cast<double>(answer.step_clocks) / clocks_per_ns;
}

void ResidentMethod::rest() {
  if (!begun_) return;
  begun_ = false;
  buffers_.message().stop = 1;
  post();
  const Stopwatch watch;
  while (!stream_.idle("ending the resident kernel")) {
    if (watch.elapsed_s() > kLongestEnd_s) throw CudaError("CUDA: the resident kernel does not end");
    std::this_thread::yield();
  }
}

}  // namespace palpate::cu
