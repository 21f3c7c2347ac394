/// @file test_screen_link.cpp
/// Master and screens over sockets of this machine, and rooms of ParaView.
#include <gtest/gtest.h>

#include <functional>
#include <stdexcept>
#include <string>
#include <tetwarp/error.hpp>
#include <thread>
#include <zmq.hpp>

#include "host/view/link/room_pvx.hpp"
#include "host/view/link/screen_link.hpp"
#include "host/view/link/screen_server.hpp"
#include "host/view/link/sockets.hpp"
#include "host/view/screens/room_file.hpp"

namespace tetwarp::test {
namespace {
using namespace view;

constexpr double most_seconds = 10;

Room test_room() {
  Room room = parse_room(room_text("wall"), "wall");
  room.address = "tcp://127.0.0.1:*";
  return room;
}

const Bytes scene{std::byte{7}}, state{std::byte{1}};

/// A master with something to show.
struct Master {
  explicit Master(Room room = test_room(), ScreenKeys keys = {})
      : server(std::move(room), scene, std::move(keys)) {
    server.set_state(state);
    server.set_view({{}, {1, 2, 3}, {}}, {});
  }
  /// Whether the counts come to be so in time.
  bool comes_to(const std::function<bool(const ScreenCounts&)>& be) const {
    const Stopwatch watch;
    while (!be(server.counts())) {
      if (watch.seconds() > most_seconds) return false;
      std::this_thread::yield();
    }
    return true;
  }
  ScreenServer server;
};

/// A screen that draws nothing.
struct Follower {
  explicit Follower(const std::string& address, std::string name, const ScreenKeys& keys = {})
      : link(address, keys), screen(std::move(name)) {
    link.send(JoinMessage{screen, 0});
  }
  /// The next message of a kind; frames are drawn and questions answered meanwhile.
  template <class Kind>
  Kind next() {
    const Stopwatch watch;
    Stopwatch since_join;
    while (watch.seconds() < most_seconds) {
      if (!is_welcome && since_join.seconds() > 0.1) {  // before the connection was there
        link.send(JoinMessage{screen, session});
        since_join = Stopwatch();
      }
      auto message = link.receive(0.05);
      if (!message) continue;
      if (const auto* const welcome = std::get_if<WelcomeMessage>(&*message)) {
        is_welcome = true;
        session = welcome->session;
      }
      if (std::holds_alternative<WhoMessage>(*message)) is_welcome = false;
      const auto* const frame = std::get_if<FrameMessage>(&*message);
      if (frame != nullptr && draws) link.send(ReadyMessage{frame->frame});
      if (auto* const found = std::get_if<Kind>(&*message)) return std::move(*found);
    }
    throw std::runtime_error("screen " + screen + " waits in vain");
  }
  /// Whether one of the next frames is seen from this head.
  bool gets_head(const HeadPose& head) {
    bool is_met = false;
    for (int n = 0; n < 1000 && !is_met; ++n) is_met = next<FrameMessage>().head == head;
    return is_met;
  }
  ScreenLink link;
  std::string screen;
  std::uint64_t session = 0;
  bool is_welcome = false, draws = true;
};

TEST(ScreenServer, WelcomesAScreenAndShowsItFrames) {
  Master master;
  Follower left(master.server.address(), "left");
  const auto welcome = left.next<WelcomeMessage>();
  EXPECT_EQ(welcome.scene, scene);
  EXPECT_EQ(welcome.screen.name, "left");
  const auto frame = left.next<FrameMessage>();
  EXPECT_EQ(frame.state, state);
  EXPECT_EQ(frame.place.origin, (Point3{1, 2, 3}));
  EXPECT_EQ(left.next<SwapMessage>().frame, frame.frame);
  const Bytes newer{std::byte{9}};
  master.server.set_state(newer);
  while (left.next<FrameMessage>().state != newer) {
  }
}

TEST(ScreenServer, RefusesAScreenThatItDoesNotHave) {
  Master master;
  Follower ceiling(master.server.address(), "ceiling");
  EXPECT_NE(ceiling.next<RefuseMessage>().reason.find("left, middle, right"), std::string::npos);
}

TEST(ScreenServer, ALateScreenGetsTheNewestStateAndASlowOneHoldsNobodyUp) {
  Master master;
  Follower left(master.server.address(), "left");
  left.next<SwapMessage>();
  Follower right(master.server.address(), "right");
  right.draws = false;
  EXPECT_EQ(right.next<FrameMessage>().state, state);
  for (std::uint64_t n = 0; n < 3; ++n) left.next<SwapMessage>();
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return c.late >= 1 && c.screens == 2; }));
}

