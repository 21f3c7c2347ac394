/// @file test_screens.cpp
/// Screens of a room without sockets and windows: projections, places, swaps.
#include <gtest/gtest.h>

#include <cmath>
#include <map>
#include <random>
#include <set>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/pick.hpp"
#include "host/view/screens/off_axis.hpp"
#include "host/view/screens/room_file.hpp"
#include "host/view/screens/screen_keys.hpp"
#include "host/view/screens/swap_group.hpp"
#include "tests/support/run_command.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

constexpr double pi = 3.14159265358979323846;

/// Where an eye sees a point on a screen: x and y from -1 to 1, and depth.
Point3 seen(const Screen& screen, const Point3& eye, const Point3& x) {
  const OffAxisView view = off_axis_view(screen, eye).value();
  const Point3 back = unit(minus(view.eye, view.target)), right = cross(view.up, back);
  const Point3 arm = minus(x, view.eye);
  const double in_camera[4] = {dot(arm, right), dot(arm, view.up), dot(arm, back), 1};
  const std::array<double, 16> matrix = projection_of(view, 0.1, 50);
  double clip[4] = {};
  for (std::size_t row = 0; row < 4; ++row) {
    for (std::size_t n = 0; n < 4; ++n) clip[row] += matrix[4 * row + n] * in_camera[n];
  }
  return {clip[0] / clip[3], clip[1] / clip[3], clip[2] / clip[3]};
}

Point3 between(const Point3& a, const Point3& b, double share) {
  return plus(times(1 - share, a), times(share, b));
}

Room shipped(const std::string& name) {
  return parse_room(room_text(name), name);
}

TEST(OffAxis, TakesTheCornersToThoseOfThePicture) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> shift(-0.4, 0.4);
  for (const std::string& name : room_names()) {
    const Room room = shipped(name);
    for (const Screen& screen : room.screens) {
      const Point3 eye = plus(room.observer, {shift(random), shift(random), shift(random)});
      if (!off_axis_view(screen, eye)) continue;
      const Point3 low = seen(screen, eye, screen.lower_left);
      const Point3 side = seen(screen, eye, screen.lower_right);
      const Point3 high = seen(screen, eye, screen.upper_right);
      EXPECT_NEAR(low[0], -1, 1e-12);
      EXPECT_NEAR(low[1], -1, 1e-12);
      EXPECT_NEAR(side[0], 1, 1e-12);
      EXPECT_NEAR(side[1], -1, 1e-12);
      EXPECT_NEAR(high[0], 1, 1e-12);
      EXPECT_NEAR(high[1], 1, 1e-12);
    }
  }
}

/// What lies behind the common edge of two screens is on the edge of both pictures, equally high.
TEST(OffAxis, NeighborsMeetAtTheirEdge) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> shift(-0.5, 0.5), share(0, 1), depth(0.2, 5);
  int pairs = 0;
  for (const std::string& name : room_names()) {
    const Room room = shipped(name);
    for (std::size_t n = 0; n + 1 < room.screens.size(); ++n) {
      const Screen &left = room.screens[n], &right = room.screens[n + 1];
      if (left.lower_right != right.lower_left) continue;
      ++pairs;
      for (int trial = 0; trial < 50; ++trial) {
        const Point3 eye = plus(room.observer, {shift(random), shift(random), shift(random)});
        const Point3 on_edge = between(left.lower_right, left.upper_right, share(random));
        const Point3 x = between(eye, on_edge, depth(random));
        const Point3 a = seen(left, eye, x), b = seen(right, eye, x);
        EXPECT_NEAR(a[0], 1, 1e-11);
        EXPECT_NEAR(b[0], -1, 1e-11);
        EXPECT_NEAR(a[1], b[1], 1e-11);
      }
    }
  }
  EXPECT_EQ(pairs, 7);
}

