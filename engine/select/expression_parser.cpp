// The parser of expressions: recursive descent (Aho, Lam, Sethi and Ullman 2007, section 4.4), which emits the steps of
// a stack machine whose stack is a row of registers.
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <cstring>
#include <functional>
#include <optional>
#include <string>

#include "engine/core/characters.hpp"
#include "engine/core/unknown_name.hpp"
#include "engine/select/expression.hpp"

namespace palpate {

namespace {

using Operation = Expression::Operation;
using Kind = Expression::Kind;

constexpr int kMaxDepth = 200;             // of parentheses, signs and calls within each other
constexpr std::size_t kMaxText = 100'000;  // characters

struct Function {
  std::string_view name;
  Operation operation;
  int arguments;
  bool keepsWhole;
};
constexpr std::array<Function, 5> kFunctions{{{"abs", Operation::abs, 1, true},
                                              {"sqrt", Operation::sqrt, 1, false},
                                              {"floor", Operation::floor, 1, false},
                                              {"min", Operation::min, 2, true},
                                              {"max", Operation::max, 2, true}}};

struct Comparison {
  std::string_view sign;
  Operation operation;
  bool swaps;  // its sides
};
constexpr std::array<Comparison, 6> kComparisons{{{"<=", Operation::lessOrEqual, false},
                                                  {">=", Operation::lessOrEqual, true},
                                                  {"==", Operation::equal, false},
                                                  {"!=", Operation::notEqual, false},
                                                  {"<", Operation::less, false},
                                                  {">", Operation::less, true}}};

// Registers are counted from 0 within their use, and get their final numbers at the end.
enum class Use : std::uint32_t { constant, read, temporary };
constexpr unsigned kUseShift = 30;
constexpr std::uint32_t registerOf(Use use, std::uint32_t index) {
  return static_cast<std::uint32_t>(use) << kUseShift | index;
}

struct Literal {
  double number = 0;
  std::optional<Whole> whole;  // if it is one
};

struct Operand {
  Kind kind = Kind::number;
  std::uint32_t at = 0;            // register, unless it is a literal
  std::optional<Literal> literal;  // a constant that no register holds yet
  bool isSingle = false;           // a field of float32
  std::size_t begin = 0;           // in the text

  bool isTemporary() const { return !literal && at >> kUseShift == static_cast<std::uint32_t>(Use::temporary); }
};

class Parser {
 public:
  Parser(std::string_view name, std::string_view text, std::size_t begin, CloudFields& fields)
      : name_(name), text_(text), at_(begin), fields_(fields) {}

  ParsedExpression parse(bool truth) {
    if (text_.size() > kMaxText) fail(0, fmt::format("the text is longer than {} characters", kMaxText));
    peek();
    const std::size_t begin = at_;
    Operand result = truth ? disjunction() : sum();
    const std::string_view next = peek();
    const bool ends = at_ == text_.size() || (!truth && next == "if");
    if (!ends && !truth && isComparing(next))
      fail(at_, fmt::format("a number is expected, not a comparison '{}'", next));
    if (!ends) fail(at_, fmt::format("'{}' is not expected after '{}'", next, last_));
    if (truth && result.kind != Kind::truth)
      fail(begin, "a condition is expected, and this is a number; compare it, as in z > 3");
    if (!truth && result.kind == Kind::truth) fail(begin, "a number is expected, and this is a condition");
    if (result.literal && result.literal->whole) result.kind = Kind::whole;
    settle(result);
    program_.kind = result.kind;
    program_.result = result.at;
    finish();
    for (const Expression::Read& read : program_.reads) fields_.compute(read.field);
    return {std::move(program_), at_};
  }

