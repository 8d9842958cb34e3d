#include "engine/spatial/radix_sort.hpp"

#include <algorithm>
#include <numeric>
#include <random>

#include "engine/gpu/transfer.hpp"
#include "engine/spatial/look_back_sort.hpp"
#include "tests/gpu_fixture.hpp"
#include "tests/labels.hpp"

namespace palpate::radix_sort_test {

TEST_SUITE_BEGIN(kPortable);

namespace {

class RadixSortFixture : public GpuFixture {
 protected:
  struct Pairs {
    std::vector<std::uint32_t> keys, values;
  };

  std::vector<std::unique_ptr<PairSort>> radixSort(std::uint32_t keyBits) {
    std::vector<std::unique_ptr<PairSort>> one;
    one.push_back(std::make_unique<RadixSort>(device, keyBits));
    return one;
  }
  std::vector<std::unique_ptr<PairSort>> lookBackSort(std::uint32_t keyBits, const LookBackOptions& options = {}) {
    REQUIRE(LookBackSort::fits(device, keyBits));
    std::vector<std::unique_ptr<PairSort>> one;
    one.push_back(std::make_unique<LookBackSort>(device, keyBits, options));
    return one;
  }

  Pairs sortOnGpu(const PairSort& sort, const std::vector<std::uint32_t>& keys) {
    const auto count = static_cast<std::uint32_t>(keys.size());
    std::vector<std::uint32_t> values(count);
    std::iota(values.begin(), values.end(), 0u);
    const auto words = [&](std::uint64_t n, const char* name) {
      return Buffer::of<std::uint32_t>(device, n, Memory::device, name);
    };
    const Buffer k = words(count, "keys"), v = words(count, "values");
    const Buffer ka = words(count, "keys alt"), va = words(count, "values alt");
    const Buffer scratch(device, sort.scratchBytes(count), Memory::device, "scratch");
    upload(device, k, keys);
    upload(device, v, values);
    CommandList list(device, device.latencyQueue(), "sort");
    list.begin();
    const auto sorted = sort.record(list, {k.address(), v.address(), ka.address(), va.address(), scratch}, count);
    list.end();
    device.latencyQueue().run(list);
    return {download<std::uint32_t>(device, sorted.keys == k.address() ? k : ka, count),
            download<std::uint32_t>(device, sorted.values == v.address() ? v : va, count)};
  }