/// A ray through the place of a point on the screen meets the point, whatever the eye and the
/// screen.
TEST(OffAxis, ARayThroughWhereAPointIsSeenMeetsIt) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> share(0.02, 0.98), shift(-0.3, 0.3), depth(1.2, 9);
  for (const std::string& name : room_names()) {
    for (const Screen& screen : shipped(name).screens) {
      const Point3 eye =
          plus(shipped(name).observer, {shift(random), shift(random), shift(random)});
      const Point3 across = minus(screen.lower_right, screen.lower_left);
      const Point3 upwards = minus(screen.upper_right, screen.lower_right);
      const Point3 on_screen = plus(
          screen.lower_left, plus(times(share(random), across), times(share(random), upwards)));
      const Point3 x = plus(eye, times(depth(random), minus(on_screen, eye)));
      const Point3 place = seen(screen, eye, x);
      const OffAxisView view = off_axis_view(screen, eye).value();
      const auto& [left, right, bottom, top] = view.tangents;
      const Point3 back = unit(minus(view.eye, view.target)), side = cross(view.up, back);
      const Point3 direction =
          plus(plus(times(left + (right - left) * (place[0] + 1) / 2, side),
                    times(bottom + (top - bottom) * (place[1] + 1) / 2, view.up)),
               times(-1, back));
      const std::vector<std::vector<Point3>> corners{
          {plus(x, side), minus(x, plus(side, view.up)), plus(x, minus(view.up, side))}};
      const auto met = pick(corners, {{{0, 1, 2}}}, eye, direction);
      ASSERT_TRUE(met) << name;
      EXPECT_LT(norm(minus(met->point, x)), 1e-12 * norm(minus(x, eye)) + 1e-12) << name;
    }
  }
}

TEST(OffAxis, DepthGoesFromNearestToFarthest) {
  const Screen screen = shipped("wall").screens[1];
  EXPECT_NEAR(seen(screen, {0, 0, 0}, {0.01, 0.02, -0.1})[2], -1, 1e-12);
  EXPECT_NEAR(seen(screen, {0, 0, 0}, {3, 2, -50})[2], 1, 1e-12);
  EXPECT_FALSE(off_axis_view(screen, {0, 0, -0.8}));
  EXPECT_FALSE(off_axis_view(screen, {0, 0, -2}));
}

TEST(Room, ShowsTheCamerasTargetAtTheFocus) {
  const Room room = shipped("cube");
  const Point3 eye{0.3, -2, 1}, target{0.1, 0.4, 0.5};
  const RoomPlace place = place_of_camera(room, {eye, target, {0, 0, 1}});
  EXPECT_EQ(place.world_of(room.observer), eye);
  const Point3 ahead = place.world_of(plus(room.observer, {0, 0, -room.focus}));
  for (std::size_t d = 0; d < 3; ++d) EXPECT_NEAR(ahead[d], target[d], 1e-12);
  const double meter = norm(minus(eye, target)) / room.focus;
  for (std::size_t a = 0; a < 3; ++a) {
    EXPECT_NEAR(norm(place.axes[a]), meter, 1e-12);
    EXPECT_NEAR(dot(place.axes[a], place.axes[(a + 1) % 3]), 0, 1e-12);
  }
  EXPECT_GT(dot(cross(place.axes[0], place.axes[1]), place.axes[2]), 0);
  EXPECT_GT(place.axes[1][2], 0);  // up
  EXPECT_THROW(place_of_camera(room, {eye, eye, {0, 0, 1}}), std::invalid_argument);
  EXPECT_THROW(place_of_camera(room, {{0, 0, 1}, {0, 0, 0}, {0, 0, 1}}), std::invalid_argument);
}

TEST(Room, EyesTurnWithTheHead) {
  const auto straight = eyes_of({{1, 2, 3}, {1, 0, 0, 0}}, 0.06);
  EXPECT_EQ(straight[0], (Point3{0.97, 2, 3}));
  EXPECT_EQ(straight[1], (Point3{1.03, 2, 3}));
  const double half = std::sqrt(0.5);
  const auto turned = eyes_of({{0, 0, 0}, {half, 0, half, 0}}, 0.06);  // to the left
  EXPECT_NEAR(turned[1][0], 0, 1e-15);
  EXPECT_NEAR(turned[1][2], -0.03, 1e-15);
  const std::vector<HeadPoint> path{{1, {{0, 0, 0}, {1, 0, 0, 0}}},
                                    {3, {{2, 0, 0}, {half, 0, half, 0}}}};
  EXPECT_EQ(head_at(path, 0).position, (Point3{0, 0, 0}));
  EXPECT_EQ(head_at(path, 9).position, (Point3{2, 0, 0}));
  const HeadPose middle = head_at(path, 2);
  EXPECT_EQ(middle.position, (Point3{1, 0, 0}));
  EXPECT_NEAR(middle.rotation[0], std::cos(pi / 8), 1e-12);
  EXPECT_NEAR(middle.rotation[2], std::sin(pi / 8), 1e-12);
}

