// Hands that edit a served square, undo and redo: near their points, or with all of them.
#pragma once

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "engine/edit/history.hpp"
#include "tests/sharing/honest_hand.hpp"
#include "tests/sharing/served_square.hpp"

namespace palpate {

/// A hand of a session that moves points up, in strokes. The points of square() are by x + 200 y.
class UndoingHand {
 public:
  virtual ~UndoingHand() = default;
  /// One stroke: these points are `up` higher.
  void stroke(const std::vector<std::uint32_t>& points, float up) {
    std::vector<PointChange> changes;
    for (const std::uint32_t point : points) {
      const PointState from = at(point);
      PointState to = from;
      to.position.z += up;
      changes.push_back({.from = from, .to = to});
    }
    edit(changes);
    follow();
  }
  /// Returns the number of points that have changed; 0: there was nothing to undo.
  std::size_t undo() { return goBack(true); }
  std::size_t redo() { return goBack(false); }
  /// The state that the hand feels; gone if it is not known here.
  virtual PointState at(std::uint32_t point) = 0;
  virtual bool isDelivered() = 0;
  /// Takes in what others have done.
  virtual void follow() = 0;
  StrokeCounts counts() { return history().counts(); }

 protected:
  virtual void edit(const std::vector<PointChange>& changes) = 0;
  virtual void change(std::span<const PointChange> changes) = 0;
  virtual History& history() = 0;

 private:
  std::size_t goBack(bool undo) {
    follow();
    std::size_t count = 0;
    const History::Carriers carriers{.points = [&](std::span<const PointChange> changes) {
      change(changes);
      count = changes.size();
      return true;
    }};
    undo ? history().undo(carriers) : history().redo(carriers);
    follow();
    return count;
  }
};

class FarHand final : public UndoingHand {
 public:
  explicit FarHand(const std::string& name, const UndoBudget& budget = {1 << 24})
      : joined_(joinNear(name)), history_(PointStates(), budget) {
    source().keepEdits();
  }
  BrickSource& source() { return joined_.far->source(); }
  FarCloud& far() { return *joined_.far; }
  bool comesTo(const DVec3& hip) { return palpate::comesTo(hip, source()); }
  bool knows(std::uint32_t point) { return !at(point).gone; }

  PointState at(std::uint32_t point) override {
    std::vector<PointState> points;
    source().pointsIn(DVec3(-1000), DVec3(1000), points);
    const auto there = std::ranges::find(points, point, &PointState::number);
    return there == points.end() ? PointState{.gone = true, .number = point} : *there;
  }
  bool isDelivered() override { return far().counts().delivered; }
  void follow() override {
    EditBatch batch;
    source().takeEdits(batch);
    history_.follow(batch);
  }

 protected:
  void edit(const std::vector<PointChange>& changes) override {
    source().make(changes, ++stroke_);
    source().endStroke();
  }
  void change(std::span<const PointChange> changes) override { source().change(changes); }
  History& history() override { return history_; }

 private:
  JoinedCloud joined_;
  History history_;
  std::uint32_t stroke_ = 0;
};

class WholeHand final : public UndoingHand {
 public:
  explicit WholeHand(const std::string& name)
      : joined_(joinCloud(name, {.network = ownNetwork()})),
        follower_(shareEdits({.session = joined_.session, .cloud = joined_.cloud, .edits = edits_, .cell = 1})),
        history_(joined_.cloud, {1 << 24}) {}

  PointState at(std::uint32_t point) override {
    follow();
    return history_.points()[point];
  }
  ServerFile& file() { return *follower_->file(); }
  bool isDelivered() override {
    follow();
    return follower_->counts().delivered;
  }
  void follow() override { pass(edits_.edit({})); }

 protected:
  void edit(const std::vector<PointChange>& changes) override {
    follow();
    pass(edits_.edit(statesOf(changes)));
  }
  void change(std::span<const PointChange> changes) override {
    const auto states = statesOf(changes);
    EditBatch batch{.points = {states.begin(), states.end()}, .marks = {}};
    batch.marks.push_back({batch.points.size(), EditMark::Kind::change});
    follower_->catchUp(batch);
  }
  History& history() override { return history_; }

 private:
  static std::vector<PointState> statesOf(std::span<const PointChange> changes) {
    std::vector<PointState> states;
    for (const PointChange& change : changes) states.push_back(change.to);
    return states;
  }
  void pass(const EditBatch& batch) {
    history_.follow(batch);
    follower_->catchUp(batch);
  }

  JoinedCloud joined_;
  PlainEdits edits_;
  std::unique_ptr<SharedFollower> follower_;
  History history_;
};

}  // namespace palpate