 private:
  [[noreturn]] void fail(std::size_t at, const std::string& what) const {
    throw ExpressionError(name_, "column {}: {}", charactersOf(text_.substr(0, at)).size() + 1, what);
  }
  [[noreturn]] void failForValue() const {
    std::string what = "a value is expected";
    if (!last_.empty()) what += fmt::format(" after '{}'", last_);
    if (const std::string_view next = peek(); !next.empty()) what += fmt::format(", not '{}'", next);
    fail(at_, fmt::format("{}; fields: {}", what, fmt::join(fields_.names(), ", ")));
  }
  static bool isComparing(std::string_view sign) {
    for (const Comparison& each : kComparisons)
      if (each.sign == sign) return true;
    return false;
  }

  // Text.
  static bool isLetter(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_' || static_cast<unsigned char>(c) >= 0x80;
  }
  static bool isDigit(char c) { return c >= '0' && c <= '9'; }
  // The next word or sign.
  std::string_view peek() const {
    while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\n')) ++at_;
    const std::string_view rest = text_.substr(at_);
    if (rest.empty()) return rest;
    std::size_t length = 1;
    if (isLetter(rest[0])) {
      while (length < rest.size() && (isLetter(rest[length]) || isDigit(rest[length]) || rest[length] == '.')) ++length;
    } else if (isDigit(rest[0]) || rest[0] == '.') {
      double ignored = 0;
      const char* const end = std::from_chars(rest.data(), rest.data() + rest.size(), ignored).ptr;
      length = std::max<std::size_t>(1, static_cast<std::size_t>(end - rest.data()));
    } else if (rest[0] == '"' || rest[0] == '\'') {
      const std::size_t end = rest.find(rest[0], 1);
      if (end == rest.npos) fail(at_, fmt::format("the name that begins with {} has no end", rest[0]));
      length = end + 1;
    } else {
      for (const std::string_view sign : {"<=", ">=", "==", "!=", "&&", "||"})
        if (rest.starts_with(sign)) length = 2;
    }
    return rest.substr(0, length);
  }
  std::string_view advance() {
    last_ = peek();
    at_ += last_.size();
    return last_;
  }
  bool accepts(std::string_view sign) {
    if (peek() != sign) return false;
    advance();
    return true;
  }
  bool acceptsEither(std::string_view sign, std::string_view other) { return accepts(sign) || accepts(other); }

  // Registers.
  std::uint32_t& live(Kind kind) { return live_[static_cast<std::size_t>(kind)]; }
  void drop(const Operand& operand) { live(operand.kind) -= operand.isTemporary() ? 1 : 0; }
  std::uint32_t fresh(Kind kind) {
    const std::uint32_t index = live(kind)++;
    std::uint32_t& most = temporaries_[static_cast<std::size_t>(kind)];
    most = std::max(most, index + 1);
    return registerOf(Use::temporary, index);
  }
  template <class T>
  static std::uint32_t constant(std::vector<T>& all, T value) {
    const auto same = [&](const T& other) { return std::memcmp(&other, &value, sizeof(T)) == 0; };
    const auto found = std::ranges::find_if(all, same);
    const auto index = static_cast<std::uint32_t>(found - all.begin());
    if (found == all.end()) all.push_back(value);
    return registerOf(Use::constant, index);
  }
  // Gives a literal a register.
  void settle(Operand& operand) {
    if (!operand.literal) return;
    operand.at = operand.kind == Kind::whole ? constant(program_.wholes, *operand.literal->whole)
                                             : constant(program_.numbers, operand.literal->number);
    operand.literal.reset();
  }
  void emit(Operand& to, Operation operation, Kind kind, const Operand& a, const Operand& b, Kind result) {
    drop(a);
    if (&a != &b) drop(b);
    const std::uint32_t from[2]{a.at, b.at};
    to.at = fresh(result);
    to.kind = result;
    to.isSingle = false;
    program_.steps.push_back({operation, kind, to.at, from[0], from[1]});
  }
  void becomeNumber(Operand& operand) {
    if (operand.kind != Kind::whole) return;
    if (operand.literal)
      operand.kind = Kind::number;
    else
      emit(operand, Operation::toNumber, Kind::whole, operand, operand, Kind::number);
  }
  // Both become whole numbers if each is one, in a field or as a literal; else both become numbers.
  Kind join(Operand& a, Operand& b) {
    const auto canBeWhole = [](const Operand& x) { return x.kind == Kind::whole || (x.literal && x.literal->whole); };
    const bool whole = (a.kind == Kind::whole || b.kind == Kind::whole) && canBeWhole(a) && canBeWhole(b);
    for (Operand* const each : {&a, &b})
      if (!whole)
        becomeNumber(*each);
      else if (each->literal)
        each->kind = Kind::whole;
    settle(a), settle(b);
    return whole ? Kind::whole : Kind::number;
  }
  void requireNumber(const Operand& operand, std::string_view sign) const {
    if (operand.kind == Kind::truth)
      fail(operand.begin, fmt::format("'{}' is of numbers, and this is a condition; conditions are joined as in "
                                      "1 < z && z < 3",
                                      sign));
  }
  void requireTruth(const Operand& operand, std::string_view sign) const {
    if (operand.kind != Kind::truth)
      fail(operand.begin, fmt::format("'{}' is of conditions, and this is a number; compare it, as in z > 3", sign));
  }

