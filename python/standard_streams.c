/// @file standard_streams.c
/// The standard streams for the archives that are linked into the module of a wheel.
///
/// Debian compiles the archive of HDF5 for programs: its code may reach data of its own file only,
/// and the only data of another library that it uses are `stdout` and `stderr`. The linker's
/// options --wrap=stdout and --wrap=stderr lead it to these copies.
#include <stdio.h>

extern FILE* __real_stdout;
extern FILE* __real_stderr;
__attribute__((visibility("hidden"))) FILE* __wrap_stdout;
__attribute__((visibility("hidden"))) FILE* __wrap_stderr;

__attribute__((constructor)) static void copy_streams(void) {
  __wrap_stdout = __real_stdout;
  __wrap_stderr = __real_stderr;
}