TEST(ScreenServer, GoesOnWithoutALostScreen) {
  Master master;
  Follower left(master.server.address(), "left");
  left.next<SwapMessage>();
  {
    Follower right(master.server.address(), "right");
    right.next<SwapMessage>();
  }
  const Stopwatch watch;
  while (master.server.counts().lost == 0 && watch.seconds() < most_seconds) {
    left.next<SwapMessage>();
  }
  EXPECT_EQ(master.server.counts().lost, 1);
  EXPECT_EQ(master.server.counts().screens, 1);
  Follower again(master.server.address(), "right");
  again.next<SwapMessage>();
  left.next<SwapMessage>();
}

TEST(ScreenServer, ANewProcessTakesTheScreenOver) {
  Master master;
  Follower first(master.server.address(), "left");
  first.next<SwapMessage>();
  Follower second(master.server.address(), "left");
  second.next<SwapMessage>();
  first.next<RefuseMessage>();
  EXPECT_EQ(master.server.counts().screens, 1);
}

TEST(ScreenServer, ScreensJoinAMasterThatStartsAgain) {
  Room room = test_room();
  std::optional<Master> master(std::in_place, room);
  room.address = master->server.address();
  Follower left(room.address, "left");
  const std::uint64_t before = left.next<WelcomeMessage>().session;
  left.next<SwapMessage>();
  std::thread ending([&] { master.reset(); });
  left.next<EndMessage>();
  ending.join();
  master.emplace(room);
  const auto welcome = left.next<WelcomeMessage>();
  EXPECT_NE(welcome.session, before);
  EXPECT_EQ(welcome.scene, scene);
  left.next<SwapMessage>();
}

TEST(ScreenServer, ATrackerMovesTheHead) {
  Master master;
  Follower left(master.server.address(), "left");
  left.next<SwapMessage>();
  const HeadPose head{{0.1, 0.2, 0.3}, {0.6, 0, 0.8, 0}};
  left.link.send(HeadMessage{head});
  EXPECT_TRUE(left.gets_head(head));
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return c.has_lost_head; }));
  left.link.send(HeadMessage{head});
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return !c.has_lost_head; }));
}

TEST(ScreenLink, LosesNoMessageOnceThereIsAMaster) {
  Master master;
  Follower left(master.server.address(), "left");
  left.next<SwapMessage>();
  const HeadPose head{{0.1, 0.2, 0.3}, {1, 0, 0, 0}};
  ScreenLink tracker(master.server.address(), {});
  ASSERT_TRUE(tracker.wait_for_master(most_seconds));
  tracker.send(HeadMessage{head});
  EXPECT_TRUE(left.gets_head(head));
  EXPECT_FALSE(ScreenLink("tcp://127.0.0.1:1", {}).wait_for_master(0.1));
}

TEST(ScreenServer, SaysThatATrackerHasNeverSpoken) {
  Room room = test_room();
  room.tracker = "Head@host";
  Master master(room);
  EXPECT_FALSE(master.server.counts().has_lost_head) << "it may still come";
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return c.has_lost_head; }));
  ScreenLink tracker(master.server.address(), {});
  ASSERT_TRUE(tracker.wait_for_master(most_seconds));
  tracker.send(HeadMessage{});
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return !c.has_lost_head; }));
}

TEST(ScreenServer, CountsMalformedMessagesAndGoesOn) {
  Master master;
  zmq::context_t context;
  zmq::socket_t stranger(context, zmq::socket_type::dealer);
  stranger.connect(master.server.address());
  stranger.send(zmq::str_buffer("hello"), zmq::send_flags::none);
  stranger.send(zmq::str_buffer(""), zmq::send_flags::none);
  stranger.send(zmq::str_buffer("two"), zmq::send_flags::sndmore);
  stranger.send(zmq::str_buffer("parts"), zmq::send_flags::none);
  EXPECT_TRUE(master.comes_to([](const ScreenCounts& c) { return c.malformed == 3; }));
  Follower left(master.server.address(), "left");
  left.next<SwapMessage>();
}

enum class Handshake { none, welcome, refused };

/// Notes how a handshake ends.
class HandshakeMonitor : public zmq::monitor_t {
 public:
  explicit HandshakeMonitor(zmq::socket_t& socket) {
    init(socket, "inproc://handshake", ZMQ_EVENT_ALL);
  }
  Handshake end() {
    const Stopwatch watch;
    while (end_ == Handshake::none && watch.seconds() < most_seconds) check_event(50);
    return end_;
  }

 private:
  void on_event_handshake_succeeded(const zmq_event_t&, const char*) override {
    end_ = Handshake::welcome;
  }
  void on_event_handshake_failed_auth(const zmq_event_t&, const char*) override {
    end_ = Handshake::refused;
  }
  void on_event_handshake_failed_protocol(const zmq_event_t&, const char*) override {
    end_ = Handshake::refused;
  }

  Handshake end_ = Handshake::none;
};

