/// @file vector_view.hpp
/// Arrays of the host as views, which stages read.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "kernels/base/view.hpp"

namespace tetwarp {

template <class T>
View<const T> view_of(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<T> view_of(std::span<T> values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}
template <class T>
View<T> view_of(std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

}  // namespace tetwarp
