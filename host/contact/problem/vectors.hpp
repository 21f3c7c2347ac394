/// @file vectors.hpp
/// std::vector with the int64 indices and the views that the stages of the contact solver take.
#pragma once
#include <cstddef>
#include <cstdint>
#include <vector>

#include "kernels/base/view.hpp"

namespace tetwarp {

/// An index or a count as the type that std::vector takes.
inline std::size_t index_of(std::int64_t i) {
  return static_cast<std::size_t>(i);
}

template <class T>
View<const T> view_of(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<T> view_of(std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

}  // namespace tetwarp
