/// @file table.hpp
/// Rows of structs as a dict of arrays, one array per member, and back.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "python/arrays.hpp"

namespace tetwarp::python {

/// How a member is stored: its number type, and how many numbers it has.
template <class Member>
struct ColumnOf {
  using Number = Member;
  static constexpr std::size_t width = 1;
};
template <>
struct ColumnOf<bool> {
  using Number = std::uint8_t;
  static constexpr std::size_t width = 1;
};
template <class T, std::size_t size>
struct ColumnOf<std::array<T, size>> {
  using Number = T;
  static constexpr std::size_t width = size;
};
template <std::size_t size>
struct ColumnOf<std::array<std::array<double, size>, size>> {
  using Number = double;
  static constexpr std::size_t width = size * size;
};

/// Sets a member of each row from the array of its name; without one the member keeps its default.
/// @param field  gives a reference to the member of a row
/// @throws std::invalid_argument  the array has other numbers of rows or columns, or another type
template <class Row, class Field>
void read_column(const nb::dict& table, const char* name, std::vector<Row>& rows, Field field) {
  using Member = std::remove_cvref_t<decltype(field(rows.front()))>;
  using Number = typename ColumnOf<Member>::Number;
  constexpr std::size_t width = ColumnOf<Member>::width;
  if (!table.contains(name)) return;
  In<Number> numbers;
  const bool is_taken = nb::try_cast(table[name], numbers, false);
  if (!is_taken || numbers.size() != rows.size() * width) {
    throw std::invalid_argument(std::string(name) + ": expected " +
                                std::to_string(rows.size() * width) + " numbers of " +
                                std::to_string(8 * sizeof(Number)) + " bits, " +
                                (std::is_floating_point_v<Number> ? "float" : "integer"));
  }
  for (std::size_t r = 0; r < rows.size(); ++r) {
    Member& member = field(rows[r]);
    if constexpr (std::is_same_v<Member, bool>) {
      member = numbers.data()[r] != 0;
    } else {
      static_assert(std::is_trivially_copyable_v<Member> &&
                    sizeof(Member) == width * sizeof(Number));
      std::memcpy(static_cast<void*>(&member), numbers.data() + r * width, sizeof(Member));
    }
  }
}

/// Adds the member of all rows as an array, of shape (rows,) or (rows, numbers).
template <class Row, class Field>
void write_column(nb::dict& table, const char* name, const std::vector<Row>& rows, Field field) {
  using Member = std::remove_cvref_t<decltype(field(rows.front()))>;
  using Number = typename ColumnOf<Member>::Number;
  constexpr std::size_t width = ColumnOf<Member>::width;
  std::vector<Number> numbers(rows.size() * width);
  for (std::size_t r = 0; r < rows.size(); ++r) {
    const Member& member = field(rows[r]);
    if constexpr (std::is_same_v<Member, bool>) {
      numbers[r] = member ? 1 : 0;
    } else {
      std::memcpy(numbers.data() + r * width, &member, sizeof(Member));
    }
  }
  if constexpr (width == 1) {
    table[name] = array_of(std::move(numbers));
  } else {
    table[name] = array_of<Number>(std::move(numbers), {rows.size(), width});
  }
}

}  // namespace tetwarp::python