TEST(RoomFile, NamesWhatIsWrong) {
  const auto refuses = [](const std::string& text, const std::string& expected) {
    try {
      parse_room(text, "room.json");
      ADD_FAILURE() << text;
    } catch (const IoError& error) {
      const std::string message = error.what();
      EXPECT_NE(message.find(expected), std::string::npos) << message;
      EXPECT_EQ(message.find('\n'), std::string::npos) << message;
    }
  };
  const std::string head = R"({"tetwarp_room": 1, "screens": [)";
  const std::string corners =
      R"("lower_left": [-1, -1, -1], "lower_right": [1, -1, -1], "upper_right": [1, 1, -1])";
  EXPECT_EQ(parse_room(head + R"({"name": "a", )" + corners + "}]}", "r").focus, 1);
  refuses("{}", "tetwarp_room");
  refuses(
      R"({"tetwarp_room": 1, "tracker": "Head@x-vrsh://host/program", "screens": [{"name": "a", )" +
          corners + "}]}",
      "tracker 'Head@x-vrsh://host/program': expected");
  refuses(head + "]}", "screens: there are none");
  refuses(head + "{" + corners + "}]}", "name");
  refuses(head + R"({"name": "a", "lower_left": [0, 0], )" + corners + "}]}", "lower_left");
  refuses(head + R"({"name": "a", "stereo": "both", )" + corners + "}]}", "stereo");
  refuses(head + R"({"name": "a", "colour": 1, )" + corners + "}]}", "colour");
  refuses(head + R"({"name": "a", )" + corners + R"(}, {"name": "a", )" + corners + "}]}",
          "another one has the same name");
  refuses(
      R"({"tetwarp_room": 1, "observer": [0, 0, -3], "screens": [{"name": "a", )" + corners + "}]}",
      "not in front");
  refuses(head + R"({"name": "a", "lower_left": [-1, -1, -1], "lower_right": [1, -1, -1],
                     "upper_right": [2, 1, -1]}]})",
          "right angle");
  for (const std::string window : {"[65536, 0, 1, 1]", "[0, 0, 16385, 1]", "[0, 0, 1, -1]"}) {
    refuses(head + R"({"name": "a", "window": )" + window + ", " + corners + "}]}", "window");
  }
  refuses(head + R"({"name": "a", "lower_left": [-1e9, -1, -1], "lower_right": [1, -1, -1],
                     "upper_right": [1, 1, -1]}]})",
          "screen a: a corner");
}

TEST(ScreenKeys, AreReadAsTheyWereWrittenByWhoMayHaveThem) {
  const TemporaryFolder folder;
  const auto key = [](char letter) { return std::string(40, letter); };
  const ScreenKeys keys{key('a'), key('b'), key('c'), key('d')};
  const std::string master = folder / "room.key", screen = folder / "room_screen.key";
  std::ofstream(master) << master_text(keys);
  std::ofstream(screen) << screen_text(keys);
  EXPECT_EQ(read_screen_keys(master, true).master_secret, key('b'));
  EXPECT_EQ(read_screen_keys(screen, false).screen_secret, key('d'));
  EXPECT_EQ(text_of(master).find(key('d')), std::string::npos);
  EXPECT_EQ(text_of(screen).find(key('b')), std::string::npos);
  EXPECT_THROW(read_screen_keys(screen, true), IoError);
  EXPECT_THROW(read_screen_keys(master, false), IoError);
  std::ofstream(master) << "something else\n";
  EXPECT_THROW(read_screen_keys(master, true), IoError);
  ScreenKeys wrong = keys;
  for (const std::string& bad : {std::string(40, '~'), std::string(40, '#'), key('a') + "a"}) {
    wrong.master_public = bad;  // no letter of Z85, too large a number, too long
    std::ofstream(master) << master_text(wrong);
    EXPECT_THROW(read_screen_keys(master, true), IoError) << bad;
  }
  EXPECT_THROW(check_no_file(master), IoError);
  EXPECT_NO_THROW(check_no_file(folder / "other.key"));
  EXPECT_TRUE(is_loopback("tcp://127.0.0.1:5611"));
  EXPECT_FALSE(is_loopback("tcp://*:5611"));
  EXPECT_FALSE(is_loopback("tcp://eth0:5611"));
}

using Members = std::vector<std::string>;

TEST(SwapGroup, ShowsAFrameWhenAllHaveDrawnIt) {
  SwapGroup group(0.1, 2);
  group.join("a", "left", 0);
  group.join("b", "right", 0);
  EXPECT_EQ(group.begin_frame(1, 0), (Members{"a", "b"}));
  EXPECT_FALSE(group.ready("a", 1, 0.01));
  EXPECT_FALSE(group.may_swap(0.02));
  EXPECT_TRUE(group.begin_frame(2, 0.02).empty()) << "all are busy";
}

