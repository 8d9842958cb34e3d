#include "engine/io/npy_array.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "engine/core/error.hpp"
#include "engine/io/ends_after.hpp"
#include "engine/io/in_quotes.hpp"
#include "engine/io/text_number.hpp"

namespace palpate {

namespace {

constexpr std::size_t kMaxColumns = 4096;

/// A Python literal, of the kinds that occur in a header.
struct Literal {
  enum class Kind { text, number, truth, list, table } kind = Kind::text;
  std::string text;
  std::uint64_t number = 0;
  std::vector<Literal> items;  ///< of a table: keys and values alternate

  const Literal* find(std::string_view key) const {
    for (std::size_t k = 0; k + 1 < items.size(); k += 2)
      if (items[k].kind == Kind::text && items[k].text == key) return &items[k + 1];
    return nullptr;
  }
};

/// Parses one literal; throws FileError with the byte if it is invalid.
class LiteralText {
 public:
  LiteralText(const std::filesystem::path& file, std::string_view text, std::uint64_t at)
      : file_(file), text_(text), at_(at) {}

  Literal read() {
    Literal literal = value(0);
    if (peek() != '\0') fail("more than one value");
    return literal;
  }
  [[noreturn]] void fail(std::string_view what) const {
    throw FileError::atByte(file_, at_ + next_, fmt::format("the array's description has {}", what));
  }

 private:
  char peek() {
    while (next_ < text_.size() && (text_[next_] == ' ' || text_[next_] == '\n' || text_[next_] == '\t')) ++next_;
    return next_ < text_.size() ? text_[next_] : '\0';
  }

  Literal value(int depth) {
    constexpr int kDeepest = 8;
    const char c = peek();
    if (depth > kDeepest) fail("too many brackets");
    if (c == '\'' || c == '"') return quoted(c);
    if (c == '{') return items('}', Literal::Kind::table, depth);
    if (c == '[') return items(']', Literal::Kind::list, depth);
    if (c == '(') return items(')', Literal::Kind::list, depth);
    const std::size_t end = std::min(text_.find_first_of(" ,:)]}\n\t", next_), text_.size());
    const std::string_view word = text_.substr(next_, end - next_);
    Literal literal;
    if (word == "True" || word == "False") {
      literal = {.kind = Literal::Kind::truth, .text = {}, .number = word == "True", .items = {}};
    } else {
      const std::string_view digits = word.ends_with('L') ? word.substr(0, word.size() - 1) : word;
      const auto number = textNumber<std::uint64_t>(digits);
      if (!number) fail(fmt::format("{}, which is not a value", inQuotes(word)));
      literal = {.kind = Literal::Kind::number, .text = {}, .number = *number, .items = {}};
    }
    next_ = end;
    return literal;
  }

  Literal quoted(char quote) {
    const std::size_t end = text_.find(quote, next_ + 1);
    if (end == text_.npos) fail("a text without an end");
    Literal literal{
        .kind = Literal::Kind::text, .text = std::string(text_.substr(next_ + 1, end - next_ - 1)), .items = {}};
    next_ = end + 1;
    return literal;
  }

  Literal items(char end, Literal::Kind kind, int depth) {
    Literal literal{.kind = kind, .text = {}, .items = {}};
    ++next_;
    while (peek() != end) {
      literal.items.push_back(value(depth + 1));
      if (kind == Literal::Kind::table) {
        if (peek() != ':') fail("a key without a value");
        ++next_;
        literal.items.push_back(value(depth + 1));
      }
      if (peek() == ',')
        ++next_;
      else if (peek() != end)
        fail(fmt::format("no '{}'", end));
    }
    ++next_;
    return literal;
  }

