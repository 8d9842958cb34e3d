// nanoflann behind a C interface, for nearest.py.
#include <cstdint>
#include <nanoflann.hpp>

namespace {

struct Points {
  const float* positions;
  std::size_t count;
  std::size_t kdtree_get_point_count() const { return count; }
  float kdtree_get_pt(std::size_t i, std::size_t axis) const { return positions[3 * i + axis]; }
  template <class Box>
  bool kdtree_get_bbox(Box&) const {
    return false;
  }
};
using Tree = nanoflann::KDTreeSingleIndexAdaptor<nanoflann::L2_Simple_Adaptor<float, Points, double, std::uint32_t>,
                                                 Points, 3, std::uint32_t>;
struct Peer {
  Points points;
  Tree tree;
  Peer(const float* positions, std::size_t count) : points{positions, count}, tree(3, points) { tree.buildIndex(); }
};

}  // namespace

extern "C" void* peer_make(const float* positions, std::size_t count) { return new Peer(positions, count); }
extern "C" void peer_free(void* peer) { delete static_cast<Peer*>(peer); }
extern "C" void peer_nearest(const void* peer, const float* asked, std::size_t count, std::uint32_t* rows) {
  double squared = 0;
  for (std::size_t i = 0; i < count; ++i)
    static_cast<const Peer*>(peer)->tree.knnSearch(asked + 3 * i, 1, rows + i, &squared);
}