  // The pairs are sorted by the low bits of the key, and stable.
  void checkSorts(const std::vector<std::uint32_t>& keys, std::uint32_t keyBits) {
    checkSorts(keys, keyBits, radixSort(keyBits));
    checkSorts(keys, keyBits, lookBackSort(keyBits));
  }
  void checkSorts(const std::vector<std::uint32_t>& keys, std::uint32_t keyBits,
                  const std::vector<std::unique_ptr<PairSort>>& sorts) {
    const std::uint64_t mask = (std::uint64_t{1} << keyBits) - 1;
    std::vector<std::uint32_t> expected(keys.size());
    std::iota(expected.begin(), expected.end(), 0u);
    std::ranges::stable_sort(expected, {}, [&](std::uint32_t i) { return keys[i] & mask; });
    for (const auto& sort : sorts) {
      const Pairs sorted = sortOnGpu(*sort, keys);
      CHECK(sorted.values == expected);
      for (std::size_t i = 0; i < expected.size(); ++i) {
        if (sorted.keys[i] == keys[expected[i]]) continue;
        FAIL("key " << i << " of " << keys.size() << " is " << sorted.keys[i]);
      }
    }
  }
};

std::vector<std::uint32_t> randomWords(std::size_t count, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::vector<std::uint32_t> words(count);
  for (auto& word : words) word = static_cast<std::uint32_t>(random());
  return words;
}

}  // namespace

TEST_CASE_FIXTURE(RadixSortFixture, "pairs of any count are sorted stably") {
  // Around the sizes of subgroups, workgroups, the tiles of both sorts and those of the look-back histogram.
  for (const std::size_t count :
       {0,    1,    2,    7,    8,    9,    31,   32,   33,   255,    256,    257,    2047,
        2048, 2049, 3839, 3840, 3841, 4607, 4608, 4609, 7680, 16'383, 16'384, 16'385, 65'537}) {
    CAPTURE(count);
    checkSorts(randomWords(count, static_cast<std::uint32_t>(count)), 28);
  }
}

TEST_CASE_FIXTURE(RadixSortFixture, "a radix sort uses only the requested key bits") {
  const auto keys = randomWords(10'007, 7);
  for (std::uint32_t bits = 1; bits <= 32; ++bits) {
    CAPTURE(bits);
    checkSorts(keys, bits, radixSort(bits));
  }
  for (const std::uint32_t bits : {1u, 5u, 13u, 21u, 32u}) {  // a driver translates each length of a digit for itself
    CAPTURE(bits);
    checkSorts(keys, bits, lookBackSort(bits));
  }
}

TEST_CASE_FIXTURE(RadixSortFixture, "a radix sort with zero key bits leaves the pairs unchanged") {
  checkSorts(randomWords(1000, 3), 0);
}

TEST_CASE_FIXTURE(RadixSortFixture, "equal, sorted and reversed keys are sorted stably") {
  std::vector<std::uint32_t> keys(65'537, 42u);
  checkSorts(keys, 21);
  keys.assign(65'537, 0xFFFFFFFFu);
  checkSorts(keys, 32);
  std::iota(keys.begin(), keys.end(), 0u);
  checkSorts(keys, 17);
  std::ranges::reverse(keys);
  checkSorts(keys, 17);
}

TEST_CASE_FIXTURE(RadixSortFixture, "long runs of equal keys, and single keys among equal ones, are sorted stably") {
  std::vector<std::uint32_t> keys(65'537);
  for (std::size_t i = 0; i < keys.size(); ++i) keys[i] = static_cast<std::uint32_t>(i / 5000 * 7919);
  checkSorts(keys, 21);
  std::ranges::fill(keys, 0x155555u);
  keys.front() = 0x1FFFFFu;
  keys.back() = 0;
  checkSorts(keys, 21);
}

TEST_CASE_FIXTURE(RadixSortFixture,
                  "a sort needs no progress of other workgroups: tiles that never tell their counts") {
  constexpr std::size_t kTile = 3840;  // 2,560 on a device with small workgroups
  struct Silence {
    std::uint32_t each, looks;
  };
  // All tiles, the first and every other one, and some.
  for (const auto [each, looks] : {Silence{1, 0}, Silence{2, 1}, Silence{3, 64}}) {
    CAPTURE(each);
    const auto sorts = lookBackSort(21, {.mostLooks = looks, .silent = each});
    for (const std::size_t count :
         {std::size_t{0}, std::size_t{1}, kTile - 1, kTile, kTile + 1, 2 * kTile, 5 * kTile + 7, 23 * kTile + 1}) {
      CAPTURE(count);
      checkSorts(randomWords(count, static_cast<std::uint32_t>(count)), 21, sorts);
    }
  }
}

TEST_CASE("radix digits cover the key's bits without a gap, at most as many as are allowed each") {
  for (std::uint32_t bits = 0; bits <= 32; ++bits)
    for (const std::uint32_t most : {4u, 6u, 7u, 8u}) {
      std::uint32_t next = 0;
      for (const RadixDigit& digit : radixDigits(bits, most)) {
        CHECK(digit.shift == next);
        CHECK(digit.bits >= 1);
        CHECK(digit.bits <= most);
        next += digit.bits;
      }
      CHECK(next == bits);
      CHECK(radixDigits(bits, most).size() == (bits + most - 1) / most);
    }
}

TEST_CASE_FIXTURE(RadixSortFixture, "a million pairs are sorted stably") { checkSorts(randomWords(1'000'003, 1), 21); }

TEST_SUITE_END();

}  // namespace palpate::radix_sort_test