/// How a peer with these keys fares at a master.
Handshake handshake(const std::string& address, const ScreenKeys& keys) {
  zmq::context_t context;
  zmq::socket_t socket(context, zmq::socket_type::dealer);
  set_up_socket(socket);
  if (keys.are_given()) {
    socket.set(zmq::sockopt::curve_serverkey, keys.master_public);
    socket.set(zmq::sockopt::curve_publickey, keys.screen_public);
    socket.set(zmq::sockopt::curve_secretkey, keys.screen_secret);
  }
  HandshakeMonitor monitor(socket);
  socket.connect(address);
  return monitor.end();
}

TEST(ScreenServer, OnlyKeysOfTheRoomOpenIt) {
  const ScreenKeys keys = make_screen_keys();
  Master master(test_room(), keys);
  const std::string address = master.server.address();
  ScreenKeys forged = make_screen_keys();
  forged.master_public = keys.master_public;
  EXPECT_EQ(handshake(address, {}), Handshake::refused);
  EXPECT_EQ(handshake(address, forged), Handshake::refused);
  EXPECT_EQ(handshake(address, keys), Handshake::welcome);
  Follower left(address, "left", keys);
  left.next<SwapMessage>();
}

TEST(ScreenServer, ListensToOtherMachinesOnlyWithKeys) {
  Room room = test_room();
  room.address = "tcp://*:*";
  EXPECT_THROW(ScreenServer(room, scene, {}), std::runtime_error);
  EXPECT_NO_THROW(ScreenServer(room, scene, make_screen_keys()));
  room.address = "no address";
  EXPECT_THROW(ScreenServer(room, scene, make_screen_keys()), std::runtime_error);
}

TEST(RoomPvx, ReadsMachinesAndNamesWhatHasNoEffect) {
  const Room room = parse_pvx(R"(<?xml version="1.0"?>
    <pvx><Process Type="server"><EyeSeparation Value="0.07"/><UseOffAxisProjection Value="1"/>
      <Option Name="FullScreen" Value="1"/>
      <Machine Name="node1" Environment="DISPLAY=:0.1" Geometry="800x600+10+20"
        LowerLeft="-1 -1 -1" LowerRight="1 -1 -1" UpperRight="1 1 -1" StereoType="Anaglyph"/>
      <Machine Name="localhost" LowerLeft="1 -1 -1" LowerRight="1 -1 1" UpperRight="1 1 1"
        FullScreen="0" ViewerId="1"/>
    </Process></pvx>)",
                              "room.pvx");
  ASSERT_EQ(room.screens.size(), 2u);
  EXPECT_EQ(room.eye_separation, 0.07);
  EXPECT_EQ(room.focus, 1);
  const Screen &first = room.screens[0], &second = room.screens[1];
  EXPECT_EQ(first.host, "node1");
  EXPECT_EQ(first.display, ":0.1");
  EXPECT_EQ(first.window, (std::array<std::int32_t, 4>{10, 20, 800, 600}));
  EXPECT_EQ(first.upper_right, (Point3{1, 1, -1}));
  EXPECT_EQ(first.stereo, Stereo::anaglyph);
  EXPECT_TRUE(first.is_fullscreen);
  EXPECT_EQ(second.host, "");
  EXPECT_FALSE(second.is_fullscreen);
  EXPECT_EQ(room.notes, (std::vector<std::string>{"Machine ViewerId has no effect"}));
}

TEST(RoomPvx, RefusesAWindowThatNoScreenTakes) {
  const auto problem_of = [](const std::string& geometry) -> std::string {
    try {
      parse_pvx(
          "<pvx><Machine Name=\"a\" Geometry=\"" + geometry +
              "\" LowerLeft=\"-1 -1 -1\" LowerRight=\"1 -1 -1\" UpperRight=\"1 1 -1\"/></pvx>",
          "room.pvx");
      return "";
    } catch (const IoError& error) {
      return error.what();
    }
  };
  EXPECT_EQ(problem_of("800x600+65535+0"), "");
  for (const std::string geometry : {"800x600+100000+0", "800x600+0+65536", "16385x600+0+0"}) {
    const std::string problem = problem_of(geometry);
    EXPECT_NE(problem.find("room.pvx"), std::string::npos) << problem;
    EXPECT_NE(problem.find("Geometry"), std::string::npos) << problem;
  }
}

TEST(RoomPvx, NamesTheLineThatIsWrong) {
  for (const std::string text :
       {"", "<pvx>", "<pvx>\n<Machine Name=\"a\" LowerLeft=\"0 0\"/></pvx>", "<pvx/>",
        "<pvx><EyeSeparation Value=\"wide\"/></pvx>"}) {
    try {
      parse_pvx(text, "room.pvx");
      ADD_FAILURE() << text;
    } catch (const IoError& error) {
      EXPECT_NE(std::string(error.what()).find("room.pvx: line "), std::string::npos)
          << error.what();
    }
  }
}

}  // namespace
}  // namespace tetwarp::test
