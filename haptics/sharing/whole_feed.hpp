// What a client of the whole cloud gets: the points as served, and then the edits of others.
#pragma once

#include <vector>

#include "engine/cloud/point_cloud.hpp"
#include "haptics/sharing/client_stream.hpp"
#include "haptics/sharing/shared_points.hpp"

namespace palpate::sharing {

class WholeFeed {
 public:
  /// Maximum number of samples in flight to a client.
  static constexpr std::uint64_t kWindow = 4096;
  struct Parts {
    const PointCloud& cloud;     ///< as served
    const SharedPoints& points;  ///< as edited since
    Id client{};
  };
  /// All that `parts` refers to must outlive it. `want` must be isValid().
  WholeFeed(const Parts& parts, const Want& want);
  static bool isValid(const Want& want, const PointCloud& cloud);

  bool next(StreamSample& sample, const ClientStream& to);
  /// Until there may be something to send.
  double due_s() const;
  /// Nothing follows any more.
  bool isOver() const { return block_ == blocks_ && !edits_; }

 private:
  void addBlock(StreamSample& sample);
  void addEdits(StreamSample& sample);
  bool hasNews() const;

  Parts parts_;
  std::uint32_t every_;
  std::uint64_t block_, blocks_;
  bool edits_;
  SharedPoints::Place place_;
  std::uint64_t acked_ = ~std::uint64_t{0};  // as last sent: at first it gets a sample at once
  bool isBehind_ = true;                     // the last sample did not have all edits
  Stopwatch lastSent_;
  std::vector<PointState> states_;
};

}  // namespace palpate::sharing
