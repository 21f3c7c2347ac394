/// @file screen_keys.hpp
/// ScreenKeys: key pairs that authenticate master and screens, and their files.
#pragma once
#include <string>

namespace tetwarp::view {

/// Keys of ZeroMQ's CURVE in its text form, 40 letters each; those that a file lacks are empty.
struct ScreenKeys {
  std::string master_public, master_secret;
  std::string screen_public, screen_secret;

  bool are_given() const { return !master_public.empty(); }
};

/// The text of the file for the master, or of that for the screens, which lacks the other's secret.
std::string master_text(const ScreenKeys& keys);
std::string screen_text(const ScreenKeys& keys);

/// @param is_master  whether the secret of the master is needed, else that of the screens
/// @throws IoError  in one line naming the file
ScreenKeys read_screen_keys(const std::string& path, bool is_master);

/// Keys in use are not overwritten. @throws IoError  there is such a file or link
void check_no_file(const std::string& path);

/// Whether an address of ZeroMQ is reached from this machine alone.
bool is_loopback(const std::string& address);

}  // namespace tetwarp::view
