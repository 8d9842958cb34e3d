#include "engine/proof/gpu_proof.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "engine/core/clock.hpp"
#include "engine/core/named_values.hpp"
#include "engine/gpu/command_list.hpp"
#include "engine/gpu/device.hpp"
#include "engine/gpu/transfer.hpp"
#include "engine/spatial/radix_sort.hpp"
#include "shaders/compiled.hpp"
#include "shaders/shared/proof.h"

namespace palpate {

namespace {

using Words = std::vector<std::uint32_t>;

constexpr std::uint32_t kWorkgroup = shared::kProofWorkgroup, kWords = shared::kProofWords;
constexpr std::uint32_t kGroups = 7, kCount = kGroups * kWorkgroup;
constexpr std::uint32_t kSorted = 5'003, kSortBits = 13;  // pairs, with keys that repeat

Words randomWords(std::uint32_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  Words words(count);
  std::ranges::generate(words, [&] { return static_cast<std::uint32_t>(random()); });
  return words;
}

// The words that each invocation writes, from those of a workgroup in subgroups of that size.
using Expected = void (*)(std::uint32_t subgroup, std::span<const std::uint32_t> values,
                          std::span<std::uint32_t> results);

std::uint32_t odd(std::uint32_t value) { return value & 1; }

void expectSums(std::uint32_t subgroup, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  const std::uint32_t total = std::accumulate(values.begin(), values.end(), 0u);
  std::uint32_t before = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto own = values.subspan(i / subgroup * subgroup, subgroup);
    std::uint32_t small = 0;
    for (const std::uint32_t value : own) small += value % 1000;
    results[kWords * i] = before;
    results[kWords * i + 1] = total;
    results[kWords * i + 2] = small;
    results[kWords * i + 3] = std::ranges::min(own) ^ std::ranges::max(own);
    before += values[i];
  }
}

void expectBallots(std::uint32_t subgroup, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  const auto second = [](std::uint32_t value) { return value >> 1 & 1; };
  std::uint32_t odds = 0, seconds = 0;
  for (const std::uint32_t value : values) odds += odd(value);
  const std::uint32_t total = odds;
  odds = 0;
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto own = values.subspan(i / subgroup * subgroup, subgroup);
    const auto first = std::ranges::find_if(own, [](std::uint32_t value) { return value % 3 == 0; }) - own.begin();
    results[kWords * i] = odds;
    results[kWords * i + 1] = total;
    results[kWords * i + 2] = odds + ((total + seconds) << 16);
    results[kWords * i + 3] = static_cast<std::uint32_t>(first);
    results[kWords * i + 3] += std::ranges::any_of(own, [](std::uint32_t v) { return v % 64 == 0; }) ? 256 : 0;
    results[kWords * i + 3] += std::ranges::all_of(own, [](std::uint32_t v) { return v % 64 != 1; }) ? 512 : 0;
    odds += odd(values[i]);
    seconds += second(values[i]);
  }
}

void expectShuffles(std::uint32_t subgroup, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const auto own = values.subspan(i / subgroup * subgroup, subgroup);
    const std::size_t lane = i % subgroup;
    results[kWords * i] = own[(lane * 5 + 3) % subgroup];
    results[kWords * i + 1] = own[lane ^ (subgroup / 2)];
    results[kWords * i + 2] = own[0];
    results[kWords * i + 3] = own[subgroup - 1 - lane];
  }
}

