/// @file test_ccd_turns.cpp
/// Screw motions: no meeting of the true ways is missed, with frames or by the sagitta.
#include <gtest/gtest.h>

#include <cmath>

#include "host/base/point3.hpp"
#include "kernels/collide/plane_ccd.hpp"
#include "tests/collide/constructed_hits.hpp"

namespace tetwarp::test {
namespace {

Point3 point_of(const double* x) {
  return {x[0], x[1], x[2]};
}

Point3 turned(const TurningFrame& frame, const Point3& arm, double time) {
  const Point3 turn = point_of(frame.turn);
  const double angle = norm(turn);
  if (!(angle > 0)) return arm;
  const Point3 axis = times(1 / angle, turn), side = cross(axis, arm);
  return plus(plus(arm, times(std::sin(time * angle), side)),
              times(1 - std::cos(time * angle), cross(axis, side)));
}
Point3 place_at(const TurningFrame& frame, const Point3& x, double time) {
  const Point3 center = point_of(frame.center);
  return plus(plus(center, times(time, point_of(frame.motion))),
              turned(frame, minus(x, center), time));
}

/// Two bodies that turn and move; features of both meet at a known time of their true ways.
struct ScrewHit {
  MovingPair pair;
  TurningFrame frame[2];
  double sagitta[2] = {0, 0};

  MovingPoints points(bool frames, double sagitta_share) const {
    MovingPoints points = pair.points();
    points.sagitta_a = sagitta_share * sagitta[0];
    points.sagitta_b = sagitta_share * sagitta[1];
    if (frames) points.frame_a = &frame[0], points.frame_b = &frame[1];
    return points;
  }
};

class ScrewMaker {
 public:
  explicit ScrewMaker(unsigned seed) : random_(seed) {}

  double share() { return std::uniform_real_distribution<double>()(random_); }
  Point3 vector() { return {normal_(random_), normal_(random_), normal_(random_)}; }
  Point3 vector(double length) {
    const Point3 v = vector();
    return times(length / norm(v), v);
  }
  TurningFrame frame(double angle) {
    TurningFrame frame;
    const Point3 center = vector(), motion = vector(0.3), turn = vector(angle);
    for (std::size_t i = 0; i < 3; ++i) {
      frame.center[i] = center[i], frame.motion[i] = motion[i], frame.turn[i] = turn[i];
    }
    return frame;
  }

  /// Features of a tenth of the distance from the axes.
  ScrewHit make(bool edges, double angle) {
    ScrewHit hit;
    hit.pair.time = share();
    std::array<Point3, 4> place;
    for (Point3& x : place) x = times(0.1, vector());
    const double s = share(), t = share() * (edges ? 1 : 1 - s);
    const std::array<double, 4> weight = edges ? std::array<double, 4>{1 - s, s, t - 1, -t}
                                               : std::array<double, 4>{1, s + t - 1, -s, -t};
    Point3 apart{0, 0, 0};
    for (std::size_t k = 0; k < 4; ++k) apart = plus(apart, times(weight[k], place[k]));
    for (std::size_t k = 0; k < (edges ? 2u : 1u); ++k) place[k] = minus(place[k], apart);
    for (std::size_t side = 0; side < 2; ++side) {
      TurningFrame& own = hit.frame[side] = frame(angle);
      for (std::size_t k = 0; k < 4; ++k) {
        if ((k < (edges ? 2u : 1u)) != (side == 0)) continue;
        hit.pair.start[k] = start_of(own, place[k], hit.pair.time);
        hit.pair.end[k] = place_at(own, hit.pair.start[k], 1);
        const Point3 arm = minus(hit.pair.start[k], point_of(own.center));
        const double radius = norm(cross(point_of(own.turn), arm)) / angle;
        hit.sagitta[side] = std::max(hit.sagitta[side], radius * angle * angle / 8);
      }
    }
    return hit;
  }

