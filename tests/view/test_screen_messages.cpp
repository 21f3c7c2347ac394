/// @file test_screen_messages.cpp
/// What goes between master and screens: the same on both sides, small, and safe to read.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "host/base/point3.hpp"
#include "host/view/screens/scene_sharer.hpp"
#include "host/view/screens/screen_message.hpp"
#include "tests/view/live_scene.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

template <class Kind, class Message>
Kind again(const Message& message, Message (*read)(std::span<const std::byte>)) {
  return std::get<Kind>(read(bytes_of(message)));
}

TEST(ScreenMessage, IsTheSameAfterItsBytes) {
  const auto join = again<JoinMessage>(ToMaster(JoinMessage{"left", 77}), to_master);
  EXPECT_EQ(join.screen, "left");
  EXPECT_EQ(join.session, 77u);
  EXPECT_EQ(again<ReadyMessage>(ToMaster(ReadyMessage{9}), to_master).frame, 9u);
  const HeadPose head{{1, 2, 3}, {0.6, 0, 0.8, 0}};
  EXPECT_EQ(again<HeadMessage>(ToMaster(HeadMessage{head}), to_master).head, head);
  again<AliveMessage>(ToMaster(AliveMessage{}), to_master);
  again<LeaveMessage>(ToMaster(LeaveMessage{}), to_master);

  WelcomeMessage welcome{5, {}, 0.2, {std::byte{1}, std::byte{2}}};
  welcome.screen.name = "right";
  welcome.screen.upper_right = {1, 2, 3};
  welcome.screen.stereo = Stereo::anaglyph;
  welcome.screen.window = {-10, 20, 640, 480};
  welcome.screen.is_fullscreen = true;
  const auto welcomed = again<WelcomeMessage>(ToScreen(welcome), to_screen);
  EXPECT_EQ(welcomed.screen.name, "right");
  EXPECT_EQ(welcomed.screen.upper_right, welcome.screen.upper_right);
  EXPECT_EQ(welcomed.screen.stereo, Stereo::anaglyph);
  EXPECT_EQ(welcomed.screen.window, welcome.screen.window);
  EXPECT_TRUE(welcomed.screen.is_fullscreen);
  EXPECT_EQ(welcomed.scene, welcome.scene);
  FrameMessage frame{5,
                     6,
                     head,
                     0.06,
                     {{0, 1, 0}, {4, 5, 6}, {}},
                     {1, false, 0.5, 2, {{0, 0.25, 1}, 2}, Cut{{1, 2, 3}, {0, 0.6, 0.8}}},
                     {}};
  frame.look.curve = {{0, {1, 0, 0}, 0}, {0.5, {0, 0.25, 0}, 0.5}, {1, {0, 0, 1}, 1}};
  frame.look.rays = {{{{1, 2, 3}, {4, 5, 6}}}};
  frame.state = {std::byte{3}};
  const auto framed = again<FrameMessage>(ToScreen(frame), to_screen);
  EXPECT_EQ(framed.frame, 6u);
  EXPECT_EQ(framed.head, head);
  EXPECT_EQ(framed.place, frame.place);
  EXPECT_EQ(framed.look, frame.look);
  EXPECT_EQ(framed.state, frame.state);
  EXPECT_EQ(again<RefuseMessage>(ToScreen(RefuseMessage{"no"}), to_screen).reason, "no");
  EXPECT_EQ(again<SwapMessage>(ToScreen(SwapMessage{3}), to_screen).frame, 3u);
  again<EndMessage>(ToScreen(EndMessage{}), to_screen);
  again<WhoMessage>(ToScreen(WhoMessage{}), to_screen);
}

TEST(ScreenMessage, OfAnUnknownKindIsRefused) {
  Bytes bytes = bytes_of(ToScreen(EndMessage{}));
  for (std::size_t kind = 0; kind < 256; ++kind) {
    bytes[4] = static_cast<std::byte>(kind);  // behind the letters
    if (kind == ToScreen(EndMessage{}).index() || kind == ToScreen(WhoMessage{}).index()) {
      EXPECT_EQ(to_screen(bytes).index(), kind);
    } else {
      EXPECT_THROW(to_screen(bytes), std::invalid_argument) << kind;
    }
  }
}

