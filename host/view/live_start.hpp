/// @file live_start.hpp
/// How a live simulation starts.
#pragma once
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <tetwarp/simulate.hpp>

#include "host/view/input_log.hpp"
#include "host/view/view_options.hpp"

namespace tetwarp::view {

/// Of the spring by which the mouse pulls.
constexpr const char* handle_name = "mouse";

/// Whether a replay has steps that a limit of time ended.
bool has_limits(const std::optional<InputLog>& replay);

/// One thread where steps that a limit of time ends are recorded or repeated.
/// @throws std::invalid_argument  these cannot be repeated: several threads, back end cuda
SimulateOptions simulate_options(const ViewOptions& of, const std::optional<InputLog>& replay);

/// @param start  as start_hash()
/// @throws IoError  the replay is of another scene or another start
void check_start(const ViewOptions& options,
                 std::uint64_t start,
                 const std::optional<InputLog>& replay);

/// Goes on from ViewOptions::restart, if that is a file; a pull of that time is over. @returns the
/// checkpoint of the state
/// @throws IoError  it is no checkpoint of this scene
std::vector<std::byte> first_state(const ViewOptions& options, Simulator& simulator);

}  // namespace tetwarp::view
