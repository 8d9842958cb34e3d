// Eigenvalues and eigenvectors of many matrices, several at a time where the processor can.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "engine/cloud/eigen3.hpp"

namespace palpate {

/// Keeps its memory between uses. Used by one thread.
class ManyEigen3 {
 public:
  void clear() { exponents_.clear(); }
  void add(const SymmetricMatrix3& matrix);
  /// Number of matrices since the last clear().
  std::size_t size() const { return exponents_.size(); }
  /// Solves all of them; none can be added any more.
  void solve();
  /// The same bit by bit as eigenSymmetric() of the matrix that was added as number i.
  Eigen3 operator[](std::size_t i) const;

 private:
  // Entry by entry, by matrix, and zero matrices to whole lanes.
  enum Entry { kXX, kYY, kZZ, kXY, kXZ, kYZ, kEntries };
  std::array<std::vector<double>, kEntries> entries_;
  std::array<std::array<std::vector<double>, 3>, 3> columns_;  // coordinates of the vectors
  std::vector<double> turns_;                                  // not 0: the matrix is not diagonal yet
  std::vector<int> exponents_;
};

}  // namespace palpate
