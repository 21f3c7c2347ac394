/// @file vectors.hpp
/// std::vector with the int64 indices and the views that the stages of the contact solver take.
#pragma once
#include <cstdint>
#include <span>
#include <vector>

#include "host/base/index_of.hpp"
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
