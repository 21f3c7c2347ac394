/// @file progress.cpp
/// Shows the progress of a step and cancels one at half its work. Afterwards the Warper can compute
/// the next step.
#include <cstdio>
#include <tetwarp/tetwarp.hpp>

int main() {
  const tetwarp::Volume source = tetwarp::make_phantom({160, 100, 76});
  const tetwarp::Mesh mesh = tetwarp::make_lattice_mesh(source);
  const auto twisted = tetwarp::deform_positions(mesh, {}, 1.0);
  // Back end cpu reports 32 times per step, cuda once at its end.
  tetwarp::Warper warper(source, mesh, {.backend = tetwarp::Backend::cpu});
  tetwarp::Volume result = tetwarp::make_volume(warper.output_grid(), source.type);
  void* const samples = result.data.data();

  // Called on this thread within step(). Returning false cancels the step.
  const auto run_until = [&](double limit) {
    const auto report = [limit](double fraction) {
      std::printf("\r%3.0f %%", 100 * fraction);
      return fraction < limit;
    };
    try {
      warper.step(twisted, {.volumes = {&samples, 1}}, report);
      std::puts(" finished");
      return true;
    } catch (const tetwarp::Cancelled&) {
      std::puts(" cancelled");  // `result` holds nothing valid now
      return false;
    }
  };
  const bool first = run_until(0.5), second = run_until(2.0);
  return !first && second && warper.report().steps.size() == 1 ? 0 : 1;
}
