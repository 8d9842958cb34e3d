// Fuzzes every reader of untrusted bytes with damaged files, for some rounds or for a given time: PALPATE_FUZZ_S=3600
// build/asan/tests_io --source-file='*reader_fuzz*' sets the seconds, PALPATE_FUZZ_FROM the first round, so that
// several can run at once, and PALPATE_FUZZ_ONLY=laz,e57 the formats. A file that crashes the program remains where it
// was read.
#include <doctest/doctest.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <map>
#include <new>
#include <ranges>
#include <string>

#include "engine/core/clock.hpp"
#include "engine/io/e57_scans.hpp"
#include "tests/io/fuzz_specimens.hpp"
#include "tests/io/memory_use.hpp"
#include "tests/labels.hpp"

namespace palpate::test::reader_fuzz_test {

namespace {

/// Damaged copies of files, the same in each run.
/// Flips bits, truncates, and sets numbers to extreme values.
class Damage {
 public:
  explicit Damage(std::uint32_t seed = 12345) : state_(seed) {}
  /// `head`: number of leading bytes that describe the content of the file.
  std::string of(std::string text, std::size_t head) {
    constexpr std::array<std::uint64_t, 6> kExtremes{0, 1, 0x7f, 0xff, 0x7fffffffffffffff, 0xffffffffffffffff};
    for (std::size_t flips = random(4); flips > 0; --flips)
      text[random(text.size())] ^= static_cast<char>(1u << random(8));
    switch (random(4)) {
      case 0:
        text.resize(random(text.size()));
        break;
      case 1: {
        const std::uint64_t extreme = kExtremes[random(kExtremes.size())];
        const std::size_t bytes = std::size_t{1} << random(4), at = random(head - 8);
        std::memcpy(text.data() + at, &extreme, bytes);
        break;
      }
      case 2:  // replaces a digit of text
        for (int tries = 0; tries < 50; ++tries)
          if (char& c = text[random(head)]; c >= '0' && c <= '9') c = static_cast<char>('0' + random(10));
        break;
      default:
        break;
    }
    return text;
  }