TEST(ScreenMessage, NumbersOutOfRangeAreRefused) {
  FrameMessage frame{1, 1, {}, 0.06, {}, {}, {}};
  const auto is_refused = [](const FrameMessage& message) {
    EXPECT_THROW(to_screen(bytes_of(ToScreen(message))), std::invalid_argument);
  };
  EXPECT_NO_THROW(to_screen(bytes_of(ToScreen(frame))));
  FrameMessage bad = frame;
  bad.head.rotation = {2, 0, 0, 0};
  is_refused(bad);
  bad = frame;
  bad.place.origin[1] = NAN;
  is_refused(bad);
  bad = frame;
  bad.look.volumes = 3;
  is_refused(bad);
  bad = frame;
  bad.look.slices.places[1] = 1.01;
  is_refused(bad);
  bad = frame;
  bad.look.slices.alone = 3;
  is_refused(bad);
  bad = frame;
  bad.look.cut = Cut{{0, 0, 0}, {0, 0, 2}};
  is_refused(bad);
  bad = frame;
  bad.look.rays = {{{{0, 0, 0}, {NAN, 0, 0}}}};
  is_refused(bad);
  bad.look.rays.assign(65, WandRay{});
  is_refused(bad);
  bad = frame;
  bad.eye_separation = -1;
  is_refused(bad);
  frame.look.curve = {{0, {0, 0, 0}, 0}, {0.5, {0, 0, 0}, 0}, {1, {0, 0, 0}, 0}};
  EXPECT_NO_THROW(to_screen(bytes_of(ToScreen(frame))));
  bad = frame;
  bad.look.curve.insert(bad.look.curve.begin() + 1, 62, frame.look.curve[1]);
  is_refused(bad);
  bad = frame;
  bad.look.curve = {{0, {0, 0, 0}, 0}};
  is_refused(bad);
  bad = frame;
  bad.look.curve.insert(bad.look.curve.begin() + 1, {0.75, {0, 0, 0}, 0});
  is_refused(bad);
  for (const double number : {2.0, -0.1, std::nan("")}) {
    bad = frame;
    bad.look.curve[1].opacity = number;
    is_refused(bad);
    bad = frame;
    bad.look.curve[1].value = number;
    is_refused(bad);
    bad = frame;
    bad.look.curve[1].color[2] = number;
    is_refused(bad);
  }
  bad = frame;
  bad.look.curve.front().value = 0.25;
  is_refused(bad);
  bad = frame;
  bad.look.curve.back().value = 0.75;
  is_refused(bad);
}

/// A simulation whose body with a volume is pulled and whose ball rolls.
struct Shared {
  explicit Shared(const std::string& colors = "none") {
    ViewOptions options;
    options.colors = colors;
    options.paused = true;
    options.fast = true;
    Scene scene = live_scene();
    scene.bodies[1].angular_velocity = {3, 2, 1};
    scene.obstacles.push_back({.name = "floor", .geometry = PlaneObstacle{}});
    scene.obstacles.push_back({.name = "post",
                               .geometry = CapsuleObstacle{{1, 0, 0}, {1, 0, 1}, 0.1},
                               .path = {{0, Point3{0, 0, 0}}}});
    scene.obstacles[0].geometry = PlaneObstacle{{0, 0, 1}, {0, 0, -0.2}};
    LiveSimulation simulation(std::move(scene), options, {});
    const ViewScene view = view_scene_of(simulation, options);
    const SceneSharer sharer(simulation, view, options);
    simulation.set_listener([&](const Simulator& simulator, const LiveFrame& frame) {
      state = sharer.state(simulator, frame);
    });
    simulation.begin();
    frame_at(simulation, 0);
    simulation.give({.kind = OrderKind::grab, .body = 0, .point = {0, 0, 0.1}});
    simulation.give({.kind = OrderKind::pull, .point = {0.03, 0.02, 0.12}});
    for (int n = 0; n < 5; ++n) simulation.give({.kind = OrderKind::step});
    frame = frame_at(simulation, 5);
    points = frame.points;
    simulation.end();
    scene_bytes = bytes_of(sharer.scene());
  }
  SharedState state;
  Bytes scene_bytes;
  LiveFrame frame;                          ///< of the window after the last step
  std::vector<std::vector<Point3>> points;  ///< [bodies] after the last step
};

/// The surfaces that a screen computes are those of the simulation but for rounding to float32.
TEST(SharedState, GivesScreensTheSurfacesOfTheSimulation) {
  const Shared shared;
  const SharedScene scene = scene_of(shared.scene_bytes);
  ASSERT_EQ(scene.bodies.size(), 2u);
  EXPECT_EQ(scene.bodies[0].form, BodyForm::nodes);
  EXPECT_EQ(scene.bodies[1].form, BodyForm::pose);
  ASSERT_EQ(scene.volumes.size(), 1u);
  LiveFrame frame;
  const SharedState state = state_of(bytes_of(shared.state), scene);
  set_frame(scene, state, frame);
  EXPECT_EQ(frame.step, 5);
  ASSERT_TRUE(frame.grab);
  for (std::size_t b = 0; b < 2; ++b) {
    ASSERT_EQ(frame.points[b].size(), shared.points[b].size());
    for (std::size_t p = 0; p < frame.points[b].size(); ++p) {
      // Coordinates below 0.25 m have float32 units of at most 2^-26 m; four weights add up.
      EXPECT_LT(norm(minus(frame.points[b][p], shared.points[b][p])), 1e-7);
    }
  }
  EXPECT_EQ(bytes_of(scene), shared.scene_bytes);
}

