/// @file patch_supports.hpp
/// Chooses the contacts of a flat patch of two rigid bodies that are enough to keep the bodies
/// apart.
#pragma once
#include <array>
#include <cstddef>
#include <vector>

#include <tetwarp/contact_tracker.hpp>

namespace tetwarp {

/// Chooses the corners of a patch; keeps its memory.
///
/// Where contacts have one normal and gaps on one plane, contacts at the corners of their
/// convex hull keep two rigid bodies apart. If there are more than 8 corners, those that keep most
/// of the hull's area are chosen. The nearest contact, within a hundredth of the thickness, is
/// always one of those chosen.
class PatchSupports {
 public:
  static constexpr std::size_t most = 8;

  /// @param patch      indices of `contacts`, by key; their normals are similar
  /// @param thickness  contact distance [m]
  /// @param chosen     out: the chosen contacts; all of the patch where it is not flat
  void choose(const std::vector<ReportedContact>& contacts,
              const std::vector<std::size_t>& patch,
              double thickness,
              std::vector<std::size_t>& chosen);

 private:
  struct Place {
    double x = 0, y = 0;  ///< in the plane of the patch, from its centroid [m]
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
