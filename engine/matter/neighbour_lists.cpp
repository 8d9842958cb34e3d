#include "engine/matter/neighbour_lists.hpp"

#include <algorithm>
#include <bit>

#include "engine/core/widest_lanes.hpp"
#include "engine/matter/lanes.hpp"

#ifdef PALPATE_WITH_AVX2
#include <immintrin.h>
#endif

namespace palpate {

namespace {

// Candidates are far away up to a multiple of this, so that as many can be processed at once.
constexpr std::size_t kSearchedTogether = 16;

// What may be near a particle: coordinates, and bits of a Neighbour.
struct Candidates {
  const float *x, *y, *z;
  const std::uint32_t* words;
  std::size_t count;
};

// Each of these writes the candidates that are nearer to the one with number `self` than the reach, without that one,
// to `list`, and returns their number. Whatever a vector holds is written; the next one overwrites what is not near.
#ifdef PALPATE_WITH_AVX2
PALPATE_AVX512 std::size_t listWide(const Candidates& of, std::size_t self, float reach2, Neighbour* list) {
  const __m512 x = _mm512_set1_ps(of.x[self]), y = _mm512_set1_ps(of.y[self]), z = _mm512_set1_ps(of.z[self]);
  const __m512i own = _mm512_set1_epi32(static_cast<int>(of.words[self]));
  const __m512 most = _mm512_set1_ps(reach2);
  std::size_t count = 0;
  for (std::size_t j = 0; j < of.count; j += 16) {
    const __m512 offX = _mm512_sub_ps(x, _mm512_loadu_ps(of.x + j)), offY = _mm512_sub_ps(y, _mm512_loadu_ps(of.y + j)),
                 offZ = _mm512_sub_ps(z, _mm512_loadu_ps(of.z + j));
    const __m512 far =
        _mm512_add_ps(_mm512_add_ps(_mm512_mul_ps(offX, offX), _mm512_mul_ps(offY, offY)), _mm512_mul_ps(offZ, offZ));
    const __m512i words = _mm512_loadu_si512(of.words + j);
    const __mmask16 near = _mm512_mask_cmpneq_epi32_mask(_mm512_cmp_ps_mask(far, most, _CMP_LT_OQ), words, own);
    _mm512_storeu_si512(list + count, _mm512_maskz_compress_epi32(near, words));
    count += static_cast<std::size_t>(std::popcount(static_cast<unsigned>(near)));
  }
  return count;
}

// For each set of eight lanes: their numbers, first to last.
constexpr auto kChosen = [] {
  std::array<std::array<std::uint32_t, 8>, 256> all{};
  for (std::size_t bits = 0; bits < all.size(); ++bits)
    for (std::uint32_t lane = 0, count = 0; lane < 8; ++lane)
      if ((bits >> lane & 1) != 0) all[bits][count++] = lane;
  return all;
}();

PALPATE_WITH_AVX2 std::size_t listFew(const Candidates& of, std::size_t self, float reach2, Neighbour* list) {
  const __m256 x = _mm256_set1_ps(of.x[self]), y = _mm256_set1_ps(of.y[self]), z = _mm256_set1_ps(of.z[self]);
  const __m256i own = _mm256_set1_epi32(static_cast<int>(of.words[self]));
  const __m256 most = _mm256_set1_ps(reach2);
  std::size_t count = 0;
  for (std::size_t j = 0; j < of.count; j += 8) {
    const __m256 offX = _mm256_sub_ps(x, _mm256_loadu_ps(of.x + j)), offY = _mm256_sub_ps(y, _mm256_loadu_ps(of.y + j)),
                 offZ = _mm256_sub_ps(z, _mm256_loadu_ps(of.z + j));
    const __m256 far =
        _mm256_add_ps(_mm256_add_ps(_mm256_mul_ps(offX, offX), _mm256_mul_ps(offY, offY)), _mm256_mul_ps(offZ, offZ));
    const __m256i words = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(of.words + j));
    const __m256 isOwn = _mm256_castsi256_ps(_mm256_cmpeq_epi32(words, own));
    const auto near =
        static_cast<unsigned>(_mm256_movemask_ps(_mm256_andnot_ps(isOwn, _mm256_cmp_ps(far, most, _CMP_LT_OQ))));
    const __m256i chosen = _mm256_loadu_si256(reinterpret_cast<const __m256i*>(kChosen[near].data()));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(list + count), _mm256_permutevar8x32_epi32(words, chosen));
    count += static_cast<std::size_t>(std::popcount(near));
  }
  return count;
}
#endif
PALPATE_WITHOUT_AVX2 std::size_t listFew(const Candidates& of, std::size_t self, float reach2, Neighbour* list) {
  const Lanes x(of.x[self]), y(of.y[self]), z(of.z[self]);
  std::size_t count = 0;
  for (std::size_t j = 0; j < of.count; j += Lanes::kCount) {
    const Lanes offX = x - Lanes::at(of.x + j), offY = y - Lanes::at(of.y + j), offZ = z - Lanes::at(of.z + j);
    const Lanes far = offX * offX + offY * offY + offZ * offZ;
    for (std::size_t lane = 0; lane < Lanes::kCount; ++lane) {
      list[count] = std::bit_cast<Neighbour>(of.words[j + lane]);
      count += far[lane] < reach2 && j + lane != self ? 1 : 0;
    }
  }
  return count;
}