 private:
  /// From where the frame takes a point to x.
  static Point3 start_of(const TurningFrame& frame, const Point3& x, double time) {
    TurningFrame back = frame;
    for (double& c : back.turn) c = -c;
    const Point3 center = point_of(frame.center);
    const Point3 moved = plus(center, times(time, point_of(frame.motion)));
    return plus(center, turned(back, minus(x, moved), time));
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
};

/// Meetings that are missed or reported late, of 4,000.
int missed(double angle, bool frames, double sagitta_share) {
  ScrewMaker maker(19);
  int missed = 0;
  for (int k = 0; k < 4000; ++k) {
    const ScrewHit hit = maker.make(k % 2, angle);
    const MovingPoints points = hit.points(frames, sagitta_share);
    const CcdLimits limits = end_check_limits(1e-4);
    const CcdResult result =
        k % 2 ? edge_edge_ccd(points, limits) : vertex_face_ccd(points, limits);
    missed += !(result.time <= hit.pair.time);
  }
  return missed;
}

TEST(CcdTurns, NoScrewMotionIsMissed) {
  for (const double angle : {0.01, 0.05, 0.3, 1.0, 3.0}) {
    EXPECT_EQ(missed(angle, true, 1), 0) << angle;
    EXPECT_EQ(missed(angle, false, 1), 0) << angle;
  }
}

TEST(CcdTurns, ChordsAloneMissScrewMotions) {
  EXPECT_GE(missed(1, false, 0), 800);
  EXPECT_GE(missed(0.3, false, 0), 80);
}

/// Before the time of touch the true ways keep the distance.
TEST(CcdTurns, TheTrueWaysKeepTheDistanceUntilTheTimeOfTouch) {
  ScrewMaker maker(20);
  const CcdLimits limits = end_check_limits(1e-2);
  for (int k = 0; k < 400; ++k) {
    const bool edges = k % 2;
    const ScrewHit hit = maker.make(edges, 1);
    for (const bool frames : {true, false}) {
      const MovingPoints points = hit.points(frames, 1);
      const CcdResult result =
          edges ? edge_edge_ccd(points, limits) : vertex_face_ccd(points, limits);
      if (result.start_distance <= limits.distance) continue;
      for (int s = 0; s <= 10; ++s) {
        std::array<Point3, 4> place;
        for (std::size_t p = 0; p < 4; ++p) {
          const TurningFrame& own = hit.frame[p < (edges ? 2u : 1u) ? 0 : 1];
          place[p] = place_at(own, hit.pair.start[p], result.time * s / 10);
        }
        ASSERT_GT(searched_distance(place, edges), limits.distance * (1 - 1e-9)) << k;
      }
    }
  }
}

/// A vertex that turns about its own center against a plane that turns about another: the height at
/// the time of touch, and before.
TEST(CcdTurns, VerticesTouchTurningPlanesInTime) {
  ScrewMaker maker(21);
  int touched = 0;
  for (int k = 0; k < 4000; ++k) {
    const double angle = k % 4 == 0 ? 0 : 0.7 * maker.share();
    const TurningFrame frame[2] = {maker.frame(0.7), maker.frame(angle)};
    const Point3 x = maker.vector(), point = maker.vector(), normal = maker.vector(1);
    const Point3 x_end = place_at(frame[0], x, 1), point_end = place_at(frame[1], point, 1);
    const Point3 normal_end = turned(frame[1], normal, 1);
    MovingPoints points{};
    points.start[0] = x.data(), points.end[0] = x_end.data();
    points.frame_a = &frame[0];
    points.radius = 0.05;
    const MovingPlane plane{point.data(), normal.data(), point_end.data(), normal_end.data(),
                            &frame[1]};
    const CcdLimits limits = end_check_limits(1e-2);
    const CcdResult result = vertex_plane_ccd(points, plane, limits);
    const auto height = [&](double time) {
      return dot(minus(place_at(frame[0], x, time), place_at(frame[1], point, time)),
                 turned(frame[1], normal, time)) -
             points.radius;
    };
    EXPECT_NEAR(result.start_distance, height(0), 1e-13);
    if (result.start_distance <= limits.distance) continue;
    touched += result.time <= 1;
    for (int s = 0; s <= 40; ++s) {
      ASSERT_GT(height(std::min(result.time, 1.0) * s / 40), limits.distance * (1 - 1e-9)) << k;
    }
    if (result.time <= 1) {
      ASSERT_LE(height(result.time), limits.distance + limits.slack + 1e-12);
    }
  }
  EXPECT_GT(touched, 200);
}

/// Without frames a plane turns by the least angle about its point; by half a turn it is no answer.
TEST(CcdTurns, PlanesWithoutFramesTurnByTheLeastAngle) {
  const Point3 x{1, 0, 0.5}, origin{0, 0, 0}, up{0, 0, 1}, aside{-std::sin(1.0), 0, std::cos(1.0)};
  const Point3 down{0, 0, -1};
  MovingPoints points{};
  points.start[0] = points.end[0] = x.data();
  const CcdLimits limits = end_check_limits(1e-5);
  const CcdResult result =
      vertex_plane_ccd(points, {origin.data(), up.data(), origin.data(), aside.data()}, limits);
  EXPECT_NEAR(result.time, std::atan2(0.5, 1.0), 2e-6);
  EXPECT_EQ(
      vertex_plane_ccd(points, {origin.data(), up.data(), origin.data(), down.data()}, limits).time,
      0);
}

/// A wheel rolls on a floor: it touches nothing where its frame is known.
TEST(CcdTurns, ARollingWheelAtRestOnTheThicknessDoesNotTouch) {
  const double h = 1e-4, angle = 0.3;
  const TurningFrame frame = {{0, 0, 1 + h}, {angle, 0, 0}, {0, angle, 0}};
  const Point3 origin{0, 0, 0}, up{0, 0, 1};
  for (int k = -20; k <= 20; ++k) {
    const double at = 0.02 * k;
    const Point3 x{std::sin(at), 0, 1 + h - std::cos(at)}, end = place_at(frame, x, 1);
    MovingPoints points{};
    points.start[0] = x.data(), points.end[0] = end.data();
    points.frame_a = &frame;
    const CcdResult result = vertex_plane_ccd(
        points, {origin.data(), up.data(), origin.data(), up.data()}, end_check_limits(h));
    EXPECT_GT(result.time, 1) << at;
    EXPECT_LE(result.evaluations, 40);
  }
}

}  // namespace
}  // namespace tetwarp::test
