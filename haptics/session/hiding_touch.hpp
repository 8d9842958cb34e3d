#pragma once

#include <atomic>
#include <memory>
#include <span>
#include <vector>

#include "engine/core/point_set.hpp"
#include "engine/touch/touch_backend.hpp"

namespace palpate {

/// A back end in which points can be hidden: they leave its index, so that no hand feels them and no brush changes
/// them, while its followers learn nothing of that. What others do to a hidden point is noted, and carried out once it
/// is shown. hide(), change(), offer() and take() are for one thread.
class HidingTouch final : public TouchDecorator, private EditStream {
 public:
  explicit HidingTouch(std::unique_ptr<TouchBackend> inner) : TouchDecorator(std::move(inner)) {}

  EditStream* edits() noexcept override { return inner().edits() ? this : nullptr; }

 private:
  // The stream of its edits.
  void keep() override { stream().keep(); }
  void take(EditBatch& batch) override;
  std::optional<EditRoom> room() const override { return stream().room(); }
  EditProgress progress() const noexcept override;
  BlockedMoves blocked() const noexcept override { return stream().blocked(); }
  void change(std::span<const PointChange> changes) override;
  void lock(const PointLock& lock) override { stream().lock(lock); }
  void hide(const PointSet& points, const PresentStates& present) override;
  bool changeMany(const PointSet& points, std::span<const PointState> states) override;
  bool offer(std::span<const PointChange> changes, std::uint64_t changesFollowed) override;
  std::size_t mostOffered() const override { return stream().mostOffered(); }

  EditStream& stream() const noexcept { return *inner().edits(); }
  // Point by point, unnoticed.
  void flip(const PointSet& points, std::span<const PointState> present);
  // Takes the changes of hidden points out of `changes`, and returns the states that they lead to.
  std::vector<PointState> takeHidden(std::vector<PointChange>& changes) const;

  PointSet hidden_;
  PointSet logged_;  // those of them that were hidden by changes, which a reader of the log itself has seen
  PresentStates present_;
  EditBatch left_;                    // that take() has still to report first
  std::vector<PointState> changed_;   // hidden points, with the next mark of a change
  std::vector<PointState> received_;  // and with the next one of an offer
  bool isOfferedAlone_ = false;       // the offer was of hidden points only
  std::atomic<std::int64_t> unreported_ =
      0;                       // states of the back end that take() has left out, less those it has added
  std::uint64_t hidings_ = 0;  // changes of the back end that were hidings
};

}  // namespace palpate
