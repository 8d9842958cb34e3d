#include "engine/cloud/eigen3_many.hpp"

#include <algorithm>

#include "engine/core/widest_lanes.hpp"

namespace palpate {

namespace {

constexpr std::size_t kLanes = 8;

// Of the arrays of one rotation, about the axes p and q; r is the third.
struct Turned {
  double *app, *aqq, *apq, *arp, *arq;
  std::array<double*, 3> vp, vq;
  const double* turns;
};

// As in eigenSymmetric(); a matrix that does not turn keeps its bits.
PALPATE_WIDEST_LANES
void rotate(std::size_t count, const Turned& arrays) {
  double *app = arrays.app, *aqq = arrays.aqq, *apq = arrays.apq, *arp = arrays.arp, *arq = arrays.arq;
  double *px = arrays.vp[0], *py = arrays.vp[1], *pz = arrays.vp[2];
  double *qx = arrays.vq[0], *qy = arrays.vq[1], *qz = arrays.vq[2];
  const double* turns = arrays.turns;
#pragma GCC ivdep
  for (std::size_t i = 0; i < count; ++i) {
    const double one = app[i], two = aqq[i], beside = apq[i], rp = arp[i], rq = arq[i];
    const double x = px[i], y = py[i], z = pz[i], u = qx[i], v = qy[i], w = qz[i];
    const auto [t, c, s] = jacobiRotation(one, two, beside);
    const bool turned = (turns[i] != 0) & (beside != 0);
    app[i] = turned ? one - t * beside : one;
    aqq[i] = turned ? two + t * beside : two;
    apq[i] = turned ? 0.0 : beside;
    arp[i] = turned ? c * rp - s * rq : rp;
    arq[i] = turned ? s * rp + c * rq : rq;
    px[i] = turned ? c * x - s * u : x;
    py[i] = turned ? c * y - s * v : y;
    pz[i] = turned ? c * z - s * w : z;
    qx[i] = turned ? s * x + c * u : u;
    qy[i] = turned ? s * y + c * v : v;
    qz[i] = turned ? s * z + c * w : w;
  }
}

}  // namespace

void ManyEigen3::add(const SymmetricMatrix3& matrix) {
  const std::size_t i = size();
  if (i + kLanes > turns_.size()) {
    const std::size_t room = 2 * i + 2 * kLanes;
    for (std::vector<double>& entry : entries_) entry.resize(room);
    for (auto& column : columns_)
      for (std::vector<double>& coordinate : column) coordinate.resize(room);
    turns_.resize(room);
  }
  const int exponent = exponentOf(matrix);
  const std::array<double, kEntries> entries{matrix.xx, matrix.yy, matrix.zz, matrix.xy, matrix.xz, matrix.yz};
  for (std::size_t k = 0; k < kEntries; ++k) entries_[k][i] = timesPowerOfTwo(entries[k], -exponent);
  exponents_.push_back(exponent);
}

void ManyEigen3::solve() {
  const std::size_t padded = (size() + kLanes - 1) / kLanes * kLanes;
  for (std::vector<double>& entry : entries_) std::fill(entry.begin() + size(), entry.begin() + padded, 0);
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis) std::fill_n(columns_[k][axis].begin(), padded, k == axis ? 1 : 0);
  const auto turned = [this](std::size_t p, std::size_t q, Entry pq, Entry rp, Entry rq) {
    const auto column = [this](std::size_t k) {
      return std::array{columns_[k][0].data(), columns_[k][1].data(), columns_[k][2].data()};
    };
    return Turned{entries_[p].data(),  entries_[q].data(), entries_[pq].data(), entries_[rp].data(),
                  entries_[rq].data(), column(p),          column(q),           turns_.data()};
  };
  const std::array rotations{turned(0, 1, kXY, kXZ, kYZ), turned(0, 2, kXZ, kXY, kYZ), turned(1, 2, kYZ, kXY, kXZ)};
  for (int sweep = 0; sweep < kMaxJacobiSweeps; ++sweep) {
    bool any = false;
    for (std::size_t i = 0; i < padded; ++i) {
      const double xy = entries_[kXY][i], xz = entries_[kXZ][i], yz = entries_[kYZ][i];
      const bool turns = !(xy * xy + xz * xz + yz * yz < kMinOffDiagonal);
      turns_[i] = turns ? 1 : 0;
      any = any || turns;
    }
    if (!any) break;
    for (const Turned& rotation : rotations) rotate(padded, rotation);
  }
}

Eigen3 ManyEigen3::operator[](std::size_t i) const {
  const auto column = [&](std::size_t k) { return DVec3(columns_[k][0][i], columns_[k][1][i], columns_[k][2][i]); };
  return sortedEigen({entries_[kXX][i], entries_[kYY][i], entries_[kZZ][i]}, {column(0), column(1), column(2)},
                     exponents_[i]);
}

}  // namespace palpate
