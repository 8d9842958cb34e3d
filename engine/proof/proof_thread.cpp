#include <chrono>
#include <condition_variable>
#include <exception>
#include <mutex>
#include <thread>

#include "engine/gpu/device.hpp"
#include "engine/proof/gpu_proof.hpp"

namespace palpate {

namespace {

// Shared with the thread, which may outlive the caller.
struct Progress {
  std::mutex guard;
  std::condition_variable changed;
  std::uint64_t steps = 0;
  int compiles = 1;  // translations in progress, and the device that is opened first
  bool ended = false;
  std::optional<GpuProof> proof;
  std::exception_ptr failure;

  template <class Change>
  void note(Change&& change) {
    const std::scoped_lock hold(guard);
    change();
    ++steps;
    changed.notify_all();
  }
};

}  // namespace

std::optional<GpuProof> proveWithin(double wait_s, const DeviceOptions& gpu, const ProofOptions& options) {
  const auto progress = std::make_shared<Progress>();
  std::thread([progress, gpu, options] {
    try {
      ProofOptions watched = options;
      watched.proved = [&](const ProvedPrimitive& each) {
        if (options.proved) options.proved(each);
        progress->note([] {});
      };
      watched.compiles = [&](bool begins) { progress->note([&] { progress->compiles += begins ? 1 : -1; }); };
      Device device(gpu);
      progress->note([&] { --progress->compiles; });
      GpuProof proof = proveGpu(device, watched);
      progress->note([&] { progress->proof = std::move(proof); });
    } catch (...) {
      progress->note([&] { progress->failure = std::current_exception(); });
    }
    progress->note([&] { progress->ended = true; });
  }).detach();
  std::unique_lock hold(progress->guard);
  while (!progress->ended) {
    const std::uint64_t before = progress->steps;
    const auto moves = [&] { return progress->steps != before; };
    if (progress->compiles > 0)
      progress->changed.wait(hold, moves);
    else if (!progress->changed.wait_for(hold, std::chrono::duration<double>(wait_s), moves))
      return std::nullopt;
  }
  if (progress->failure) std::rethrow_exception(progress->failure);
  return std::move(progress->proof);
}

}  // namespace palpate
