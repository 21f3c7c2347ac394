/// @file phantom_torso.cpp
/// The torso of the phantom, organ by organ. Gray levels are those of a CT with contrast agent.
#include "host/make/phantom_torso.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "host/make/phantom_organs.hpp"
#include "host/make/phantom_shapes.hpp"

namespace tetwarp {
namespace {
using std::numbers::pi;

constexpr double air = 0.04;
constexpr double lung = 0.13;
constexpr double fat = 0.26;
constexpr double gut = 0.40;
constexpr double muscle = 0.46;
constexpr double cartilage = 0.56;
constexpr double marrow = 0.54;
constexpr double bone = 0.76;
constexpr double vein = 0.60;
constexpr double artery = 0.94;

constexpr std::array<double, 2> both_sides{-1, 1};

/// y of the middle of the spine at height z: curved to the back in the chest, to the front below.
double spine_y(double z) {
  return 53 + 7 * std::cos(pi * (z - 55) / 140);
}

/// A point of the rib cage, an egg shape around the lungs.
/// @param side  -1 right, 1 left
/// @param turn  angle around the body, 0 at the spine, pi at the sternum
Point3 rib_cage(double side, double z, double turn) {
  const double height = (z - 22) / 150;
  const double width = std::sqrt(std::max(1 - height * height, 0.05));
  return {side * 139 * width * std::sin(turn), 4 + 84 * width * std::cos(turn), z};
}

void add_belly(Organs& organs) {
  organs.ellipsoid(fat, {0, -8, -95}, {112, 66, 82});
  for (const double side : both_sides) {
    organs.tube(muscle, {{side * 30, 44, -50}, {side * 36, 40, -105}, {side * 58, 18, -172}}, 11,
                17);
  }
  // Loops of gut: two layers of a meandering tube, and the colon around them.
  std::vector<Point3> loops;
  for (int turn = 0; turn < 9; ++turn) {
    const double z = -92 - 9 * turn;
    const double reach = 46 + 8 * std::sin(1.9 * turn);
    const double way = turn % 2 == 0 ? 1 : -1;
    loops.push_back({-way * reach, -14 + 14 * std::cos(2.3 * turn), z});
    loops.push_back({way * 0.25 * reach, -12 + 16 * std::sin(1.3 * turn), z - 6});
  }
  organs.tube(gut, loops, 10, 10);
  organs.tube(0.33, loops, 5, 5);
  const std::vector<Point3> colon{{-84, 4, -160}, {-88, 0, -112}, {-62, -36, -96}, {0, -52, -104},
                                  {62, -38, -88}, {90, 4, -104},  {88, 10, -160}};
  organs.tube(gut + 0.04, colon, 15, 13);
  organs.tube(0.20, colon, 9, 7);
}

void add_lungs(Organs& organs) {
  const Ellipsoid right{{-68, 6, 32}, {54, 70, 102}, 0.13};
  const Ellipsoid left{{70, 6, 34}, {51, 68, 98}, -0.13};
  organs.ellipsoid(fat, {0, 2, 40}, {34, 52, 100});
  for (const Ellipsoid& side : {right, left}) organs.add(side, lung);
  for (const double side : both_sides) {
    const Tree vessels{side < 0 ? right : left, 0.68, 0.82, 8};
    const Point3 hilum{side * 26, 12, 50};
    const std::uint64_t branch = side < 0 ? 64 : 68;
    organs.tree(vessels, hilum, {side * 0.70, 0.1, 0.7}, 27, 5.2, branch);
    organs.tree(vessels, hilum, {side * 0.85, -0.4, 0.05}, 26, 5, branch + 1);
    organs.tree(vessels, hilum, {side * 0.55, 0.45, -0.8}, 29, 5.4, branch + 2);
  }
}

void add_airways(Organs& organs) {
  const std::vector<Point3> trachea{{0, 22, 178}, {0, 26, 110}, {0, 24, 74}};
  const auto bronchus = [](double side) {
    return std::vector<Point3>{{0, 24, 76}, {side * 14, 20, 62}, {side * 36, 12, 52}};
  };
  organs.tube(gut, trachea, 9.5, 9);
  for (const double side : both_sides) organs.tube(gut, bronchus(side), 8, 5.5);
  organs.tube(air, trachea, 7.2, 6.8);
  for (const double side : both_sides) organs.tube(air, bronchus(side), 5.8, 3.5);
}

void add_upper_belly(Organs& organs) {
  const Ellipsoid liver{{-50, -2, -36}, {68, 66, 56}, -0.25};
  // Liver: left lobe, right lobe, vessels; gallbladder.
  organs.ellipsoid(0.55, {10, -30, -30}, {56, 34, 28}, 0.35);
  organs.add(liver, 0.55);
  const Tree portal{liver, 0.68, 0.80, 6};
  organs.tree(portal, {-18, 6, -50}, {-0.9, -0.1, 0.25}, 26, 5, 72);
  organs.tree(portal, {-16, 10, 4}, {-0.8, -0.2, -0.5}, 24, 4.5, 73);
  organs.ellipsoid(0.36, {-38, -50, -82}, {11, 12, 20}, -0.3);
  // Stomach: wall, content, bubble. Spleen. Pancreas.
  organs.ellipsoid(0.50, {58, -14, -36}, {44, 40, 40}, -0.4);
  organs.ellipsoid(0.36, {58, -14, -36}, {39, 35, 35}, -0.4);
  organs.ellipsoid(air, {60, -26, -26}, {27, 19, 20}, -0.4);
  organs.ellipsoid(0.60, {97, 32, -36}, {22, 36, 42}, -0.25);
  organs.tube(0.52, {{-26, -4, -84}, {10, 2, -76}, {52, 16, -62}}, 10, 7);
  for (const double side : both_sides) {  // kidneys: cortex, medulla, pelvis
    organs.ellipsoid(0.74, {side * 61, 42, -92 + 5 * side}, {23, 20, 41}, side * -0.2);
    organs.ellipsoid(0.60, {side * 58, 40, -92 + 5 * side}, {14, 12, 29}, side * -0.2);
    organs.ellipsoid(fat, {side * 48, 38, -92 + 5 * side}, {9, 8, 14}, side * -0.2);
  }
}

void add_heart(Organs& organs) {
  // Fat around it, muscle.
  organs.ellipsoid(fat, {22, -20, 16}, {55, 46, 55}, -0.6);
  organs.ellipsoid(0.52, {22, -20, 16}, {53, 44, 53}, -0.6);
  // Right ventricle and atrium, left ventricle and atrium.
  organs.ellipsoid(vein, {-4, -34, 14}, {24, 24, 36}, -0.5);
  organs.ellipsoid(vein, {-18, -12, 28}, {18, 22, 24});
  organs.ellipsoid(artery, {34, -16, 6}, {20, 22, 36}, -0.6);
  organs.ellipsoid(artery - 0.04, {14, 14, 30}, {26, 17, 20});
}

void add_great_vessels(Organs& organs) {
  // Upper and lower vena cava, right and left pulmonary artery, jugular veins.
  organs.tube(vein, {{-20, -8, 112}, {-22, -6, 70}, {-18, -8, 36}}, 8.5, 9);
  organs.tube(vein, {{-18, 0, 8}, {-16, 12, -30}, {-15, 22, -100}, {-24, 34, -135}}, 9, 10);
  organs.tube(vein, {{6, -36, 40}, {10, -28, 58}, {2, -4, 60}, {-30, 8, 54}}, 10, 7);
  organs.tube(vein, {{10, -22, 60}, {22, 0, 62}, {34, 12, 54}}, 9, 7);
  for (const double side : both_sides) {
    organs.tube(vein, {{side * 16, 0, 112}, {side * 26, 4, 140}, {side * 32, 8, 178}}, 6, 5.5);
  }
  // The aorta, from its root over the arch and down before the spine.
  const auto before_spine = [](double z) { return Point3{13, spine_y(z) - 26, z}; };
  organs.tube(artery,
              {{12, -18, 36},
               {-4, -20, 64},
               {-4, -8, 88},
               {8, 12, 97},
               {18, 28, 84},
               before_spine(40),
               before_spine(-20),
               before_spine(-70),
               {3, 32, -112}},
              12.5, 9);
  // To the head, to the arms, to the kidneys, to the legs.
  for (const double side : both_sides) {
    organs.tube(artery,
                {{2 + 8 * side, 4 + 4 * side, 92}, {side * 17, 8, 130}, {side * 22, 12, 178}}, 4.6,
                4);
    organs.tube(
        artery,
        {{8 * side + 3, 4, 94}, {side * 40, 2, 124}, {side * 84, 4, 121}, {side * 140, 10, 100}}, 5,
        3.6);
    organs.tube(artery, {{8, 26, -82}, {side * 28, 34, -86}, {side * 50, 38, -92 + 5 * side}}, 3.6,
                2.8);
    organs.tube(artery, {{3, 32, -110}, {side * 22, 26, -138}, {side * 52, 2, -178}}, 6.6, 5);
  }
  // To the liver, to the spleen, to the gut.
  organs.tube(artery, {{10, 22, -56}, {0, 6, -58}, {-24, 6, -50}}, 3.6, 2.6);
  organs.tube(artery, {{10, 22, -58}, {36, 10, -54}, {84, 28, -40}}, 3.6, 2.8);
  organs.tube(artery, {{9, 22, -68}, {4, 0, -92}, {-14, -14, -136}}, 3.8, 2.2);
}

void add_spine(Organs& organs) {
  for (int vertebra = 0; vertebra < 14; ++vertebra) {
    const double z = -118 + 22 * vertebra;
    const double y = spine_y(z);
    const double size = 1 - 0.029 * vertebra;  // smaller towards the head
    // Disc, processes, arch, body.
    organs.ellipsoid(0.52, {0, y, z + 11}, {20 * size, 16 * size, 6});
    for (const double side : both_sides) {
      organs.rod(bone, {side * 10, y + 16, z}, {side * 34 * size, y + 23, z + 4}, 4.2, 3.2);
    }
    organs.rod(bone, {0, y + 24, z}, {0, y + 36, z - 14}, 4, 3);
    organs.ellipsoid(bone, {0, y + 20, z}, {15, 8, 8});
    organs.ellipsoid(bone, {0, y, z}, {22 * size, 17 * size, 10.5});
    organs.ellipsoid(marrow, {0, y, z}, {19 * size, 14 * size, 7.8});
  }
  // Sacrum, and the canal of the spinal cord through all of it.
  organs.ellipsoid(bone, {0, 58, -150}, {36, 13, 34});
  organs.ellipsoid(marrow, {0, 58, -150}, {31, 9, 30});
  std::vector<Point3> canal;
  for (int n = 0; n < 9; ++n) {
    const double z = -140 + 40 * n;
    canal.push_back({0, spine_y(z) + 20, z});
  }
  organs.tube(0.38, canal, 6.5, 6.5);
}

void add_ribs(Organs& organs) {
  constexpr int rib_count = 11;
  for (int rib = 0; rib < rib_count; ++rib) {
    const double z = 138 - 18.5 * rib;
    const double drop = 24 + 4.5 * rib;
    const double bone_end = pi * (rib < 7 ? 0.80 : 0.80 - 0.10 * (rib - 6));
    for (const double side : both_sides) {
      const auto at = [&](double turn) {
        return rib_cage(side, z - 0.5 * drop * (1 - std::cos(turn)), turn);
      };
      std::vector<Point3> arc{{side * 18, spine_y(z) + 15, z + 1}};
      for (int n = 0; n <= 10; ++n) {
        arc.push_back(at(0.14 * pi + 0.1 * n * (bone_end - 0.14 * pi)));
      }
      if (rib < 7) {
        const double sternum_z = std::max(94 - 15.0 * rib, 8.0);
        organs.tube(cartilage, {arc.back(), at(0.88 * pi), {side * 11, -77, sternum_z}}, 4.2, 4);
      }
      organs.tube(bone, arc, 4.3, 4.6);
      organs.tube(marrow, arc, 2.0, 2.2);
    }
  }
}

void add_shoulders_and_hips(Organs& organs) {
  // Breastbone; collarbones, heads of the upper arms, shoulder blades' spines, hip bones.
  organs.ellipsoid(bone, {0, -77, 50}, {15, 5.5, 54});
  organs.ellipsoid(marrow, {0, -77, 50}, {11, 3, 50});
  for (const double side : both_sides) {
    organs.tube(
        bone,
        {{side * 10, -66, 112}, {side * 48, -56, 126}, {side * 96, -26, 132}, {side * 132, 2, 126}},
        6, 5);
    organs.ellipsoid(bone, {side * 148, 8, 104}, {20, 20, 21});
    organs.ellipsoid(marrow, {side * 148, 8, 104}, {16, 16, 17});
    organs.rod(bone, {side * 122, 34, 116}, {side * 82, 74, 112}, 4, 3.4);
    organs.ellipsoid(bone, {side * 90, 26, -146}, {12, 46, 40}, side * 0.45);
    organs.ellipsoid(marrow, {side * 90, 26, -146}, {8, 42, 36}, side * 0.45);
  }
}
}  // namespace

Anatomy make_torso() {
  Anatomy anatomy;
  anatomy.trunk = {{{0, 2, 15}, {148, 100, 140}},
                   {{0, 8, 100}, {174, 62, 46}},
                   {{0, 0, -70}, {132, 86, 120}},
                   {{0, 6, -135}, {150, 92, 72}},
                   {{0, 14, 165}, {46, 48, 80}}};
  Organs organs;
  add_belly(organs);
  add_lungs(organs);
  add_airways(organs);
  add_upper_belly(organs);
  add_heart(organs);
  add_great_vessels(organs);
  add_spine(organs);
  add_ribs(organs);
  add_shoulders_and_hips(organs);
  anatomy.organs = organs.take();
  return anatomy;
}

}  // namespace tetwarp
