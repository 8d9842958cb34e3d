#include "engine/edit/undo_list.hpp"

#include <doctest/doctest.h>

#include <string>
#include <variant>

#include "engine/edit/point_states.hpp"

namespace palpate::undo_list_test {

namespace {

// Two kinds of changes: of a number, and of a word.
struct OfNumber {
  int value;
};
struct OfWord {
  std::string value;
};
using Change = std::variant<OfNumber, OfWord>;

std::uint64_t bytesOf(const OfNumber&) { return 10; }
std::uint64_t bytesOf(const OfWord& change) { return 10 + change.value.size(); }
std::uint64_t bytesOf(const Change& change) {
  return std::visit([](const auto& each) { return bytesOf(each); }, change);
}

struct Things {
  int number = 0;
  std::string word;
  UndoList<Change> list{100};

  void make(Change change) {
    list.begin();
    swap(change);
    if (list.makeRoom(bytesOf(change)))
      list.add(std::move(change));
    else
      list.addTooLarge();
  }
  bool undo() {
    return list.undo([this](Change& change) { swap(change); });
  }
  bool redo() {
    return list.redo([this](Change& change) { swap(change); });
  }
  void swap(Change& change) {
    if (auto* const ofNumber = std::get_if<OfNumber>(&change))
      std::swap(number, ofNumber->value);
    else
      std::swap(word, std::get<OfWord>(change).value);
  }
};

}  // namespace

TEST_CASE("changes of two kinds are undone and redone in the order in which they were made") {
  Things things;
  things.make(OfNumber{1});
  things.make(OfWord{"one"});
  things.make(OfNumber{2});
  CHECK(things.list.bytes() == 30);
  CHECK(things.undo());
  CHECK(things.number == 1);
  CHECK(things.word == "one");
  CHECK(things.undo());
  CHECK(things.word.empty());
  CHECK(things.list.bytes() == 33);  // the undone change stores the word
  CHECK(things.redo());
  CHECK(things.word == "one");
  CHECK(things.undo());
  CHECK(things.undo());
  CHECK_FALSE(things.undo());
  CHECK(things.number == 0);
  CHECK(things.list.redoCount() == 3);
  things.make(OfNumber{7});
  CHECK_FALSE(things.redo());
  CHECK(things.list.undoCount() == 1);
  CHECK(things.list.bytes() == 10);
}

TEST_CASE("the memory budget of undo is shared by changes of all kinds") {
  Things things;
  things.make(OfWord{std::string(60, 'a')});
  things.make(OfNumber{1});
  things.make(OfWord{std::string(20, 'b')});
  CHECK(things.list.bytes() == 90);
  CHECK(things.list.dropped() == 0);
  things.make(OfNumber{2});
  CHECK(things.list.bytes() == 100);
  things.make(OfNumber{3});  // drops the first word
  CHECK(things.list.undoCount() == 4);
  CHECK(things.list.dropped() == 1);
  things.word = std::string(200, 'c');
  things.make(OfWord{});
  CHECK(things.list.undoCount() == 0);
  CHECK(things.list.dropped() == 6);
  CHECK(things.list.tooLarge() == 1);
}

TEST_CASE("points that were never set do not exist, and those before a new one are counted as absent") {
  PointStates points(PointCloud{.positions = {Vec3(1), Vec3(2)}});
  CHECK(points[5] == PointState{.id = 5 | PointState::kGone, .parent = 5});
  CHECK(points.size() == 2);
  points.set({.position = Vec3(3), .id = 4});
  CHECK(points.size() == 5);
  CHECK(points.present() == 3);
  CHECK(points[3].gone());
  points.set(PointState{.id = 1 | PointState::kGone});
  points.set(PointState{.id = 1 | PointState::kGone});
  CHECK(points.present() == 2);
}

}  // namespace palpate::undo_list_test
