/// @file row_stream-inl.hpp
/// Stores of rows of the output that bypass the caches: the rows are not read again soon, and their
/// cache lines need not be loaded before they are written. Included once per vector instruction
/// set.
#if defined(TETWARP_ROW_STREAM_INL) == defined(HWY_TARGET_TOGGLE)
#ifdef TETWARP_ROW_STREAM_INL
#undef TETWARP_ROW_STREAM_INL
#else
#define TETWARP_ROW_STREAM_INL
#endif

#include <hwy/aligned_allocator.h>
#include <hwy/cache_control.h>
#include <hwy/highway.h>

#include <cstddef>
#include <cstdint>
#include <cstring>

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Collects rows and writes whole cache lines; joins rows that are adjacent in memory. Sizes are in
/// bytes.
class RowStream {
 public:
  /// @param sample   size of a sample
  /// @param longest  largest size of a row
  /// @param margin   space before a row that pointers may refer to; it is not written
  RowStream(std::ptrdiff_t sample, std::ptrdiff_t longest, std::ptrdiff_t margin)
      : sample_(sample),
        margin_((margin + line - 1) / line * line),
        storage_(hwy::AllocateAligned<std::uint8_t>(
            static_cast<std::size_t>(margin_ + enough + longest))),
        lines_(storage_.get() + margin_) {}

  ~RowStream() { hwy::FlushStream(); }
  RowStream(const RowStream&) = delete;
  RowStream& operator=(const RowStream&) = delete;

  /// @returns where to write the samples that belong at `out`; valid until end_row()
  template <class T>
  T* begin_row(T* out) {
    return reinterpret_cast<T*>(begin_bytes(reinterpret_cast<std::uint8_t*>(out)));
  }

  /// Ends a row.
  void end_row(std::ptrdiff_t size) {
    size_ += size;
    if (size_ >= enough) write_lines();
  }

  HWY_NOINLINE void flush() {
    if (is_aligned_) write_lines();
    copy(skipped_, size_);
    to_ = nullptr;
    skipped_ = size_ = 0;
  }

 private:
  static constexpr std::ptrdiff_t line = 64;          ///< size of a cache line
  static constexpr std::ptrdiff_t enough = 8 * line;  ///< to collect before writing

  std::uint8_t* begin_bytes(std::uint8_t* out) {
    if (out != to_ + size_) {
      flush();
      const auto in_line =
          static_cast<std::ptrdiff_t>(reinterpret_cast<std::uintptr_t>(out) % line);
      is_aligned_ = in_line % sample_ == 0;
      skipped_ = size_ = in_line - in_line % sample_;
      to_ = out - size_;
    }
    return lines_ + size_;
  }

  /// Writes bytes [begin, end) of `lines_`.
  void copy(std::ptrdiff_t begin, std::ptrdiff_t end) {
    if (begin < end) {
      std::memcpy(to_ + begin, lines_ + begin, static_cast<std::size_t>(end - begin));
    }
  }

  /// Writes the whole cache lines collected so far.
  HWY_NOINLINE void write_lines() {
    if (!is_aligned_) return flush();
    if (size_ < line) return;
    std::ptrdiff_t done = 0;
    if (skipped_ > 0) {  // other threads may write to the same cache line
      copy(skipped_, line);
      done = line;
      skipped_ = 0;
    }
    const hn::CappedTag<std::uint8_t, line> d;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    for (; done + line <= size_; done += line) {
      for (std::ptrdiff_t at = done; at < done + line; at += lanes) {
        hn::Stream(hn::Load(d, lines_ + at), d, to_ + at);
      }
    }
    std::memmove(lines_, lines_ + done, static_cast<std::size_t>(size_ - done));
    to_ += done;
    size_ -= done;
  }

  std::ptrdiff_t sample_;
  std::ptrdiff_t margin_;
  hwy::AlignedFreeUniquePtr<std::uint8_t[]> storage_;
  std::uint8_t* lines_;         ///< samples not written yet
  std::uint8_t* to_ = nullptr;  ///< where lines_[0] belongs, the start of a cache line
  std::ptrdiff_t size_ = 0;     ///< of the samples in lines_
  std::ptrdiff_t skipped_ = 0;  ///< number of leading bytes that belong to no row
  bool is_aligned_ = true;      ///< else `to_` is not the start of a line
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
