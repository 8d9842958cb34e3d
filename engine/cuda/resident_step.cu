// A kernel that stays on the GPU and answers poses that it reads from mapped host memory: no launch in a tick.
#include "engine/cuda/contact_step.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

// The kernel ends after this time without a message, and the host relaunches it for the next one: a call that waits for
// the whole GPU (freeing memory, loading a kernel) is delayed by at most this time.
constexpr std::uint64_t kLongestIdle_ns = 50'000'000;

struct Halves {
  CloudView at[2];
};

__device__ std::uint64_t now_ns() {
  std::uint64_t time_ns;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(time_ns));
  return time_ns;
}

// The message as it arrives, possibly incomplete, in one trip over the bus.
__device__ Message readMailbox(const Message* box) {
  uint words[kMessageWords];
  const auto* from = reinterpret_cast<const uint*>(box);
  asm volatile("ld.volatile.v4.u32 {%0, %1, %2, %3}, [%4];"
               : "=r"(words[0]), "=r"(words[1]), "=r"(words[2]), "=r"(words[3])
               : "l"(from)
               : "memory");
  asm volatile("ld.volatile.v4.u32 {%0, %1, %2, %3}, [%4];"
               : "=r"(words[4]), "=r"(words[5]), "=r"(words[6]), "=r"(words[7])
               : "l"(from + 4)
               : "memory");
  uint seal = 0;
  for (uint i = 0; i + 1 < kMessageWords; ++i) seal += questionShare(words[i], i);
  Message message;
  message.pose.hip = vec3(__uint_as_float(words[0]), __uint_as_float(words[1]), __uint_as_float(words[2]));
  message.pose.tick = words[3];
  message.parity = words[4];
  message.stop = words[5];
  message.sequence = words[6];
  message.seal = seal ^ words[7];  // 0: complete
  return message;
}

// Waits for a message newer than `answered`; returns a stop message if none arrives.
__device__ Message nextMessage(const Message* box, uint answered) {
  const std::uint64_t began_ns = now_ns();
  Message message = readMailbox(box);
  while (message.seal != 0 || message.sequence == answered) {
    if (now_ns() - began_ns > kLongestIdle_ns) {
      message.stop = 1;
      return message;
    }
    message = readMailbox(box);
  }
  __threadfence_system();  // also makes earlier writes of other kernels visible
  return message;
}

__global__ void __launch_bounds__(kStepThreads)
    residentStep(const __grid_constant__ StepArgs args, const __grid_constant__ Halves halves, uint answered) {
  __shared__ SharedPatch memory;
  __shared__ Message message;
  const std::uint64_t born_ns = now_ns();
  const long long born_clocks = clock64();
  for (;;) {
    long long began_clocks = 0;
    if (threadIdx.x == 0) {
      message = nextMessage(args.message, answered);
      began_clocks = clock64();
    }
    __syncthreads();
    if (message.stop != 0) return;
    ContactStep step(args, halves.at[message.parity & 1], memory, message.pose);
    step.run();
    step.write();
    if (threadIdx.x == 0) {
      const long long now_clocks = clock64();
      args.answer->step_clocks = now_clocks - began_clocks;
      args.answer->alive_clocks = now_clocks - born_clocks;
      args.answer->alive_ns = now_ns() - born_ns;
    }
    answered = message.sequence;
    __syncthreads();  // thread 0 overwrites the message next
  }
}

}  // namespace

void launchResident(const StepArgs& args, const CloudView (&halves)[2], std::uint32_t answered, cudaStream_t stream) {
  residentStep<<<1, kStepThreads, 0, stream>>>(args, Halves{{halves[0], halves[1]}}, answered);
  checkLaunch("launching the resident kernel");
}

}  // namespace palpate::cu