void expectPassed(std::uint32_t subgroup, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  Words now(values.begin(), values.end());
  const auto pass = [&](const auto& from, const auto& added) {
    const Words before = now;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] = 3 * before[i] + before[from(i)] + added;
  };
  for (std::uint32_t round = 0; round < shared::kProofRounds; ++round)
    pass([](std::size_t i) { return (i + shared::kProofStride) % kWorkgroup; }, round);
  for (std::size_t i = 0; i < now.size(); ++i) results[kWords * i] = now[i];
  constexpr std::uint32_t kMoreRounds = 2;  // of some subgroups
  for (std::uint32_t round = 0; round < shared::kProofRounds + kMoreRounds; ++round) {
    const Words before = now;
    pass([&](std::size_t i) { return i / subgroup * subgroup + (i + 1) % subgroup; }, 0u);
    for (std::size_t i = 0; i < now.size(); ++i)
      if (round >= shared::kProofRounds + i / subgroup % (kMoreRounds + 1)) now[i] = before[i];
  }
  for (std::size_t i = 0; i < now.size(); ++i) {
    results[kWords * i + 1] = now[i];
    results[kWords * i + 2] = subgroup;
    results[kWords * i + 3] = kWorkgroup / subgroup;
  }
}

void expectAdded(std::uint32_t, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  std::uint32_t added = 0;
  for (const std::uint32_t value : values) added += value & 15;
  for (std::size_t i = 0; i < values.size(); ++i) results[kWords * i] = added;
}

void expectProducts(std::uint32_t, std::span<const std::uint32_t> values, std::span<std::uint32_t> results) {
  for (std::size_t i = 0; i < results.size(); ++i)
    results[i] = values[i / kWords] * (static_cast<std::uint32_t>(i % kWords) + 1);
}

// While shaders are translated. Under validation a software driver does that at the first run.
class Translation {
 public:
  Translation(Device& device, const ProofOptions& options, double& sum_ms)
      : isDeferred_(device.isCpu() && device.instance().validates()), options_(options), sum_ms_(sum_ms) {
    note(true);
  }
  ~Translation() {
    sum_ms_ += 1e-3 * watch_.elapsed_us();
    if (!isDeferred_) note(false);
  }
  Translation(const Translation&) = delete;
  Translation& operator=(const Translation&) = delete;

 private:
  void note(bool begins) const {
    if (options_.compiles) options_.compiles(begins);
  }

  bool isDeferred_;
  const ProofOptions& options_;
  double& sum_ms_;
  Stopwatch watch_;
};

class Prover {
 public:
  Prover(Device& device, const ProofOptions& options)
      : device_(device),
        options_(options),
        values_(Buffer::of<std::uint32_t>(device, kCount, Memory::upload, "proof values")),
        results_(Buffer::of<std::uint32_t>(device, kCount * kWords, Memory::readback, "proof results")),
        counters_(deviceWords(device, kWords * 2, "proof counters")),
        others_(deviceWords(device, kCount, "proof words")) {}

  ProvedPrimitive prove(Primitive primitive) {
    ProvedPrimitive proved{.primitive = primitive, .wrong = {}};
    compile_ms_ = 0;
    const Stopwatch watch;
    proved.wrong = resultOf(primitive);
    proved.compile_ms = compile_ms_;
    proved.run_ms = 1e-3 * watch.elapsed_us() - compile_ms_;
    return proved;
  }

 private:
  std::string resultOf(Primitive primitive) {
    switch (primitive) {
      case Primitive::sum:
        return runs(shared::kProofSum, primitive, expectSums);
      case Primitive::ballot:
        return runs(shared::kProofBallot, primitive, expectBallots);
      case Primitive::shuffle:
        return runs(shared::kProofShuffle, primitive, expectShuffles);
      case Primitive::barrier:
        return runs(shared::kProofBarrier, primitive, expectPassed);
      case Primitive::atomic:
        return atomics();
      case Primitive::hostWrite:
        return hostWrites();
      case Primitive::indirect:
        return counted();
      case Primitive::sort:
        return sorted();
    }
    return "unknown primitive";
  }