TEST(SwapGroup, DoesNotWaitForASlowScreen) {
  SwapGroup group(0.1, 2);
  group.join("a", "left", 0);
  group.join("b", "right", 0);
  group.begin_frame(1, 0);
  group.ready("a", 1, 0.01);
  EXPECT_FALSE(group.may_swap(0.09));
  EXPECT_TRUE(group.may_swap(0.11));
  EXPECT_EQ(group.swap(), (Members{"a"}));
  EXPECT_EQ(group.begin_frame(2, 0.12), (Members{"a"})) << "b still draws";
  EXPECT_TRUE(group.ready("b", 1, 0.15)) << "late: to be shown at once";
  EXPECT_FALSE(group.may_swap(0.15));
  group.ready("a", 2, 0.16);
  EXPECT_TRUE(group.may_swap(0.16)) << "b takes no part in frame 2";
  group.swap();
  EXPECT_EQ(group.begin_frame(3, 0.17), (Members{"a", "b"}));
  EXPECT_EQ(group.late_count(), 1);
}

TEST(SwapGroup, GoesOnWithoutLostAndReplacedScreens) {
  SwapGroup group(0.1, 2);
  group.join("a", "left", 0);
  group.join("b", "right", 0);
  group.begin_frame(1, 0);
  group.ready("a", 1, 1);
  group.hear("a", 29);
  EXPECT_EQ(group.drop_silent(30.5), (Members{"right"}));
  EXPECT_TRUE(group.may_swap(0)) << "nobody else draws";
  EXPECT_FALSE(group.hear("b", 30.5));
  EXPECT_EQ(group.join("c", "left", 30.6), "a");
  EXPECT_EQ(group.members(), (Members{"c"}));
  EXPECT_EQ(group.join("c", "left", 30.7), "") << "the same process again";
  group.leave("c");
  EXPECT_EQ(group.size(), 0u);
}

TEST(SwapGroup, WaitsForAScreenThatIsSilentWhileItDraws) {
  SwapGroup group(0.1, 2);
  group.join("a", "left", 0);
  group.join("b", "right", 0);
  group.begin_frame(1, 0);
  group.ready("a", 1, 0.05);
  EXPECT_EQ(group.swap(), (Members{"a"}));
  EXPECT_EQ(group.late_frames(), (std::map<std::string, std::uint64_t>{{"b", 1}}));
  EXPECT_EQ(group.drop_silent(2.1), (Members{"left"})) << "it has drawn and says nothing";
  EXPECT_TRUE(group.drop_silent(29.9).empty());
  EXPECT_TRUE(group.ready("b", 1, 29.9)) << "it shows its frame";
  EXPECT_TRUE(group.late_frames().empty());
  EXPECT_TRUE(group.drop_silent(31.8).empty());
  EXPECT_EQ(group.drop_silent(32), (Members{"right"})) << "it draws no more";
}

/// Whatever happens: a frame goes to no busy screen, and a screen shows only what it has drawn.
TEST(SwapGroup, NeverShowsWhatIsNotDrawn) {
  std::mt19937 random(3);
  const auto below = [&](unsigned count) { return random() % count; };
  SwapGroup group(0.1, 0.5);
  std::map<std::string, std::uint64_t> drawing;
  std::set<std::string> drawn;
  double now = 0;
  std::uint64_t frame = 0;
  std::int64_t shown = 0;
  for (int n = 0; n < 20000; ++n) {
    now += 0.001 * static_cast<double>(below(40));
    const std::string member(1, static_cast<char>('a' + below(4)));
    if (below(20) == 0) {
      group.join(member, member, now);
      drawing.erase(member);
      drawn.erase(member);
    }
    if (drawing.contains(member) && below(3) > 0) {
      if (group.ready(member, drawing[member], now)) {
        ++shown;  // late
      } else if (group.hear(member, now)) {
        drawn.insert(member);
      }
      drawing.erase(member);
    }
    if (group.may_swap(now)) {
      for (const std::string& other : group.swap()) {
        EXPECT_EQ(drawn.erase(other), 1u);
        ++shown;
      }
    }
    if (!group.is_drawing()) {
      for (const std::string& other : group.begin_frame(++frame, now)) {
        EXPECT_FALSE(drawing.contains(other));
        EXPECT_FALSE(drawn.contains(other));
        drawing[other] = frame;
      }
    }
    for (const std::string& lost : group.drop_silent(now)) {
      drawing.erase(lost);
      drawn.erase(lost);
    }
  }
  EXPECT_GT(shown, 1000);
}

}  // namespace
}  // namespace tetwarp::test
