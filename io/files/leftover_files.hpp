/// @file leftover_files.hpp
/// Temporary files of processes that were killed: how they are recognized and removed.
#pragma once
#include <string>

#include <tetwarp/io_export.hpp>

namespace tetwarp {

/// How the names of temporary files of this process begin: `.<pid>-<place>.`, where <place> stands
/// for the machine and its numbering of processes. Elsewhere, e.g. in a container or on a machine
/// that shares the folder, the number of a process means another one.
std::string temporary_start();

/// Removes the temporary files that processes of this machine left in a folder when they were
/// killed. Only the first call for a folder does. @param folder  empty or ending with a slash
TETWARP_IO_EXPORT void remove_leftovers_once(const std::string& folder);

}  // namespace tetwarp
