#include "engine/edit/undo_list.hpp"

#include <doctest/doctest.h>
#include <fmt/format.h>

#include <fstream>
#include <span>
#include <string>
#include <variant>

#include "engine/core/error.hpp"
#include "engine/edit/point_states.hpp"
#include "tests/scratch_folder.hpp"

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

std::vector<std::byte> pack(const Change& change) {
  std::string text = std::to_string(change.index());
  if (const auto* const ofNumber = std::get_if<OfNumber>(&change))
    text += std::to_string(ofNumber->value);
  else
    text += std::get<OfWord>(change).value;
  const auto bytes = std::as_bytes(std::span(text));
  return {bytes.begin(), bytes.end()};
}
bool unpack(std::span<const std::byte> bytes, Change& change) {
  const std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (text.starts_with('0'))
    change = OfNumber{std::stoi(text.substr(1))};
  else
    change = OfWord{text.substr(1)};
  return true;
}

struct Things {
  int number = 0;
  std::string word;
  UndoList<Change> list{UndoBudget{100}};

  void make(Change change) {
    list.make(std::move(change), [this](Change& made) { swap(made); });
  }
  bool undo() {
    return list.undo([this](Change& change) { return swap(change); });
  }
  bool redo() {
    return list.redo([this](Change& change) { return swap(change); });
  }
  bool swap(Change& change) {
    if (fails) throw Error("no");
    if (refuses) return false;
    if (auto* const ofNumber = std::get_if<OfNumber>(&change))
      std::swap(number, ofNumber->value);
    else
      std::swap(word, std::get<OfWord>(change).value);
    return true;
  }
  bool fails = false, refuses = false;
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

TEST_CASE("a change that fails or is refused leaves the list as it was") {
  Things things;
  things.make(OfNumber{1});
  things.make(OfWord{"one"});
  CHECK(things.undo());
  for (bool* const how : {&things.fails, &things.refuses}) {
    *how = true;
    if (things.fails) {
      CHECK_THROWS_AS(things.undo(), Error);
      CHECK_THROWS_AS(things.redo(), Error);
    } else {
      CHECK_FALSE(things.undo());
      CHECK_FALSE(things.redo());
    }
    *how = false;
    CHECK(things.list.undoCount() == 1);
    CHECK(things.list.redoCount() == 1);
    CHECK(things.list.bytes() == 23);
  }
  CHECK(things.redo());
  CHECK(things.word == "one");
}

TEST_CASE("an entry has its memory before its change is made, undone or redone, and is removed if that fails") {
  Things things;
  const auto isThere = [&](std::size_t undo, std::size_t redo) {
    CHECK(things.list.undoCount() == undo);
    CHECK(things.list.redoCount() == redo);
    return true;
  };
  things.list.make(OfNumber{1}, [&](Change&) { isThere(1, 0); });
  CHECK(things.list.undo([&](Change&) { return isThere(1, 1); }));
  CHECK(things.list.redo([&](Change&) { return isThere(1, 1); }));
  CHECK(things.list.undo([&](Change&) { return isThere(1, 1); }));
  const auto fails = [](Change&) { throw std::bad_alloc(); };
  CHECK_THROWS_AS(things.list.make(OfNumber{2}, fails), std::bad_alloc);
  isThere(0, 1);  // what was undone can still be redone
  CHECK(things.list.bytes() == 10);
}

TEST_CASE("the oldest changes go to the disk, come back in order, and are dropped once that is full, too") {
  const ScratchFolder folder;
  Things things{.list = UndoList<Change>({100, folder.path() / "new", 400})};
  for (int i = 1; i <= 60; ++i) {
    things.make(OfNumber{i});
    things.make(OfWord{fmt::format("{:040}", i)});
  }
  CHECK(things.list.bytes() <= 100);
  CHECK(things.list.undoCount() > 15);
  CHECK(things.list.undoCount() < 60);
  CHECK(things.list.undoCount() + things.list.dropped() == 120);
  CHECK(std::filesystem::is_empty(folder.path() / "new"));  // no other program can open them
  const std::size_t count = things.list.undoCount();
  for (std::size_t i = 0; i < count; ++i) {
    REQUIRE(things.undo());
    CHECK(things.number == 60 - static_cast<int>((i + 1) / 2));
    CHECK(things.word == fmt::format("{:040}", 60 - 1 - static_cast<int>(i / 2)));
  }
  CHECK_FALSE(things.undo());
  CHECK(things.list.bytes() <= 100);
  for (std::size_t i = 0; i < count; ++i) REQUIRE(things.redo());
  CHECK(things.list.bytes() <= 100);
  CHECK(things.number == 60);
  CHECK(things.word == fmt::format("{:040}", 60));
}

TEST_CASE("where the disk takes nothing, the oldest changes are dropped and counted") {
  const ScratchFolder folder;
  std::ofstream(folder / "file") << "no folder";
  Things things{.list = UndoList<Change>({100, folder.path() / "file" / "below", 1 << 20})};
  for (int i = 1; i <= 30; ++i) things.make(OfNumber{i});
  CHECK(things.list.undoCount() == 10);
  CHECK(things.list.dropped() == 20);
  for (int i = 0; i < 10; ++i) CHECK(things.undo());
  CHECK_FALSE(things.undo());
  CHECK(things.number == 20);
}

TEST_CASE("points that were never set do not exist, and those before a new one are counted as absent") {
  PointStates points(PointCloud{.positions = {Vec3(1), Vec3(2)}});
  CHECK(points[5] == PointState{.gone = true, .number = 5, .parent = 5});
  CHECK(points.size() == 2);
  points.set({.position = Vec3(3), .number = 4});
  CHECK(points.size() == 5);
  CHECK(points.present() == 3);
  CHECK(points[3].gone);
  points.set(PointState{.gone = true, .number = 1});
  points.set(PointState{.gone = true, .number = 1});
  CHECK(points.present() == 2);
}

}  // namespace palpate::undo_list_test
