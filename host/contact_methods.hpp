/// @file contact_methods.hpp
/// Methods for one island whose blocks A does not couple: sweeps, and what makes them faster.
#pragma once
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

#include "host/contact_accelerators.hpp"
#include "host/contact_monitor.hpp"
#include "host/contact_pipeline.hpp"

namespace tetwarp {

/// Diagonal metric in which impulses are compared: 1 / rho of the natural residual.
template <class T>
std::vector<double> impulse_weights(View<const ContactConstants<T>> constants) {
  std::vector<double> weights;
  for (std::int64_t c = 0; c < constants.size; ++c) {
    const ContactConstants<T>& contact = constants[c];
    const double normal = contact.block[0], tangent = contact.tangent_metric;
    weights.push_back(normal / (1 + normal * contact.normal_spring));
    weights.insert(weights.end(), 2, tangent / (1 + tangent * contact.tangent_spring));
  }
  return weights;
}

/// The methods of an island. Each goes on from the impulses at hand and returns why it stopped; the
/// best iterate is in `best()`.
template <class Exec, class T>
class ContactMethods {
 public:
  ContactMethods(ContactPipeline<Exec, T>& pipeline, ContactMonitor<T>& monitor)
      : pipeline_(pipeline), monitor_(monitor), weights_(impulse_weights(pipeline.constants())) {
    before_.resize(weights_.size());
    best_.assign(pipeline_.impulse().data, pipeline_.impulse().data + pipeline_.impulse().size);
  }

  /// Measures the impulses at hand. True: done.
  bool is_done_at_start() {
    pipeline_.follow_impulses();
    return measure(0);
  }

  StopReason gauss_seidel(std::int64_t patience, const CalmContacts<T>& calm) {
    return iterate<PlainSteps<Exec, T>>(patience, calm);
  }
  StopReason anderson(std::int64_t patience) {
    return iterate<AndersonMixer<Exec, T>>(patience, {});
  }
  StopReason conjugate_directions(std::int64_t patience) {
    return iterate<ConjugateDirection<Exec, T>>(patience, {});
  }

  /// Nesterov's acceleration, restarted when it leads uphill, of contacts solved all at once in the
  /// metric of split masses.
  StopReason mass_splitting(std::int64_t patience) {
    monitor_.start_method(patience);
    const std::vector<ContactConstants<T>> metric = pipeline_.split_metric();
    const View<T> x = pipeline_.impulse();
    std::vector<T> last(x.data, x.data + x.size);
    double momentum = 1;
    while (!monitor_.is_exhausted()) {
      std::copy_n(x.data, x.size, before_.data());
      pipeline_.split(view_of(metric));
      monitor_.count_sweep();
      const double defect = defect_of<Exec, T>(pipeline_.exec(), weights_, view_of(before_), x);
      if (monitor_.is_due(defect)) {
        pipeline_.follow_impulses();
        if (measure(defect)) break;
      }
      double uphill = 0;
      for (std::size_t i = 0; i < last.size(); ++i) {
        const T step = x.data[i] - last[i];
        uphill += weights_[i] * (double{before_[i]} - double{x.data[i]}) * step;
      }
      if (uphill > 0) momentum = 1;
      const double next = (1 + std::sqrt(1 + 4 * momentum * momentum)) / 2;
      const T factor = uphill > 0 ? T(0) : static_cast<T>((momentum - 1) / next);
      momentum = next;
      for (std::size_t i = 0; i < last.size(); ++i) {
        const T now = x.data[i];
        x.data[i] += factor * (now - last[i]);
        last[i] = now;
      }
      pipeline_.follow_impulses();
    }
    return monitor_.reason();
  }

  /// Takes the best impulses back.
  void restore_best() {
    std::copy(best_.begin(), best_.end(), pipeline_.impulse().data);
    pipeline_.follow_impulses();
  }

 private:
  template <class Accelerator>
  StopReason iterate(std::int64_t patience, CalmContacts<T> calm) {
    Accelerator accelerator(pipeline_.exec(), weights_);
    monitor_.start_method(patience);
    const View<T> x = pipeline_.impulse();
    const View<const T> before = {before_.data(), x.size};
    while (!monitor_.is_exhausted()) {
      std::copy_n(x.data, x.size, before_.data());
      calm.all_awake = calm.visits.size == 0 || monitor_.sweeps() % CalmContacts<T>::pause == 0;
      pipeline_.sweep(calm);
      monitor_.count_sweep();
      const double defect = accelerator.observe(before, x);
      if (monitor_.is_due(defect) && measure(defect)) break;
      if (accelerator.advance(before, x, defect)) pipeline_.follow_impulses();
    }
    return monitor_.reason();
  }

  bool measure(double defect) {
    const View<T> x = pipeline_.impulse();
    return monitor_.take(pipeline_.measure(), defect,
                         [&] { std::copy_n(x.data, x.size, best_.data()); });
  }

  ContactPipeline<Exec, T>& pipeline_;
  ContactMonitor<T>& monitor_;
  std::vector<double> weights_;
  std::vector<T> before_;
  std::vector<T> best_;
};

}  // namespace tetwarp
