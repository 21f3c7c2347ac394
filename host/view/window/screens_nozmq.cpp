/// @file screens_nozmq.cpp
/// This program was built without ZeroMQ.
#include <stdexcept>

#include "host/view/window/screens.hpp"

namespace tetwarp::view {
namespace {
[[noreturn]] void fail() {
  throw std::runtime_error(
      "screens need ZeroMQ, which this program was built without; install libzmq3-dev, cppzmq-dev "
      "and libexpat1-dev and build again");
}
}  // namespace

class MasterScreens::Impl {};

MasterScreens::MasterScreens(LiveSimulation&, const ViewScene&, const ViewOptions&) {
  fail();
}
MasterScreens::~MasterScreens() = default;
void MasterScreens::wait_for_screens() {}
void MasterScreens::set_view(const MasterView&) {}
const Room& MasterScreens::room() const {
  fail();
}
std::string MasterScreens::status() const {
  return {};
}
void show_screen(const ViewOptions&, const volatile std::sig_atomic_t&) {
  fail();
}
void send_head(const ViewOptions&, const volatile std::sig_atomic_t&) {
  fail();
}
void write_screen_keys(const std::string&) {
  fail();
}

}  // namespace tetwarp::view
