/// @file label_shares.hpp
/// Which of many labels has the largest share, in little memory.
#pragma once
#include <cstdint>

#include "kernels/base/hd.hpp"

namespace tetwarp {

/// A label and its share.
struct LabelShare {
  double label;  ///< an integer of at most 32 bits
  double share;
};

/// Sums of the shares of labels. Of more labels than there are places those with the lowest
/// numbers; the others take further passes.
class LabelShares {
 public:
  /// @param above  only labels above it get a place
  TETWARP_HD explicit LabelShares(double above) : above_(above) {}

  TETWARP_HD void add(double label, double share) {
    if (!(label > above_)) return;
    int place = 0;
    while (place < count_ && shares_[place].label != label) ++place;
    if (place == capacity) {
      is_cut_ = true;
      place = place_of_highest();
      if (label > shares_[place].label) return;
      // A label that loses its place is above all others from here on and gets none again.
      shares_[place] = {label, 0};
    } else if (place == count_) {
      shares_[count_++] = {label, 0};
    }
    shares_[place].share += share;
  }

  /// Adds to a label that has a place.
  TETWARP_HD void add_to(double label, double share) {
    for (int n = 0; n < count_; ++n) {
      if (shares_[n].label == label) shares_[n].share += share;
    }
  }

  /// Replaces `winner`, in the order of the labels, by each whose share is larger by more than
  /// `tie`.
  TETWARP_HD void choose(double tie, LabelShare& winner) const {
    double last = above_;
    for (int n = 0; n < count_; ++n) {
      int next = -1;
      for (int m = 0; m < count_; ++m) {
        const bool is_later = shares_[m].label > last;
        if (is_later && (next < 0 || shares_[m].label < shares_[next].label)) next = m;
      }
      last = shares_[next].label;
      if (shares_[next].share > winner.share + tie) winner = shares_[next];
    }
  }

  /// Whether labels above highest() have got no place.
  TETWARP_HD bool is_cut() const { return is_cut_; }
  TETWARP_HD double highest() const { return shares_[place_of_highest()].label; }

 private:
  static constexpr int capacity = 12;

  TETWARP_HD int place_of_highest() const {
    int place = 0;
    for (int n = 1; n < count_; ++n) place = shares_[n].label > shares_[place].label ? n : place;
    return place;
  }

  double above_;
  bool is_cut_ = false;
  int count_ = 0;
  LabelShare shares_[capacity];
};

/// The label with the largest share. Shares that differ by at most `tie` are equal: of equal ones
/// the lowest wins.
/// @param none     the label if there is no share
/// @param tie      below 1
/// @param add_all  add_all(LabelShares&) adds all shares, in the same way each time
template <class AddAll>
TETWARP_HD double label_of_largest_share(double none, double tie, AddAll&& add_all) {
  LabelShare winner = {none, -1};  // below all shares, so that the first label replaces it
  double above = -0x1p63;          // below all labels
  for (bool is_done = false; !is_done;) {
    LabelShares shares(above);
    add_all(shares);
    shares.choose(tie, winner);
    is_done = !shares.is_cut();
    above = shares.highest();
  }
  return winner.label;
}

}  // namespace tetwarp