  // Grammar, from the weakest binding on.
  Operand disjunction() {
    Operand left = conjunction();
    while (acceptsEither("||", "|")) left = joined(std::move(left), Operation::either, &Parser::conjunction);
    return left;
  }
  Operand conjunction() {
    Operand left = comparison();
    while (acceptsEither("&&", "&")) left = joined(std::move(left), Operation::both, &Parser::comparison);
    return left;
  }
  Operand joined(Operand left, Operation operation, Operand (Parser::*next)()) {
    const std::string_view sign = last_;
    requireTruth(left, sign);
    Operand right = (this->*next)();
    requireTruth(right, sign);
    emit(left, operation, Kind::truth, left, right, Kind::truth);
    return left;
  }
  Operand comparison() {
    Operand left = sum();
    for (const Comparison* found = comparisonNext(); found; found = comparisonNext()) {
      advance();
      requireNumber(left, found->sign);
      Operand right = sum();
      requireNumber(right, found->sign);
      // As in the file: 0.1 as float32 is not 0.1.
      const auto roundLike = [](Operand& literal, const Operand& field) {
        if (literal.literal && field.isSingle)
          literal.literal->number = static_cast<double>(static_cast<float>(literal.literal->number));
      };
      roundLike(left, right), roundLike(right, left);
      const Kind kind = join(left, right);
      const Operand first = found->swaps ? right : left, second = found->swaps ? left : right;
      emit(left, found->operation, kind, first, second, Kind::truth);
    }
    return left;
  }
  const Comparison* comparisonNext() const {
    const std::string_view next = peek();
    for (const Comparison& each : kComparisons)
      if (each.sign == next) return &each;
    if (next == "=") fail(at_, "'=' does not compare; equality is ==");
    return nullptr;
  }
  Operand sum() {
    Operand left = term();
    for (std::string_view next = peek(); next == "+" || next == "-"; next = peek())
      left = calculated(std::move(left), next == "+" ? Operation::add : Operation::subtract, &Parser::term);
    return left;
  }
  Operand term() {
    Operand left = factor();
    for (std::string_view next = peek(); next == "*" || next == "/" || next == "%"; next = peek())
      left = calculated(std::move(left),
                        next == "*"   ? Operation::multiply
                        : next == "/" ? Operation::divide
                                      : Operation::modulo,
                        &Parser::factor);
    return left;
  }
  Operand calculated(Operand left, Operation operation, Operand (Parser::*next)()) {
    const std::string_view sign = advance();
    requireNumber(left, sign);
    Operand right = (this->*next)();
    requireNumber(right, sign);
    calculate(left, operation, right);
    return left;
  }
  // Constants stay constants, so that a sum of whole numbers is compared exactly.
  static bool isFolded(Literal& left, Operation operation, const Literal& right) {
    const auto fold = [&](auto exact, auto rounded) {
      Whole result = 0;
      const bool isExact = left.whole && right.whole && !exact(*left.whole, *right.whole, &result);
      left = {rounded(left.number, right.number), isExact ? std::optional(result) : std::nullopt};
      return true;
    };
    if (operation == Operation::add)
      return fold([](Whole a, Whole b, Whole* to) { return __builtin_add_overflow(a, b, to); }, std::plus<>());
    if (operation == Operation::subtract)
      return fold([](Whole a, Whole b, Whole* to) { return __builtin_sub_overflow(a, b, to); }, std::minus<>());
    if (operation == Operation::multiply)
      return fold([](Whole a, Whole b, Whole* to) { return __builtin_mul_overflow(a, b, to); }, std::multiplies<>());
    return false;
  }
  // left = left, operation, right
  void calculate(Operand& left, Operation operation, Operand& right) {
    if (left.literal && right.literal && isFolded(*left.literal, operation, *right.literal)) return;
    // A remainder by zero is NaN, which no whole number is.
    const bool divides =
        operation == Operation::modulo && !(right.literal && right.literal->whole && *right.literal->whole != 0);
    if (operation == Operation::divide || divides) becomeNumber(left), becomeNumber(right);
    if (operation == Operation::divide || divides)
      for (Operand* const each : {&left, &right})
        if (each->literal) each->literal->whole.reset();
    const Kind kind = join(left, right);
    emit(left, operation, kind, left, right, kind);
  }

