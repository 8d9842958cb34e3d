#include "haptics/pending_edits.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

namespace palpate {

std::uint64_t mergeEdits(EditBatch& edits) {
  const BareVector<PointState> all = std::exchange(edits.points, {});
  std::vector<std::uint32_t> order;
  const auto keep = [&](std::size_t begin, std::size_t end) {
    order.resize(end - begin);
    std::iota(order.begin(), order.end(), static_cast<std::uint32_t>(begin));
    std::ranges::stable_sort(order, {}, [&](std::uint32_t i) { return all[i].number; });
    for (std::size_t i = 0; i < order.size(); ++i)
      if (i + 1 == order.size() || all[order[i]].number != all[order[i + 1]].number)
        edits.points.push_back(all[order[i]]);
  };
  std::size_t begin = 0;
  for (EditMark& mark : edits.marks) {
    keep(begin, mark.at);
    begin = std::exchange(mark.at, edits.points.size());
  }
  keep(begin, all.size());
  return all.size() - edits.points.size();
}

void append(EditBatch& edits, const EditBatch& more) {
  const std::size_t before = edits.points.size();
  edits.points.insert(edits.points.end(), more.points.begin(), more.points.end());
  for (const EditMark& mark : more.marks) edits.marks.push_back({before + mark.at, mark.kind});
  edits.attributes.insert(edits.attributes.end(), more.attributes.begin(),
                          more.attributes.begin() + static_cast<std::ptrdiff_t>(more.markedAttributes()));
}

void PendingEdits::add(const EditBatch& edits) {
  const std::scoped_lock hold(lock_);
  append(edits_, edits);
  // Merged at most once per kMaxStates new states, so that it stays cheap if all are of different points.
  if (edits_.points.size() - least_ < kMaxStates) return;
  merged_ += mergeEdits(edits_);
  least_ = edits_.points.size();
}

std::size_t PendingEdits::size() const {
  const std::scoped_lock hold(lock_);
  return edits_.points.size();
}

std::uint64_t PendingEdits::take(EditBatch& edits) {
  const std::scoped_lock hold(lock_);
  std::swap(edits_, edits);
  least_ = 0;
  return std::exchange(merged_, 0);
}

}  // namespace palpate