  const std::filesystem::path& file_;
  std::string_view text_;
  std::uint64_t at_;
  std::size_t next_ = 0;
};

/// A parsed type code like `<f4`; only the size for padding (`|V4`).
struct Number {
  NpyColumn column;
  std::uint64_t bytes = 0;
  bool padding = false;
};

Number numberOf(const std::string& code, const LiteralText& text) {
  const std::size_t kindAt = code.find_first_not_of("<>|=");
  const auto bytes = kindAt == code.npos ? std::nullopt : textNumber<std::uint32_t>(code.substr(kindAt + 1));
  if (!bytes) text.fail(fmt::format("the type {}, which is not read", inQuotes(code)));
  Number number{.column = {.swap = code[0] == '>' && *bytes > 1}, .bytes = *bytes};
  const char kind = code[kindAt];
  const bool whole = kind == 'i' || kind == 'u';
  number.padding = kind == 'V';
  if (number.padding) return number;
  const std::string name = kind == 'b' && *bytes == 1 ? "uint8"
                           : kind == 'f' || whole     ? fmt::format("{}{}",
                                                                kind == 'f'   ? "float"
                                                                    : kind == 'i' ? "int"
                                                                                  : "uint",
                                                                    8 * *bytes)
                                                      : "none";
  const auto type = scalarTypeFromPly(name);
  if (!type)
    text.fail(
        fmt::format("the type {}, which is not read; whole numbers are, and floats of 4 or 8 bytes", inQuotes(code)));
  number.column.type = *type;
  return number;
}

/// Throws if a product exceeds any possible file size.
std::uint64_t product(std::uint64_t a, std::uint64_t b, const LiteralText& text) {
  constexpr std::uint64_t kMax = std::uint64_t{1} << 60;
  if (b > 0 && a > kMax / b) text.fail("too many numbers");
  return a * b;
}

std::uint64_t elementsOf(const Literal& shape, const LiteralText& text) {
  std::uint64_t elements = 1;
  for (const Literal& side : shape.items) {
    if (side.kind != Literal::Kind::number) text.fail("a shape that is not of numbers");
    elements = product(elements, side.number, text);
  }
  return elements;
}

/// Names for the elements of a field.
std::string elementName(const std::string& name, std::uint64_t k, std::uint64_t of) {
  static const std::map<std::string_view, std::array<const char*, 3>> kThrees{
      {"position", {"x", "y", "z"}},     {"positions", {"x", "y", "z"}},      {"xyz", {"x", "y", "z"}},
      {"points", {"x", "y", "z"}},       {"normal", {"nx", "ny", "nz"}},      {"normals", {"nx", "ny", "nz"}},
      {"rgb", {"red", "green", "blue"}}, {"color", {"red", "green", "blue"}}, {"colors", {"red", "green", "blue"}}};
  const auto found = kThrees.find(name);
  if (of == 3 && found != kThrees.end()) return found->second[k];
  return of == 1 ? name : fmt::format("{}_{}", name, k);
}

/// Adds the fields of a structure; returns its size in bytes.
std::uint64_t addFields(const Literal& fields, NpyArray& array, const LiteralText& text) {
  std::uint64_t at = 0;
  for (const Literal& field : fields.items) {
    const bool known = field.kind == Literal::Kind::list && field.items.size() >= 2 &&
                       field.items[0].kind == Literal::Kind::text && field.items[1].kind == Literal::Kind::text;
    if (!known) text.fail("a field that is not a name and a type");
    const Number number = numberOf(field.items[1].text, text);
    const std::uint64_t elements = field.items.size() > 2 ? elementsOf(field.items[2], text) : 1;
    if (!number.padding && array.columns.size() + elements > kMaxColumns) text.fail("too many fields");
    for (std::uint64_t k = 0; !number.padding && k < elements; ++k) {
      NpyColumn& column = array.columns.emplace_back(number.column);
      column.name = elementName(field.items[0].text, k, elements);
      column.at = at + k * number.bytes;
    }
    at += product(elements, number.bytes, text);
  }
  for (NpyColumn& column : array.columns) column.stride = at;
  return at;
}

/// Adds the columns of a plain array: its last dimension is that of columns, the others are rows.
std::uint64_t addNumbers(const std::string& code, bool fortran, NpyArray& array, const LiteralText& text) {
  const Number number = numberOf(code, text);
  const bool flat = array.shape.size() < 2;
  const std::uint64_t columns = flat ? 1 : array.shape.back();
  if (number.padding || number.bytes == 0) text.fail("no numbers");
  if (columns > kMaxColumns) text.fail(fmt::format("rows of {} numbers", columns));
  if (fortran && array.shape.size() > 2) text.fail("more than two sides in Fortran order, which is not read");
  if (!flat) array.rows = columns > 0 ? array.rows / columns : 0;
  for (std::uint64_t k = 0; k < columns; ++k) {
    NpyColumn& column = array.columns.emplace_back(number.column);
    column.name = std::to_string(k);
    column.at = number.bytes * (fortran ? k * array.rows : k);
    column.stride = number.bytes * (fortran ? 1 : columns);
  }
  return columns * number.bytes;
}

}  // namespace

std::string NpyArray::shapeText() const {
  std::string text = "(";
  for (std::size_t k = 0; k < shape.size(); ++k) text += fmt::format("{}{}", k > 0 ? ", " : "", shape[k]);
  return text + ")";
}

NpyArray readNpyArray(const std::filesystem::path& name, std::span<const std::byte> file, std::uint64_t at) {
  constexpr std::string_view kMagic("\x93NUMPY", 6);
  const auto* begin = reinterpret_cast<const char*>(file.data());
  if (!std::string_view(begin, std::min<std::size_t>(6, file.size())).starts_with(kMagic))
    throw FileError::atByte(name, at, "not an array of NumPy: it does not begin as one");
  const unsigned version = file.size() > 6 ? std::to_integer<unsigned>(file[6]) : 0;
  const std::size_t headAt = version == 1 ? 10 : 12;
  if (file.size() < headAt) throw FileError::atByte(name, at + file.size(), "ends inside the array's description");
  if (version < 1 || version > 3)
    throw FileError::atByte(name, at + 6, fmt::format("version {} of NumPy's format; 1 to 3 are read", version));
  const std::size_t length =
      version == 1 ? loadScalar<std::uint16_t>(file.data() + 8) : loadScalar<std::uint32_t>(file.data() + 8);
  if (file.size() - headAt < length)
    throw FileError::atByte(name, at + file.size(), "ends inside the array's description");
  LiteralText text(name, std::string_view(begin + headAt, length), at + headAt);
  const Literal head = text.read();
  const Literal *type = head.find("descr"), *order = head.find("fortran_order"), *shape = head.find("shape");
  if (!type || !order || !shape || shape->kind != Literal::Kind::list || order->kind != Literal::Kind::truth)
    text.fail("no 'descr', 'fortran_order' and 'shape'");

  NpyArray array;
  array.rows = elementsOf(*shape, text);
  for (const Literal& side : shape->items) array.shape.push_back(side.number);
  array.structured = type->kind == Literal::Kind::list;
  if (!array.structured && type->kind != Literal::Kind::text) text.fail("an invalid type");
  const std::uint64_t rowBytes =
      array.structured ? addFields(*type, array, text) : addNumbers(type->text, order->number != 0, array, text);
  if (array.structured && rowBytes == 0 && array.rows > 0) text.fail("rows without bytes");
  array.bytes = product(array.rows, rowBytes, text);
  array.data = file.subspan(headAt + length);
  if (array.data.size() < array.bytes)
    throw endsAfter(name, at + file.size(), rowBytes == 0 ? 0 : array.data.size() / rowBytes, array.rows,
                    fmt::format("rows of an array of shape {}", array.shapeText()));
  array.data = array.data.first(array.bytes);
  return array;
}

void loadNpy(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row, std::byte* to) {
  const std::byte* from = data.data() + column.at + row * column.stride;
  const auto put = [&](auto value) { std::memcpy(to, &value, sizeof value); };
  const auto load = [&]<class T>(std::type_identity<T>) {
    return column.swap ? loadScalar<T, true>(from) : loadScalar<T>(from);
  };
  visitScalar(column.type, [&]<class T>(std::type_identity<T> type) { put(load(type)); });
}

double npyValue(const NpyColumn& column, std::span<const std::byte> data, std::uint64_t row) {
  std::array<std::byte, 8> bytes{};
  loadNpy(column, data, row, bytes.data());
  return visitScalar(column.type,
                     [&]<class T>(std::type_identity<T>) { return static_cast<double>(loadScalar<T>(bytes.data())); });
}

}  // namespace palpate