  Operand factor() {
    if (++depth_ > kMaxDepth)
      fail(at_, fmt::format("more than {} parentheses and signs are within each other", kMaxDepth));
    Operand result = primary();
    --depth_;
    return result;
  }
  Operand primary() {
    const std::string_view next = peek();
    const std::size_t begin = at_;
    if (next == "(") return inParentheses();
    if (next == "-" || next == "+") return withSign();
    if (next == "!") {
      advance();
      Operand inside = factor();
      if (inside.kind != Kind::truth) fail(begin, "'!' is of a condition; write it in parentheses, as in !(z > 3)");
      emit(inside, Operation::invert, Kind::truth, inside, inside, Kind::truth);
      inside.begin = begin;
      return inside;
    }
    if (next.empty() || next == "if") failForValue();
    if (isDigit(next[0]) || (next[0] == '.' && next.size() > 1)) return literal();
    if (isLetter(next[0]) || next[0] == '"' || next[0] == '\'') return named();
    failForValue();
  }
  Operand inParentheses() {
    const std::size_t begin = at_;
    advance();
    Operand inside = disjunction();
    if (!accepts(")"))
      fail(at_,
           fmt::format("')' is expected for the '(' in column {}", charactersOf(text_.substr(0, begin)).size() + 1));
    inside.begin = begin;
    inside.isSingle = false;
    return inside;
  }
  Operand withSign() {
    const std::size_t begin = at_;
    const std::string_view sign = advance();
    Operand inside = factor();
    requireNumber(inside, sign);
    inside.begin = begin;
    if (sign == "+") return inside;
    if (inside.literal) {
      inside.literal->number = -inside.literal->number;
      if (inside.literal->whole) inside.literal->whole = -*inside.literal->whole;
    } else {
      emit(inside, Operation::negate, inside.kind, inside, inside, inside.kind);
    }
    return inside;
  }
  Operand literal() {
    Operand result{.begin = at_};
    const std::string_view digits = advance();
    Literal& value = result.literal.emplace();
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value.number);
    if (error != std::errc() || end != digits.data() + digits.size())
      fail(result.begin, fmt::format("'{}' is not a number, or too large or too small", digits));
    // Digits alone are exact; so is a number as 1e6, whose double is whole.
    constexpr std::size_t kMaxDigits = 30;
    if (digits.size() <= kMaxDigits && std::ranges::all_of(digits, isDigit)) {
      value.whole = 0;
      for (const char digit : digits) value.whole = *value.whole * 10 + (digit - '0');
    } else if (std::floor(value.number) == value.number && value.number < 0x1p100) {
      value.whole = static_cast<Whole>(value.number);
    }
    return result;
  }
  Operand named() {
    Operand result{.begin = at_};
    std::string_view word = advance();
    if (isLetter(word[0]) && peek() == "(") return called(word, result.begin);
    if (!isLetter(word[0])) word = word.substr(1, word.size() - 2);
    const auto field = fields_.find(word);
    if (!field) fail(result.begin, unknownName("field", word, fields_.names()));
    const CloudFields::Field& facts = fields_.all()[*field];
    result.kind = facts.isWhole ? Kind::whole : Kind::number;
    result.isSingle = facts.isSingle;
    auto& reads = program_.reads;
    auto found = std::ranges::find(reads, *field, &Expression::Read::field);
    if (found == reads.end()) {
      std::uint32_t& count = reads_[static_cast<std::size_t>(result.kind)];
      found = reads.insert(reads.end(), {*field, result.kind, registerOf(Use::read, count++)});
    }
    result.at = found->to;
    return result;
  }
  Operand called(std::string_view word, std::size_t begin) {
    const auto found = std::ranges::find(kFunctions, word, &Function::name);
    if (found == kFunctions.end()) {
      std::vector<std::string> names;
      for (const Function& each : kFunctions) names.emplace_back(each.name);
      fail(begin, unknownName("function", word, names));
    }
    advance();  // the parenthesis
    Operand result = argument(*found);
    for (int more = 1; more < found->arguments; ++more) {
      if (!accepts(",")) fail(at_, fmt::format("',' is expected: {} is of {} numbers", word, found->arguments));
      Operand next = argument(*found);
      calculate(result, found->operation, next);
    }
    if (!accepts(")"))
      fail(at_,
           fmt::format("')' is expected after {} of {}", found->arguments == 1 ? "the number" : "the numbers", word));
    if (found->arguments == 1) {
      if (!found->keepsWhole) becomeNumber(result);
      settle(result);
      emit(result, found->operation, result.kind, result, result, result.kind);
    }
    result.begin = begin;
    result.isSingle = false;
    return result;
  }
  Operand argument(const Function& function) {
    Operand result = sum();
    requireNumber(result, function.name);
    return result;
  }

