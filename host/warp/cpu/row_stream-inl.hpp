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

#include <algorithm>
#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace tetwarp {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;

/// Collects rows and writes whole cache lines; joins rows that are adjacent in memory.
template <class T>
class RowStream {
 public:
  /// @param longest  largest number of samples of a row
  /// @param margin   samples before a row that pointers may refer to; they are not written
  RowStream(std::ptrdiff_t longest, std::ptrdiff_t margin)
      : margin_((margin + per_line - 1) / per_line * per_line),
        storage_(hwy::AllocateAligned<T>(static_cast<std::size_t>(margin_ + enough + longest))),
        lines_(storage_.get() + margin_) {}

  ~RowStream() { hwy::FlushStream(); }
  RowStream(const RowStream&) = delete;
  RowStream& operator=(const RowStream&) = delete;

  /// @returns where to write the samples that belong at `out`; valid until end_row()
  T* begin_row(T* out) {
    if (out != to_ + size_) {
      flush();
      const auto address = reinterpret_cast<std::uintptr_t>(out);
      is_aligned_ = address % sizeof(T) == 0;
      skipped_ = size_ = static_cast<std::ptrdiff_t>(address % line_bytes / sizeof(T));
      to_ = out - size_;
    }
    return lines_ + size_;
  }

  /// Ends a row of `count` samples.
  void end_row(std::ptrdiff_t count) {
    size_ += count;
    if (size_ >= enough) write_lines();
  }

  void flush() {
    if (is_aligned_) write_lines();
    std::copy(lines_ + skipped_, lines_ + size_, to_ + skipped_);
    to_ = nullptr;
    skipped_ = size_ = 0;
  }

 private:
  static constexpr std::size_t line_bytes = 64;
  static constexpr std::ptrdiff_t per_line = line_bytes / sizeof(T);
  static constexpr std::ptrdiff_t enough = 8 * per_line;  ///< samples to collect before writing

  /// Writes the whole cache lines collected so far.
  void write_lines() {
    if (!is_aligned_) return flush();
    if (size_ < per_line) return;
    std::ptrdiff_t done = 0;
    if (skipped_ > 0) {  // other threads may write to the same cache line
      std::copy(lines_ + skipped_, lines_ + per_line, to_ + skipped_);
      done = per_line;
      skipped_ = 0;
    }
    const hn::CappedTag<T, per_line> d;
    const auto lanes = static_cast<std::ptrdiff_t>(hn::Lanes(d));
    for (; done + per_line <= size_; done += per_line) {
      for (std::ptrdiff_t v = done; v < done + per_line; v += lanes) {
        hn::Stream(hn::Load(d, lines_ + v), d, to_ + v);
      }
    }
    std::copy(lines_ + done, lines_ + size_, lines_);
    to_ += done;
    size_ -= done;
  }

  std::ptrdiff_t margin_;
  hwy::AlignedFreeUniquePtr<T[]> storage_;
  T* lines_;                    ///< samples not written yet
  T* to_ = nullptr;             ///< where lines_[0] belongs, the start of a cache line
  std::ptrdiff_t size_ = 0;     ///< samples in lines_
  std::ptrdiff_t skipped_ = 0;  ///< number of leading samples that belong to no row
  bool is_aligned_ = true;      ///< else `to_` is not the start of a line
};

}  // namespace HWY_NAMESPACE
}  // namespace tetwarp
HWY_AFTER_NAMESPACE();

#endif  // guard
