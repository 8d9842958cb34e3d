#include "engine/core/edit_queue.hpp"

#include <doctest/doctest.h>

#include <thread>

namespace palpate::edit_queue_test {
namespace {

PointState numbered(std::uint64_t number) { return {.number = static_cast<std::uint32_t>(number)}; }

}  // namespace

TEST_CASE("a reader of an edit queue gets all edits in order, each group with its mark, while others are appended") {
  constexpr std::uint64_t kGroups = 3'000;
  EditQueue queue(1 << 20);
  queue.append(1, [](std::size_t) { return numbered(99); });  // not kept yet
  queue.keep();
  EditBatch all;
  {
    std::jthread writer([&] {
      std::uint64_t number = 0;
      for (std::uint64_t group = 0; group < kGroups; ++group) {
        if (group % 3 == 0) queue.mark(EditMark::Kind::part);
        const std::uint64_t first = number, count = group % 7;
        number += count;
        queue.append(
            count, [&](std::size_t i) { return numbered(first + i); }, EditMark::Kind::received);
      }
    });
    std::size_t marks = 0;
    while (all.marks.size() < kGroups + kGroups / 3) {
      queue.take(all);
      if (all.marks.size() == marks) continue;
      marks = all.marks.size();
      CHECK(all.marks.back().at == all.points.size());  // no part of a group
    }
  }
  EditBatch rest;
  queue.take(rest);
  CHECK(rest.empty());
  for (std::uint64_t i = 0; i < all.points.size(); ++i) REQUIRE(all.points[i].number == i);
}

TEST_CASE("an edit queue says how much room its reader leaves, and keeps what is appended beyond") {
  EditQueue queue(3'000);
  queue.keep();
  CHECK(queue.room().free == 3'000);
  const auto append = [&](std::size_t count) { queue.append(count, [](std::size_t i) { return numbered(i); }); };
  append(2'000);
  CHECK(queue.room().free == 1'000);
  append(2'000);
  CHECK(queue.room().free == 0);
  EditBatch all;
  queue.take(all);
  CHECK(all.points.size() == 4'000);
  CHECK(queue.room().free == queue.room().capacity);
}

}  // namespace palpate::edit_queue_test