 private:
  std::size_t random(std::size_t below) {
    state_ = state_ * 1664525u + 1013904223u;
    return static_cast<std::size_t>((std::uint64_t{state_} * below) >> 32);
  }
  std::uint32_t state_;
};

/// For files of a few thousand bytes: the best compression is a thousandfold, and no data is held many times.
constexpr std::int64_t kMaxBytes = std::int64_t{128} << 20;

struct Tally {
  std::uint64_t read = 0, refused = 0;
  double time_s = 0, longest_s = 0;
  std::int64_t mostBytes = 0;
};

void put(const std::filesystem::path& file, const std::string& text) {
  std::filesystem::create_directories(file.parent_path());
  std::ofstream(file, std::ios::binary) << text;
}

/// Only a refusal with the file's name, or with that of the output, is accepted; anything else fails the test, and so
/// does memory beyond what such a file can need.
void tryOne(const std::filesystem::path& folder, const Specimen& specimen, Damage& damage, Tally& tally) {
  const std::filesystem::path file = folder / specimen.name;
  const std::string text = damage.of(specimen.text, specimen.head);
  put(file, specimen.dressed ? specimen.dressed(text) : text);
  const std::filesystem::path source = specimen.sourceIn(folder);
  const Stopwatch watch;
  const MemoryBound bound(kMaxBytes);
  try {
    contentsOf(source);
    const StoredCloud stored = readCloud(source, nullptr, {.samples = 40});
    const std::string ending = cloudFormats().endingToSave(file);
    writeCloud(folder / ("b" + ending), stored.cloud);
    if (cloudFormats().toRead(source).ofTriangles) {
      const StoredCloud mesh = readCloud(source, nullptr, {.asTriangles = true});
      writeCloud(folder / "b.stl", mesh.cloud, {.triangles = &mesh.triangles});
    }
    ++tally.read;
  } catch (const FileError& error) {
    const std::filesystem::path& named = specimen.beside.empty() ? file : folder;
    const std::string said = error.what();
    REQUIRE((said.starts_with(named.string()) || said.starts_with((folder / "b.").string())));
    ++tally.refused;
  }
  REQUIRE_FALSE(MemoryBound::isBroken());
  tally.time_s += watch.elapsed_s();
  tally.longest_s = std::max(tally.longest_s, watch.elapsed_s());
  tally.mostBytes = std::max(tally.mostBytes, bound.most());
}

std::vector<Specimen> wantedSpecimens() {
  std::vector<Specimen> all = specimens();
  if (!canReadE57()) std::erase_if(all, [](const Specimen& s) { return s.format == "e57"; });
  const char* only = std::getenv("PALPATE_FUZZ_ONLY");
  if (!only) return all;
  std::vector<std::string> wanted;
  for (const auto& part : std::views::split(std::string_view(only), ','))
    wanted.emplace_back(std::string_view(part.begin(), part.end()));
  for (const std::string& name : wanted)
    if (std::ranges::find(all, name, &Specimen::format) == all.end()) FAIL("unknown format: ", name);
  std::erase_if(all, [&](const Specimen& s) { return std::ranges::find(wanted, s.format) == wanted.end(); });
  return all;
}

}  // namespace

TEST_CASE("no reader crashes or exceeds its memory on damaged files" * kMoreInFull) {
  const char *given = std::getenv("PALPATE_FUZZ_S"), *first = std::getenv("PALPATE_FUZZ_FROM");
  const double wanted_s = given ? std::atof(given) : 0;
  const std::uint32_t from = first ? static_cast<std::uint32_t>(std::strtoul(first, nullptr, 10)) : 0;
  const std::uint32_t rounds = byTier(40u, 200u);  // without PALPATE_FUZZ_S
  const std::vector<Specimen> all = wantedSpecimens();
  const ScratchFolder scratch;
  for (std::size_t k = 0; k < all.size(); ++k)
    for (const auto& [name, text] : all[k].beside) put(scratch / std::to_string(k) / name, text);
  if (given) std::printf("the files are in %s\n", scratch.path().string().c_str());
  std::map<std::string, Tally> tallies;
  const Stopwatch watch;
  for (std::uint32_t round = from; wanted_s > 0 ? watch.elapsed_s() < wanted_s : round - from < rounds; ++round)
    for (std::size_t k = 0; k < all.size(); ++k) {
      CAPTURE(all[k].name);
      CAPTURE(k);
      CAPTURE(round);
      Damage damage(round * 2654435761u + 7);
      tryOne(scratch / std::to_string(k), all[k], damage, tallies[all[k].format]);
    }
  for (const auto& [format, tally] : tallies) {
    CAPTURE(format);
    CHECK(tally.read > 0);
    CHECK(tally.refused > 0);
    const std::string line = fmt::format("{}: {} files, {} refused, {} read, {:.1f} s", format,
                                         tally.read + tally.refused, tally.refused, tally.read, tally.time_s);
    if (given)
      std::printf("%s; for one at most %.1f MiB and %.3f s\n", line.c_str(),
                  static_cast<double>(tally.mostBytes) / (1 << 20), tally.longest_s);
    else
      MESSAGE(line);
  }
}

TEST_CASE("memory beyond a bound is refused, and freed memory can be allocated again") {
  const MemoryBound bound(1 << 20);
  { const std::vector<char> half(600'000); }
  CHECK_FALSE(MemoryBound::isBroken());
  CHECK(bound.most() >= 600'000);
  { const std::vector<char> again(600'000); }
  CHECK_FALSE(MemoryBound::isBroken());
  CHECK_THROWS_AS(std::vector<char>(2'000'000), std::bad_alloc);
  CHECK(MemoryBound::isBroken());
}

}  // namespace palpate::test::reader_fuzz_test
