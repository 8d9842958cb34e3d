// A kernel that stays on the GPU and answers poses as they come in through mapped host memory: no launch in a tick.
#include "engine/cuda/contact_step.cuh"
#include "engine/cuda/step_kernels.hpp"

namespace palpate::cu {

namespace {

// Without a letter for so long the kernel ends, and the host launches it again when it has one: a call that waits for
// the whole GPU (freeing memory, loading a kernel) is held up by that much and not for ever.
constexpr std::uint64_t kLongestIdle_ns = 50'000'000;

struct Sides {
  CloudView at[2];
};

__device__ std::uint64_t now_ns() {
  std::uint64_t time_ns;
  asm volatile("mov.u64 %0, %%globaltimer;" : "=l"(time_ns));
  return time_ns;
}

// The letter as it is on its way, in one trip over the bus.
__device__ Letter look(const Letter* box) {
  uint words[kLetterWords];
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
  for (uint i = 0; i + 1 < kLetterWords; ++i) seal += questionShare(words[i], i);
  Letter letter;
  letter.pose.hip = vec3(__uint_as_float(words[0]), __uint_as_float(words[1]), __uint_as_float(words[2]));
  letter.pose.tick = words[3];
  letter.parity = words[4];
  letter.stop = words[5];
  letter.sequence = words[6];
  letter.seal = seal ^ words[7];  // 0: it is whole
  return letter;
}

// Waits for a letter newer than `answered`; one that says stop when none comes.
__device__ Letter nextLetter(const Letter* box, uint answered) {
  const std::uint64_t began_ns = now_ns();
  Letter letter = look(box);
  while (letter.seal != 0 || letter.sequence == answered) {
    if (now_ns() - began_ns > kLongestIdle_ns) {
      letter.stop = 1;
      return letter;
    }
    letter = look(box);
  }
  __threadfence_system();  // what other kernels wrote before the host did is seen as well
  return letter;
}

__global__ void __launch_bounds__(kStepThreads)
    residentStep(const __grid_constant__ StepArgs args, const __grid_constant__ Sides sides, uint answered) {
  __shared__ SharedPatch memory;
  __shared__ Letter letter;
  const std::uint64_t born_ns = now_ns();
  const long long born_clocks = clock64();
  for (;;) {
    long long began_clocks = 0;
    if (threadIdx.x == 0) {
      letter = nextLetter(args.letter, answered);
      began_clocks = clock64();
    }
    __syncthreads();
    if (letter.stop != 0) return;
    ContactStep step(args, sides.at[letter.parity & 1], memory, letter.pose);
    step.run();
    step.write();
    if (threadIdx.x == 0) {
      const long long now_clocks = clock64();
      args.answer->step_clocks = now_clocks - began_clocks;
      args.answer->alive_clocks = now_clocks - born_clocks;
      args.answer->alive_ns = now_ns() - born_ns;
    }
    answered = letter.sequence;
    __syncthreads();  // thread 0 writes the next letter over this one
  }
}

}  // namespace

void launchResident(const StepArgs& args, const CloudView (&sides)[2], std::uint32_t answered, cudaStream_t stream) {
  residentStep<<<1, kStepThreads, 0, stream>>>(args, Sides{{sides[0], sides[1]}}, answered);
  checkLaunch("launching the resident kernel");
}

}  // namespace palpate::cu
