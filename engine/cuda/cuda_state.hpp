#pragma once

#include <exception>

#include "engine/core/mirrored_stroke.hpp"
#include "engine/cuda/cuda_touch.hpp"
#include "engine/cuda/live_copy.hpp"
#include "engine/cuda/push_edit.hpp"
#include "engine/cuda/query_method.hpp"

namespace palpate {

/// Implementation of CudaTouch: the cloud, its index, and the query and the edit in flight.
class CudaTouch::State {
 public:
  State(const PointCloud& cloud, const CudaTouchOptions& options);
  ~State();

  Contact query(const Pose& pose, double budget_us) noexcept;
  void finish();
  std::size_t readBack(PointCloud& cloud);

  std::string machine;
  double buildTime_us = 0;
  std::vector<double> editTimes_us;
  std::optional<double> firstEditTime_s;
  TouchShortfalls shortfalls;
  double cell = 0;

 private:
  struct Asked {
    Pose pose;
    bool timed;
  };
  void ask(const Pose& pose, bool timed);
  // Takes the answer into last_ if it arrives within the budget (0: no limit).
  bool answerWithin(double budget_us);
  void takeAnswer();
  // The contact of a pose without an answer of its own: the tangent plane at the last proxy.
  Contact held(const Pose& pose) const;
  void editIfYielding();
  // Whether the last edit has completed; records its time.
  bool editDone();
  bool editDoneWithin(double budget_us);
  void recordEdit(unsigned parity);

  CudaTouchOptions options_;
  DVec3 origin_;
  cu::Stream stream_;
  cu::LiveCopy live_;
  MirroredStroke stroke_;
  SurfaceMeasure measured_;  // sum over all edits so far
  cu::CubBuild build_;
  cu::StepBuffers buffers_;
  std::unique_ptr<cu::QueryMethod> method_;
  std::optional<cu::PushEdit> push_;
  std::unique_ptr<cu::Graph> edits_[2];  // indexed by the front half before the edit
  cu::Event editStart_, editEnd_;
  bool editOut_ = false;
  std::uint32_t tick_ = 0;
  std::optional<Asked> asked_;
  Contact last_;
  Pose lastPose_;
  std::exception_ptr failure_;
};

}  // namespace palpate