  ComputePipeline pipeline(std::uint32_t what, bool fails) {
    const Translation translation(device_, options_, compile_ms_);
    ComputePipeline made(
        device_, shader_code::proof_primitives,
        {.workgroupSize = kWorkgroup, .pushBytes = sizeof(shared::ProofArgs), .constants = {what, fails}});
    return made;
  }
  bool fails(Primitive primitive) const { return options_.fails == primitive; }
  shared::ProofArgs args() const {
    return {.values = values_.address(),
            .results = results_.address(),
            .counters = counters_.address(),
            .others = others_.address()};
  }
  // Each list clears what the last run has left.
  template <class Record>
  void run(Record&& record) {
    CommandList list(device_, device_.latencyQueue(), "proof");
    list.begin();
    list.fill(counters_, 0, counters_.bytes());
    list.fill(counters_, ~0u, sizeof(std::uint32_t), sizeof(std::uint32_t));
    list.fill(others_, 0, others_.bytes());
    record(list);
    list.end();
    device_.latencyQueue().run(list);
  }
  void put(const Words& values) { std::ranges::copy(values, values_.mapped<std::uint32_t>().begin()); }
  // The first of the results that differs.
  std::string difference(const Words& values, Expected expected) const {
    Words right(kCount * kWords);
    for (std::uint32_t group = 0; group < kGroups; ++group)
      expected(device_.subgroupSize(), std::span(values).subspan(group * kWorkgroup, kWorkgroup),
               std::span(right).subspan(group * kWorkgroup * kWords, kWorkgroup * kWords));
    return difference(std::span<const std::uint32_t>(results_.mapped<const std::uint32_t>()), right);
  }
  static std::string difference(std::span<const std::uint32_t> found, const Words& right) {
    for (std::size_t i = 0; i < right.size(); ++i)
      if (found[i] != right[i])
        return fmt::format("result {} of invocation {} is {}, not {}", i % kWords, i / kWords, found[i], right[i]);
    return {};
  }

  std::string runs(std::uint32_t what, Primitive primitive, Expected expected) {
    const ComputePipeline pass = pipeline(what, fails(primitive));
    Words values = randomWords(kCount, what);
    for (std::size_t i = 0; i < values.size(); i += kNarrowestSubgroup)
      values[i] -= values[i] % 3;  // one in each ballot
    put(values);
    run([&](CommandList& list) { list.dispatch(pass, kCount, args()); });
    return difference(values, expected);
  }

