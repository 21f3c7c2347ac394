#include "io/files/read_check.hpp"

namespace tetwarp {
namespace {
void (*read_check)() = nullptr;
}  // namespace

void set_read_check(void (*check)()) {
  read_check = check;
}

void check_read() {
  if (read_check != nullptr) read_check();
}

}  // namespace tetwarp