  // Final registers: constants, then what is read, then temporaries.
  void finish() {
    const std::array<std::size_t, 3> constants{program_.numbers.size(), program_.wholes.size(), 0};
    const auto number = [&](std::uint32_t& at, Kind kind) {
      const auto k = static_cast<std::size_t>(kind);
      const auto use = static_cast<Use>(at >> kUseShift);
      const std::size_t before = use == Use::constant ? 0 : constants[k] + (use == Use::read ? 0 : reads_[k]);
      at = static_cast<std::uint32_t>(before) + (at & ((1u << kUseShift) - 1));
    };
    for (std::size_t k = 0; k < 3; ++k)
      program_.registers[k] = static_cast<std::uint32_t>(constants[k]) + reads_[k] + temporaries_[k];
    for (Expression::Read& read : program_.reads) number(read.to, read.kind);
    for (Expression::Step& step : program_.steps) {
      const bool compares = step.operation >= Operation::less && step.operation <= Operation::notEqual;
      number(step.to, compares ? Kind::truth : step.operation == Operation::toNumber ? Kind::number : step.kind);
      number(step.a, step.kind);
      number(step.b, step.kind);
    }
    number(program_.result, program_.kind);
  }

  std::string_view name_, text_;
  mutable std::size_t at_;  // spaces are passed when the next word is looked at
  CloudFields& fields_;
  std::string_view last_;  // the last word or sign
  int depth_ = 0;
  Expression program_;
  std::array<std::uint32_t, 3> live_{}, temporaries_{}, reads_{};  // by kind
};

}  // namespace

ParsedExpression parseExpression(std::string_view name, std::string_view text, std::size_t begin, bool truth,
                                 CloudFields& fields) {
  return Parser(name, text, begin, fields).parse(truth);
}

}  // namespace palpate
