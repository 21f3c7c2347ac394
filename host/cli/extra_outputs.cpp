/// @file extra_outputs.cpp
#include "host/cli/extra_outputs.hpp"

#include <cstdint>

namespace tetwarp::cli {

void set_extra_output(WarpTarget& target, std::size_t number, void* samples) {
  FieldTarget& fields = target.fields;
  float** const reals[] = {&fields.displacement, &fields.jacobian, &fields.gradient, &fields.strain,
                           &fields.forward};
  if (number == 0) {
    target.mask = static_cast<std::uint8_t*>(samples);
  } else if (number == 1) {
    target.owner = static_cast<std::int32_t*>(samples);
  } else {
    *reals[number - 2] = static_cast<float*>(samples);
  }
}

}  // namespace tetwarp::cli
