/// @file test_scene_bad.cpp
/// Scene files with one mistake each: the message names the key and the remedy in one line.
#include <gtest/gtest.h>

#include "tests/scene/scene_texts.hpp"

namespace tetwarp::test {
namespace {
struct Slip {
  const char* part;     ///< of full_scene
  const char* by;       ///< what stands there instead
  const char* message;  ///< its beginning, after the name of the file
};

const Slip slips[] = {
    {"\"tetwarp_scene\": 1, ", "", "tetwarp_scene: is missing, expected 1, the version"},
    {"\"tetwarp_scene\": 1", "\"tetwarp_scene\": 2", "tetwarp_scene: is no version"},
    {"\"time_step\": 0.01", "\"time_step\": 0", "time_step: is 0, expected a number above 0 (s)"},
    {"\"time_step\": 0.01", "\"time_step\": \"1\"", "time_step: is text, expected a number"},
    {"\"time_step\": 0.01", "\"time_step\": 1e-12", "duration: is more than 1e9 steps"},
    {"\"duration\": 0.5", "\"duration\": -1", "duration: is -1, expected a number from 0 (s)"},
    {"\"duration\": 0.5", "\"duration\": 1e999", "holds a number beyond 1e308"},
    {"\"duration\": 0.5", "\"duration\": NaN", "line 2, column 54: is not valid JSON"},
    {"\"gravity\"", "\"gravty\"", "gravty: is no known key; did you mean 'gravity'?"},
    {"[1, 2, 3], \"thickness\"", "[1, 2], \"thickness\"",
     "gravity: is a list of 2, expected a list of 3 numbers"},
    {"\"thickness\": 1e-3", "\"thickness\": 0", "thickness: is 0, expected a number above 0 (m)"},
    {"\"thickness\": 1e-3", "\"time_step\": 1", "time_step: stands twice in one object"},
    {"\"friction\": 0.25", "\"friction\": -0.25", "contact.friction: is -0.25, expected"},
    {"\"stiffness\": 4e7, ", "", "contact.adhesion.stiffness: is missing, expected a number"},
    {"\"initial_intensity\": 0.5", "\"initial_intensity\": 1.5",
     "contact.adhesion.initial_intensity: is 1.5, expected 0 to 1"},
    {"\"b\": \"floor\"", "\"b\": \"flor\"",
     "contact.pairs[0].b: there is no body or obstacle 'flor', expected one of "},
    {"\"name\": \"stone\"", "\"name\": \"soft\"",
     "bodies[1].name: 'soft' is already a body or obstacle"},
    {"\"name\": \"stone\"", "\"name\": \"a b\"", "bodies[1].name: is no name: use"},
    {"\"name\": \"stone\"", "\"name\": \"world\"", "bodies[1].name: 'world' names the fixed"},
    {"\"name\": \"floor\"", "\"name\": \"soft\"", "obstacles[0].name: 'soft' is already"},
    {"\"kind\": \"fem\"", "\"kind\": \"soft\"",
     "bodies[0].kind: is no known word, expected one of fem, rigid, cloth, scripted"},
    {"\"kind\": \"fem\"", "\"kind\": \"rigid\"", "bodies[0].mass: is text, expected a number"},
    {"\"kind\": \"cloth\"", "\"kind\": \"scripted\"",
     "bodies[3].stretch: is not for scripted bodies"},
    {"\"type\": \"box\"", "\"type\": \"cube\"",
     "bodies[0].shape.type: is no shape, expected one of box, sphere"},
    {"\"type\": \"box\"", "\"type\": \"bix\"",
     "bodies[0].shape.type: is no shape, expected one of box, sphere, ellipsoid, capsule, "
     "cylinder, "
     "torus, arc, bent_strip, plate, loft; did you mean 'box'?"},
    {"\"half\": [1, 2, 3]", "\"half\": [1, 2, -3]",
     "bodies[0].shape.half: is -3, expected a number above 0 (m)"},
    {"\"half\": [1, 2, 3]", "\"halb\": [1, 2, 3]", "bodies[0].shape.half: is missing"},
    {"\"ends\": [0.3, 0.4]", "\"ends\": [0.3, 0]",
     "bodies[12].shape.tubes[0]: ends: is 0, expected a number above 0 (m)"},
    {"\"center\": [1, 0, 5]", "\"center\": [0, 0, 5]",
     "bodies[12].shape.tubes[1]: stations[1].center: is that of the station before, move it"},
    {"\"lattice\": {\"cells\": [6, 2, 2]},", "",
     "bodies[13].shape: needs a lattice beside it, e.g. {\"cells\": [8, 2, 2]}"},
    {"\"density\": 2000, ", "\"density\": 2000, \"lattice\": {\"tets\": 9}, ",
     "bodies[12].lattice: is not for rigid bodies, remove it or change the kind"},
    {"{\"type\": \"loft\", \"tubes\": [", "{\"type\": \"loft\", \"tubes\": [], \"ends\": [",
     "bodies[12].shape.tubes: is empty, expected a tube or more"},
    {"\"kind\": \"rigid\", \"density\": 2000", "\"kind\": \"cloth\", \"density\": 2000",
     "bodies[12].shape: is no cloth; expected a sheet or a mesh"},
    {"\"tube\": 0.25", "\"tube\": 2", "bodies[6].shape.tube: is 2, expected less than the radius"},
    {"[0.2, 2.2]", "[2.2, 0.2]", "bodies[7].shape.angles: the second one is not above"},
    {"[0.2, 2.2]", "[0.2, 6.3]", "bodies[7].shape.angles: the ends of the arc meet"},
    {"\"cells\": [2, 4, 6]", "\"cells\": [2, 4.5, 6]",
     "bodies[0].lattice.cells[1]: is the number 4.5, expected a whole number from 1"},
    {"\"cells\": [2, 4, 6]", "\"cells\": [2, 0, 6]",
     "bodies[0].lattice.cells[1]: is the number 0, expected a whole number from 1"},
    {"\"cells\": [2, 4, 6]", "\"cells\": [2000, 4000, 6000]",
     "bodies[0].lattice.cells: 2^31 or more tetrahedra"},
    {"\"cells\": [2, 4, 6]", "\"cells\": [2, 4, 6], \"edge\": 1",
     "bodies[0].lattice: expected exactly one of cells, edge and tets"},
    {"\"lattice\": {\"cells\": [2, 4, 6]}, ", "", "bodies[0].lattice: is missing; give"},
    {"{\"triangles\": 500}", "{\"triangles\": 3}",
     "bodies[0].surface.triangles: is the number 3, expected a whole number from 4"},
    {"{\"triangles\": 500}", "{}",
     "bodies[0].surface: expected one of triangles, mesh and distance"},
    {"\"E\": 1e5, \"nu\": 0.4", "\"E\": -1, \"nu\": 0.4",
     "bodies[0].material.E: is -1, expected a number above 0 (Pa)"},
    {"\"nu\": 0.4", "\"nu\": 0.5", "bodies[0].material.nu: is 0.5, expected more than -1 and less"},
    {"\"density\": 950", "\"density\": 0", "bodies[0].material.density: is 0, expected"},
    {"\"density\": 950", "\"rho\": 950", "bodies[0].material.density: is missing"},
    {"\"alpha\": 0.5", "\"alpha\": -1", "bodies[0].damping.alpha: is -1, expected"},
    {"\"mass\": \"lumped\"", "\"mass\": \"both\"",
     "bodies[0].mass: is no known word, expected one of consistent, lumped"},
    {"\"axis_angle\": [0, 0, 3.141592653589793]",
     "\"axis_angle\": [0, 0, 1], \"quaternion\": [1, 0, 0, 0]",
     "bodies[0].pose: expected either axis_angle or quaternion"},
    {"[0, 0, 2, 0]", "[0, 0, 0, 0]", "bodies[1].pose.quaternion: expected [w, x, y, z]"},
    {"\"collide\": false, \"self\"", "\"collide\": 0, \"self\"",
     "bodies[0].collide: is the number 0, expected true or false"},
    {"\"velocity\": [7, 8, 9]", "\"velocity\": [7, \"8\", 9]",
     "bodies[0].velocity[1]: is text, expected a number"},
    {"[[-9, -9, -9], [9, 9, 3.5]]", "[[-9, -9, 9], [9, 9, 3.5]]",
     "bodies[0].fixed.box: its first corner lies beyond its second one"},
    {"\"fixed\": {\"box\"", "\"fixed\": {\"boxes\"",
     "bodies[0].fixed.boxes: is no known key; did you mean 'box'?"},
    {"[0, 0, 1, 8.5]", "[0, 0, 0, 8.5]",
     "bodies[0].driven[0].select.half_space: has length 0, expected a vector"},
    {"[1, 0, 0, 2]]", "[0, 0, 0, 2]]", "bodies[0].driven[0].path[1]: time 0 s is not after 0 s"},
    {"[1, 0, 0, 2]]", "[1, null]]", "bodies[0].driven[0].path[1]: is null, which only"},
    {"[1, 0, 0, 2]]", "[1, 0, 2]]", "bodies[0].driven[0].path[1]: is a list of 3, expected"},
    {"\"mass\": 3,", "\"mass\": -3,", "bodies[1].mass: is -3, expected a number above 0 (kg)"},
    {"\"mass\": 3,", "", "bodies[1].mass: is missing beside inertia"},
    {"\"mass\": 3,", "\"mass\": 3, \"density\": 1,",
     "bodies[1]: expected either density, or mass and inertia"},
    {"[1, 1.5, 2, 0.1, 0.2, 0.3]", "[1, 1, 5, 0, 0, 0]",
     "bodies[1].inertia: its largest principal moment exceeds"},
    {"[1, 1.5, 2, 0.1, 0.2, 0.3]", "[1, 1, -1, 0, 0, 0]",
     "bodies[1].inertia: is not positive definite"},
    {"[[0, 2, 0], [0, 0, 3]]", "[[0, 2, 0], [0, 1, 3]]",
     "bodies[3].sheet.axes: are not at right angles"},
    {"[[0, 2, 0], [0, 0, 3]]", "[[0, 0, 0], [0, 1, 3]]",
     "bodies[3].sheet.axes[0]: expected a vector with a direction"},
    {"\"areal_density\": 0.3, ", "", "bodies[3].areal_density: is missing, expected"},
    {"{\"sphere\": [5, 6, 7, 0.5]}", "{\"sphere\": [5, 6, 7, 0]}",
     "bodies[3].fixed[0].sphere: is 0, expected a number above 0 (radius, m)"},
    {"{\"nodes\": [0, 3]}", "{\"label\": 3}",
     "bodies[3].fixed[1].label: 'flag' is not made of a volume"},
    {"\"all\"]", "\"al\"]", "bodies[3].fixed[2]: is no selection, expected \"all\""},
    {"\"axis\": [1, 0, 0]", "\"axis\": [0, 0, 0]", "bodies[4].hinge.axis: has length 0"},
    {"\"lateral\": 1", "\"lateral\": 2", "bodies[5].wave.lateral: equals axis"},
    {"\"lateral\": 1", "\"lateral\": 3", "bodies[5].wave.lateral: is 3, expected 0, 1 or 2"},
    {"\"phantom\": \"orange\"", "\"phantom\": \"apple\"",
     "bodies[11].volume.phantom: is no phantom, expected one of torso, orange, fish"},
    {"\"dims\": [8, 9, 10]", "\"dims\": [900000, 900000, 900000]", "bodies[11].volume: the grid"},
    {"\"dims\": [8, 9, 10]", "\"dims\": [90000, 90000, 90000]", "bodies[11].volume: needs "},
    {"\"spacing\": [0.01", "\"spacing\": [-0.01", "bodies[11].volume: the grid"},
    {"{\"value\": 1, ", "{\"value\": -1, ", "bodies[11].transfer[1].value: is not above"},
    {"\"E\": 4e5", "\"E\": 0", "bodies[11].transfer: no entry has E and density above 0"},
    {"\"lookup\": \"label\"", "\"lookup\": \"cubic\"", "bodies[11].lookup: is no known word"},
    {"\"plane\": {\"normal\": [0, 0, 2]", "\"plane\": {\"normal\": [0, 0, 0]",
     "obstacles[0].plane.normal: has length 0"},
    {"\"type\": \"sphere\", \"centre\"", "\"type\": \"cone\", \"centre\"",
     "obstacles[1].type: is no type of obstacle, expected plane"},
    {"\"type\": \"sphere\", \"centre\"", "\"centre\"",
     "obstacles[1].centre: is no known key; the keys here are"},
    {"\"a\": \"soft\", \"b\": \"jaw\"", "\"a\": \"softy\", \"b\": \"jaw\"",
     "couplings[0].a: there is no body or obstacle 'softy'"},
    {"\"a\": \"soft\", \"b\": \"jaw\"", "\"a\": \"soft\", \"b\": \"soft\"",
     "couplings[0].b: equals a"},
    {"\"a\": \"soft\", \"b\": \"jaw\"", "\"a\": \"fish\", \"b\": \"tool\"",
     "couplings[0]: forces move neither a nor b"},
    {"\"select_a\": \"all\", ", "", "couplings[0]: expected either select_a or points"},
    {"\"stiffness\": 1e4", "\"stiffness\": 0",
     "couplings[0].stiffness: is 0, expected a number above 0 (N/m in total)"},
    {"\"handle\": \"soft\"", "\"handle\": \"jaw\"", "handles[0].handle: 'jaw' is scripted"},
    {"\"handle\": \"soft\"", "\"handle\": \"floor\"", "handles[0].handle: 'floor' is an obstacle"},
    {"[0.5, 0.03, 0, 0]", "[0.5, null]", "handles[0].path[1]: lets go before the end"},
    {"\"force\": [1, 2, 3]", "\"force\": [1, 2, 3], \"pressure\": 1",
     "loads[0]: expected either force or pressure"},
    {"\"to\": 0.2", "\"to\": 0.1", "loads[0].to: is not after from (0.1 s)"},
    {"\"linear_tolerance\": 1e-8", "\"linear_tolerance\": 1", "solver.linear_tolerance: is 1,"},
    {"\"max_passes\": 3", "\"max_passes\": 2.5", "solver.max_passes: is the number 2.5"},
    {"\"law\": \"pyramid\"", "\"law\": \"ball\"", "solver.law: is no known word"},
    {"\"every\": 5", "\"every\": 0", "output.every: is the number 0, expected a whole number"},
    {"\"target\": [4, 5, 6]", "\"target\": [1, 2, 3]", "camera.target: is the place of the eye"},
    {"\"up\": [0, 1, 0]", "\"up\": [3, 3, 3]", "camera.up: is along the line of sight"},
    {"\"angle\": 0.75", "\"angle\": 4", "camera.angle: expected an angle of view above 0"},
    {"\"target\": [1, 1, 1]", "\"target\": [7, 8, 9]",
     "cameras[0].target: is the place of the eye"},
    {"\"up\": [1, 0, 0]", "\"up\": [0, 0, 1]", "cameras[1].up: is along the line of sight"},
    {"\"name\": \"above\", ", "", "cameras[1]"},
    {"\"name\": \"above\"", "\"name\": \"from above\"", "cameras[1].name: is no name"},
    {"\"name\": \"above\"", "\"name\": \"inside\"",
     "cameras[1].name: 'inside' names two of the cameras"},
    {"\"angle\": 1.25", "\"angel\": 1.25", "cameras[0].angel: is no known key"},
    {"\"every\": 5", "\"every\": 5, \"rate\": 2", "output: expected either every or rate"},
    {"\"stress\"", "\"strain\"", "output.fields[1]: is no field, expected velocity"},
    {"\"stress\"", "\"velocity\"", "output.fields[1]: is listed twice"},
};

TEST(SceneSlips, AreNamedInOneLine) {
  for (const Slip& slip : slips) {
    const std::string problem = problem_of(with(full_scene, slip.part, slip.by));
    EXPECT_TRUE(problem.starts_with(slip.message))
        << slip.part << " -> " << slip.by << "\n  is:       " << problem
        << "\n  expected: " << slip.message;
    EXPECT_EQ(problem.find('\n'), std::string::npos);
  }
}

TEST(SceneSlips, NameFileAndKeyApart) {
  try {
    scene_of(with(full_scene, "\"nu\": 0.4", "\"nu\": 0.5"));
    FAIL();
  } catch (const IoError& error) {
    EXPECT_EQ(error.file(), "s.json");
    EXPECT_EQ(error.dataset(), "bodies[0].material.nu");
  }
}

TEST(SceneSlips, OfTheWholeFile) {
  EXPECT_EQ(problem_of(""),
            "line 1, column 1: is not valid JSON; correct it (comments, NaN and "
            "trailing commas are not JSON)");
  EXPECT_EQ(problem_of("[1]"), "is a list of 1, expected a scene {\"tetwarp_scene\": 1, ...}");
  EXPECT_EQ(problem_of(R"({"tetwarp_scene": 1, "time_step": 1, "duration": 1, "bodies": []})"),
            "bodies: is empty, expected a body or more");
  EXPECT_EQ(problem_of(with(small_scene, "\"kind\"", "\"a\\nb\": 1, \"kind\"")).find('\n'),
            std::string::npos);
}

TEST(SceneSlips, OfGeometry) {
  const auto of = [](const std::string& by) {
    return problem_of(with(small_scene, "\"shape\": {\"type\": \"sphere\", \"radius\": 0.1},", by));
  };
  EXPECT_EQ(of(""), "bodies[0]: a rigid body needs a shape, a volume or a mesh of triangles");
  EXPECT_EQ(of(R"("sheet": {"size": [1, 1], "cells": [1, 1]},)"),
            "bodies[0]: a rigid body needs a shape, a volume or a mesh of triangles");
  EXPECT_EQ(of(R"("mesh": {"file": ""},)"),
            "bodies[0].mesh.file: is empty, expected the name of a file");
  EXPECT_TRUE(of(R"("volume": {"file": "no.nii", "threshold": 1},)")
                  .starts_with("bodies[0].volume.file: no.nii: "));
  EXPECT_EQ(of(R"("volume": {"file": "no.nii"},)"),
            "bodies[0].volume.threshold: is missing, expected a number: foreground is from there "
            "on");
  EXPECT_EQ(of(R"("shape": {"type": "sphere", "radius": 1}, "mesh": {"file": "x"},)"),
            "bodies[0]: has several geometries, expected one of shape, volume, mesh and sheet");
}
}  // namespace
}  // namespace tetwarp::test
