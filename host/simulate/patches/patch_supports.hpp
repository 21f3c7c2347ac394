/// @file patch_supports.hpp
/// Which contacts of a flat patch of two rigid bodies keep the bodies apart.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// Chooses the corners of a patch; keeps its memory.
///
/// Contacts with one normal, whose gaps are those of two planes, hold two rigid bodies apart where
/// the corners of their convex hull do. Of more than 8 corners those stay that keep most of the
/// hull's area. The nearest contact, within a hundredth of the thickness, is one of those chosen.
class PatchSupports {
 public:
  static constexpr std::size_t most = 8;

  /// @param patch      indices of `contacts`, by key; of similar normals
  /// @param thickness  contact distance [m]
  /// @param chosen     out: those that hold; all of them where the patch is not flat
  void choose(const std::vector<ReportedContact>& contacts,
              const std::vector<std::size_t>& patch,
              double thickness,
              std::vector<std::size_t>& chosen);

 private:
  struct Place {
    double x = 0, y = 0;  ///< across the normal, from the middle of the patch [m]
    double gap = 0;
    std::size_t contact = 0;
  };
  void choose_flat(const std::vector<ReportedContact>& contacts,
                   double thickness,
                   std::vector<std::size_t>& chosen);
  bool is_flat(double tolerance) const;
  void make_hull();
  void cut_corners(std::size_t count);

  std::vector<std::size_t> left_, alike_, next_left_;
  std::vector<Place> places_, hull_;
  double size_ = 0;  ///< of the patch [m]
};

}  // namespace tetwarp