  std::string atomics() {
    const ComputePipeline pass = pipeline(shared::kProofAtomic, fails(Primitive::atomic));
    const Words values = randomWords(kCount, 11);
    put(values);
    run([&](CommandList& list) { list.dispatch(pass, kCount, args()); });
    std::uint32_t bits = 0;
    for (const std::uint32_t value : values) bits |= 1u << value % 32;
    const Words right{kCount, std::ranges::min(values), std::ranges::max(values), bits};
    const Words counters = download<std::uint32_t>(device_, counters_, right.size());
    for (std::size_t i = 0; i < right.size(); ++i)
      if (counters[i] != right[i]) return fmt::format("counter {} is {}, not {}", i, counters[i], right[i]);
    const Words tickets = download<std::uint32_t>(device_, others_, kCount);
    const auto other = std::ranges::find_if(tickets, [](std::uint32_t count) { return count != 1; });
    if (other != tickets.end()) return fmt::format("{} invocations have ticket {}", *other, other - tickets.begin());
    // One invocation only was the first.
    const auto results = results_.mapped<std::uint32_t>();
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < kCount; ++i) first += std::exchange(results[kWords * i + 1], 0u);
    if (first != 1) return fmt::format("{} invocations exchanged a word first", first);
    return difference(values, expectAdded);
  }

  // The same list twice, with other words of the host.
  std::string hostWrites() {
    const ComputePipeline pass = pipeline(shared::kProofHostWrite, fails(Primitive::hostWrite));
    CommandList list(device_, device_.latencyQueue(), "proof");
    list.begin();
    list.dispatch(pass, kCount, args());
    list.end();
    run([](CommandList&) {});
    for (const std::uint32_t seed : {21, 22, 23}) {
      const Words values = randomWords(kCount, seed);
      put(values);
      device_.latencyQueue().run(list);
      const std::string wrong = difference(values, expectProducts);
      if (!wrong.empty()) return wrong;
    }
    return {};
  }

  std::string counted() {
    const ComputePipeline counts = pipeline(shared::kProofCount, fails(Primitive::indirect)),
                          pass = pipeline(shared::kProofCounted, false);
    const Words values = randomWords(kCount, 31);
    put(values);
    run([&](CommandList& list) {
      list.dispatch(counts, kCount, args());
      list.dispatchIndirect(pass, counters_, args());
    });
    std::uint32_t odds = 0;
    for (std::uint32_t i = 0; i < kWorkgroup; ++i) odds += odd(values[i]);
    const Words ran = download<std::uint32_t>(device_, others_, kCount);
    for (std::uint32_t i = 0; i < kCount; ++i)
      if (ran[i] != (i < odds ? 1 : 0)) return fmt::format("workgroup {} of {} ran {} times", i, odds, ran[i]);
    return {};
  }

  std::string sorted() {
    std::optional<Translation> translation(std::in_place, device_, options_, compile_ms_);
    const RadixSort sort(device_, kSortBits);
    translation.reset();
    Words keys = randomWords(kSorted, 41), values(kSorted);
    for (std::uint32_t& key : keys) key %= 1u << (kSortBits - 1);
    std::iota(values.begin(), values.end(), 0u);
    const auto words = [&](const char* name) { return deviceWords(device_, kSorted, name); };
    const Buffer k = words("keys"), v = words("values"), otherK = words("other keys"), otherV = words("other values");
    const Buffer scratch(device_, sort.scratchBytes(kSorted), Memory::device, "scratch");
    upload(device_, k, keys);
    upload(device_, v, values);
    PairSort::Sorted at{};
    std::optional<ComputePipeline> spoil;
    if (fails(Primitive::sort)) spoil.emplace(pipeline(shared::kProofSpoil, true));
    run([&](CommandList& list) {
      at = sort.record(list, {k.address(), v.address(), otherK.address(), otherV.address(), scratch}, kSorted);
      shared::ProofArgs spoiled = args();
      spoiled.others = at.values;
      if (spoil) list.dispatch(*spoil, kWorkgroup, spoiled);
    });
    std::ranges::stable_sort(values, {}, [&](std::uint32_t i) { return keys[i]; });
    const Words found = download<std::uint32_t>(device_, at.values == v.address() ? v : otherV, kSorted);
    const Words foundKeys = download<std::uint32_t>(device_, at.keys == k.address() ? k : otherK, kSorted);
    for (std::uint32_t i = 0; i < kSorted; ++i)
      if (found[i] != values[i] || foundKeys[i] != keys[values[i]])
        return fmt::format("pair {} is number {} with the key {}, not {} with {}", i, found[i], foundKeys[i], values[i],
                           keys[values[i]]);
    return {};
  }

  Device& device_;
  const ProofOptions& options_;
  double compile_ms_ = 0;
  Buffer values_, results_, counters_, others_;
};

}  // namespace

std::string GpuProof::wrong() const {
  std::string names;
  for (const ProvedPrimitive& each : primitives)
    if (!each.wrong.empty()) names += (names.empty() ? "" : ",") + std::string(nameOf(kPrimitives, each.primitive));
  return names;
}

double GpuProof::run_ms() const {
  double sum = 0;
  for (const ProvedPrimitive& each : primitives) sum += each.run_ms;
  return sum;
}

GpuProof proveGpu(Device& device, const ProofOptions& options) {
  GpuProof proof{.subgroupSize = device.subgroupSize(), .primitives = {}};
  Prover prover(device, options);
  for (const auto& [name, primitive] : kPrimitives) {
    proof.primitives.push_back(prover.prove(primitive));
    if (options.proved) options.proved(proof.primitives.back());
  }
  return proof;
}

}  // namespace palpate
