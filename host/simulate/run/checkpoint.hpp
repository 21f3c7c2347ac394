/// @file checkpoint.hpp
/// Bytes of checkpoints, and the fingerprint of what a checkpoint belongs to.
#pragma once
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include <tetwarp/scene.hpp>
#include <tetwarp/simulate.hpp>

#include "host/scene/scene_geometry.hpp"
#include "host/simulate/model/model.hpp"
#include "host/simulate/surfaces/scene_surfaces.hpp"

namespace tetwarp {

/// Appends numbers and arrays of numbers, in the byte order of the machine.
class CheckpointWriter {
 public:
  template <class T>
  void add(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    const auto* bytes = reinterpret_cast<const std::byte*>(&value);
    bytes_.insert(bytes_.end(), bytes, bytes + sizeof(T));
  }
  template <class T>
  void add(const std::vector<T>& list) {
    static_assert(std::is_trivially_copyable_v<T>);
    add(static_cast<std::uint64_t>(list.size()));
    const auto bytes = std::as_bytes(std::span(list));
    bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
  }
  /// One byte, whether there is a value, and the value.
  template <class T>
  void add(const std::optional<T>& value) {
    add(static_cast<std::uint8_t>(value.has_value()));
    if (value) add(*value);
  }
  /// A list whose length the scene does not tell, item by item.
  template <class T, class AddItem>
  void pass_list(const std::vector<T>& list, const AddItem& add_item) {
    add(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) add_item(*this, item);
  }
  template <class T>
  void operator()(const T& value) {
    add(value);
  }
  std::span<const std::byte> bytes() const { return bytes_; }
  std::vector<std::byte> take() { return std::move(bytes_); }

 private:
  std::vector<std::byte> bytes_;
};

/// Reads them back. @throws std::invalid_argument where the bytes end too early or a list has
/// another length than the one it replaces
class CheckpointReader {
 public:
  explicit CheckpointReader(std::span<const std::byte> bytes) : bytes_(bytes) {}

  template <class T>
  void read(T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    std::memcpy(&value, take(sizeof(T)), sizeof(T));
  }
  void read(bool& value) {
    std::uint8_t byte = 0;
    read(byte);
    if (byte > 1) throw std::invalid_argument("checkpoint: damaged, a flag is neither 0 nor 1");
    value = byte != 0;
  }
  /// @param list  of the length that the checkpoint must have
  template <class T>
  void read(std::vector<T>& list) {
    std::uint64_t size = 0;
    read(size);
    if (size != list.size()) {
      throw std::invalid_argument("checkpoint: a list has " + std::to_string(size) +
                                  " entries, the scene needs " + std::to_string(list.size()));
    }
    if (list.empty()) return;
    std::memcpy(list.data(), take(list.size() * sizeof(T)), list.size() * sizeof(T));
  }
  template <class T>
  void read(std::optional<T>& value) {
    std::uint8_t has_value = 0;
    read(has_value);
    value.reset();
    if (has_value != 0) read(value.emplace());
  }
  template <class T, class ReadItem>
  void pass_list(std::vector<T>& list, const ReadItem& read_item) {
    std::uint64_t size = 0;
    read(size);
    if (size > bytes_.size()) {  // an item has a byte at least
      throw std::invalid_argument("checkpoint: incomplete, a list of " + std::to_string(size) +
                                  " entries expected");
    }
    list.assign(static_cast<std::size_t>(size), T{});
    for (T& item : list) read_item(*this, item);
  }
  template <class T>
  void operator()(T& value) {
    read(value);
  }
  bool is_at_end() const { return bytes_.empty(); }

 private:
  const std::byte* take(std::size_t count) {
    if (count > bytes_.size()) {
      throw std::invalid_argument("checkpoint: incomplete, " + std::to_string(count) +
                                  " more bytes expected, got " + std::to_string(bytes_.size()));
    }
    const std::byte* begin = bytes_.data();
    bytes_ = bytes_.subspan(count);
    return begin;
  }

  std::span<const std::byte> bytes_;
};

/// A hash of bytes, which a checkpoint ends with.
std::uint64_t checksum_of(std::span<const std::byte> bytes);

/// A hash of all that the results of a simulation depend on: the numbers of the model, of surfaces
/// and contact materials, of what drives them, and of how steps are solved. Equal for equal scenes
/// and options; threads, the device and work that is skipped are not part of it.
std::uint64_t fingerprint_of(const Scene& scene,
                             const SceneGeometry& geometry,
                             const SimulateOptions& options,
                             const Model& model,
                             const SceneSurfaces& surfaces);

}  // namespace tetwarp