std::size_t listNear(const Candidates& of, std::size_t self, float reach2, Neighbour* list) {
#ifdef PALPATE_WITH_AVX2
  if (hasAvx512()) return listWide(of, self, reach2, list);
#endif
  return listFew(of, self, reach2, list);
}

// Cells along x whose particles have the same candidates: more candidates, found less often.
constexpr int kCellsTogether = 8;

// Slots that follow each other, and where they are as seen from others.
struct Run {
  std::uint32_t begin, end, image;
  Vec3 shift;
};
constexpr std::size_t kMaxRuns = 3 * shared::kRowsAbout;

// Where candidates are stored.
struct Room {
  std::array<float*, 3> along;
  std::uint32_t* words;
};

// Copies runs one after another, `N` slots at a time, and far places after them; `along`: coordinates by slot.
template <std::size_t N>
void copyBy(const std::array<std::vector<float>, 3>& along, std::span<const Run> runs, Room room) {
  for (const Run& run : runs) {
    const auto first = std::bit_cast<std::uint32_t>(Neighbour{run.begin, run.image});
    const std::array shifts{LanesOf<N>(run.shift.x), LanesOf<N>(run.shift.y), LanesOf<N>(run.shift.z)};
    const std::uint32_t size = run.end - run.begin;
    for (std::uint32_t k = 0; k < size; k += N) {
      for (std::size_t axis = 0; axis < 3; ++axis)
        (LanesOf<N>::at(along[axis].data() + run.begin + k) + shifts[axis]).writeTo(room.along[axis] + k);
      for (std::uint32_t lane = 0; lane < N; ++lane) room.words[k + lane] = first + k + lane;
    }
    for (float*& coordinates : room.along) coordinates += size;
    room.words += size;
  }
  constexpr float kNowhere_m = 1e18f;
  for (float* const coordinates : room.along)
    for (std::size_t k = 0; k < kSearchedTogether; k += N) LanesOf<N>(kNowhere_m).writeTo(coordinates + k);
}

#ifdef PALPATE_WITH_AVX2
PALPATE_WITH_AVX2 void copyRuns(const std::array<std::vector<float>, 3>& along, std::span<const Run> runs,
                                const Room& room) {
  copyBy<8>(along, runs, room);
}
#endif
PALPATE_WITHOUT_AVX2 void copyRuns(const std::array<std::vector<float>, 3>& along, std::span<const Run> runs,
                                   const Room& room) {
  copyBy<4>(along, runs, room);
}