/// Values of a screen are those of the window to half a step of 1/254 of their range, which is the
/// same in both.
TEST(SharedState, GivesScreensTheValuesOfTheWindow) {
  for (const std::string colors : {"stress", "gap", "adhesion"}) {
    const Shared shared(colors);
    const SharedScene scene = scene_of(shared.scene_bytes);
    LiveFrame frame;
    set_frame(scene, state_of(bytes_of(shared.state), scene), frame);
    EXPECT_EQ(frame.quantity, quantity_of(colors));
    const double extent = shared.frame.range.high() - shared.frame.range.low();
    EXPECT_NEAR(frame.range.low(), shared.frame.range.low(), 1e-6 * extent);
    EXPECT_NEAR(frame.range.high(), shared.frame.range.high(), 1e-6 * extent);
    int counts[2]{};  // points without and with a value
    ASSERT_EQ(frame.values.size(), shared.frame.values.size());
    for (std::size_t b = 0; b < frame.values.size(); ++b) {
      ASSERT_EQ(frame.values[b].size(), frame.points[b].size());
      for (std::size_t p = 0; p < frame.values[b].size(); ++p) {
        const float window = shared.frame.values[b][p], screen = frame.values[b][p];
        ++counts[std::isnan(window) ? 0 : 1];
        EXPECT_EQ(std::isnan(screen), std::isnan(window));
        if (std::isnan(window)) continue;
        EXPECT_NEAR(screen, window, (0.5 / 254 + 1e-6) * extent);
      }
    }
    EXPECT_GT(counts[0], 0) << colors;
    EXPECT_GT(counts[1], 0) << colors;
  }
}

TEST(SharedState, WithLevelsOfOtherPointsIsRefused) {
  const Shared shared("stress");
  const SharedScene scene = scene_of(shared.scene_bytes);
  const auto is_refused = [&](const SharedState& state) {
    EXPECT_THROW(state_of(bytes_of(state), scene), std::invalid_argument);
  };
  SharedState bad = shared.state;
  bad.levels[0].pop_back();
  is_refused(bad);
  bad = shared.state;
  bad.levels.pop_back();
  is_refused(bad);
  bad = shared.state;
  bad.range = {1, 0};
  is_refused(bad);
  bad.range = {NAN, 0};
  is_refused(bad);
  bad = shared.state;
  bad.quantity = static_cast<SurfaceQuantity>(9);
  is_refused(bad);
}

/// A block of 10 x 10 x 20 nodes, of which 848 are drawn, in colors.
TEST(SharedState, OfTwoThousandNodesTakesAtMost30Kilobytes) {
  SharedState state;
  state.moving.resize(1);
  state.moving[0].resize(2000);
  state.levels.resize(1);
  state.levels[0].resize(848);
  state.contacts.resize(153);  // the largest number of the shoulder in the paper
  FrameMessage frame;
  frame.state = bytes_of(state);
  const std::size_t bytes = bytes_of(ToScreen(frame)).size();
  EXPECT_LE(bytes, 30000u);
  EXPECT_GE(bytes, 24848u);
}

/// Cut and damaged bytes are read or refused, and nothing else happens.
template <class Read>
void damage(const Bytes& good, unsigned seed, const Read& read) {
  const auto is_read = [&](const Bytes& bytes) {
    try {
      read(bytes);
      return true;
    } catch (const std::invalid_argument&) {
      return false;
    }
  };
  EXPECT_TRUE(is_read(good));
  for (std::size_t size = 0; size < good.size(); size += 1 + good.size() / 400) {
    EXPECT_FALSE(is_read(Bytes(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(size))));
  }
  std::mt19937 random(seed);
  for (int trial = 0; trial < 1500; ++trial) {
    Bytes bytes = good;
    for (int change = 0; change < 1 + trial % 4; ++change) {
      // The first bytes hold most counts.
      const std::size_t range =
          trial % 2 == 0 ? std::min<std::size_t>(bytes.size(), 200) : bytes.size();
      bytes[random() % range] = static_cast<std::byte>(random());
    }
    is_read(bytes);
  }
  Bytes longer = good;
  longer.push_back(std::byte{0});
  EXPECT_FALSE(is_read(longer));
}

TEST(ScreenMessage, DamagedBytesAreReadOrRefused) {
  damage(bytes_of(ToMaster(JoinMessage{"left", 7})), 1, [](const Bytes& b) { to_master(b); });
  damage(bytes_of(ToMaster(HeadMessage{})), 2, [](const Bytes& b) { to_master(b); });
  WelcomeMessage welcome;
  welcome.wait = 1;
  damage(bytes_of(ToScreen(welcome)), 3, [](const Bytes& b) { to_screen(b); });
  damage(bytes_of(ToScreen(FrameMessage{})), 4, [](const Bytes& b) { to_screen(b); });
}

TEST(SharedScene, DamagedBytesAreReadOrRefused) {
  const Shared shared("stress");
  damage(shared.scene_bytes, 5, [](const Bytes& b) { scene_of(b); });
  const SharedScene scene = scene_of(shared.scene_bytes);
  damage(bytes_of(shared.state), 6, [&](const Bytes& b) {
    LiveFrame frame;
    set_frame(scene, state_of(b, scene), frame);
  });
}

}  // namespace
}  // namespace tetwarp::test