// The candidates of particles in a row of cells, in the order of their slots.
class CandidatesOfRow {
 public:
  // `along`: coordinates by slot, for kListedTogether more than there are. Returns the number of that of slot `self`.
  std::size_t find(const CellGrid& grid, const std::array<std::vector<float>, 3>& along, const IVec3& cell, int lastX,
                   std::uint32_t self) {
    std::array<Run, kMaxRuns + 1> runs;
    std::size_t numberOfSelf = 0, found = 0;
    count_ = 0;
    grid.forEachRun(cell, lastX, [&](std::uint32_t begin, std::uint32_t end, std::uint32_t image) {
      if (image == 0 && self - begin < end - begin) numberOfSelf = count_ + (self - begin);
      Run& run = runs[found];
      run.begin = begin;
      run.end = end;
      run.image = image;
      run.shift = grid.shiftOf(image);
      found += begin < end ? 1 : 0;
      count_ += end - begin;
    });
    makeRoom(count_);
    copyRuns(along, std::span(runs).first(found),
             {{along_[0].data(), along_[1].data(), along_[2].data()}, words_.data()});
    return numberOfSelf;
  }

  Candidates all() const { return {along_[0].data(), along_[1].data(), along_[2].data(), words_.data(), count_}; }

 private:
  // For so many, and for as many more as are written at once.
  void makeRoom(std::size_t most) {
    if (words_.size() >= most + kSearchedTogether) return;
    for (std::vector<float>& coordinates : along_) coordinates.resize(2 * most + kSearchedTogether);
    words_.resize(2 * most + kSearchedTogether);
  }

  std::array<std::vector<float>, 3> along_;  // those of an image are shifted
  std::vector<std::uint32_t> words_;
  std::size_t count_ = 0;
};

}  // namespace

bool NeighbourLists::build(const CellGrid& grid, std::span<const Vec4> places, WorkerTeam& team) {
  blocks_.resize(blocksOf(places.size()));
  for (std::size_t axis = 0; axis < along_.size(); ++axis) {
    along_[axis].resize(places.size() + kListedTogether);
    for (std::size_t i = 0; i < places.size(); ++i) along_[axis][i] = places[i][static_cast<int>(axis)];
  }
  team.forEach(blocks_.size(), [&](std::size_t block) { buildBlock(grid, places, block); });
  return std::ranges::none_of(blocks_, &Block::crowded);
}

void NeighbourLists::buildBlock(const CellGrid& grid, std::span<const Vec4> places, std::size_t block) {
  thread_local CandidatesOfRow near;
  Block& made = blocks_[block];
  const std::size_t begin = block * kSlotsOfBlock, end = std::min(begin + kSlotsOfBlock, places.size());
  made.first.assign(end - begin + 1, 0);
  made.counts.assign(end - begin, 0);
  made.crowded = false;
  const Neighbour nowhere{static_cast<std::uint32_t>(places.size()), 0};
  std::size_t first = 0;
  for (std::size_t i = begin; i < end;) {
    // Particles in a row of cells have the same candidates.
    const IVec3 cell = cellOf(grid.cells(), Vec3(places[i]));
    const int lastX = std::min(cell.x + kCellsTogether, grid.cells().cells.x) - 1;
    const std::size_t endOfRow =
        std::min<std::size_t>(end, grid.firsts()[numberOf(grid.cells(), {lastX, cell.y, cell.z}) + 1]);
    std::size_t self = near.find(grid, along_, cell, lastX, static_cast<std::uint32_t>(i));
    const Candidates candidates = near.all();
    for (; i < endOfRow; ++i, ++self) {
      const std::size_t room = first + candidates.count + kSearchedTogether + kListedTogether;
      if (made.neighbours.size() < room) made.neighbours.resize(2 * room);
      Neighbour* const list = made.neighbours.data() + first;
      std::size_t count = listNear(candidates, self, reach_ * reach_, list);
      made.crowded |= count > kMaxNeighbours;
      count = std::min(count, kMaxNeighbours);
      made.counts[i - begin] = static_cast<std::uint32_t>(count);
      std::fill_n(list + count, kListedTogether, nowhere);
      first += (count + kListedTogether - 1) / kListedTogether * kListedTogether;
      made.first[i - begin + 1] = static_cast<std::uint32_t>(first);
    }
  }
}

}  // namespace palpate
