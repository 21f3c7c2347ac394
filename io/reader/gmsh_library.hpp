/// @file gmsh_library.hpp
/// Gmsh's C functions, loaded when the first mesh is read: it depends on about a hundred libraries,
/// which would slow down the start of every program that links them.
#pragma once
#include <dlfcn.h>
#include <gmshc.h>

#include <cstddef>
#include <string>
#include <tetwarp/error.hpp>
#include <type_traits>

namespace tetwarp {

/// One session of Gmsh; there can be one at a time.
class GmshLibrary {
 public:
  /// Throws IoError about `path` when the library cannot be loaded.
  explicit GmshLibrary(const std::string& path)
      : path_(path), library_(dlopen(TETWARP_GMSH_SONAME, RTLD_NOW | RTLD_LOCAL)) {
    if (library_ == nullptr) {
      throw IoError(path, "",
                    std::string(dlerror()) + "; install the package of " TETWARP_GMSH_SONAME);
    }
    start(function<decltype(gmshInitialize)>("gmshInitialize"));
    call<decltype(gmshOptionSetNumber)>("gmshOptionSetNumber", "General.Terminal", 0.0);
  }
  GmshLibrary(const GmshLibrary&) = delete;
  GmshLibrary& operator=(const GmshLibrary&) = delete;
  ~GmshLibrary() {
    int error = 0;
    function<decltype(gmshFinalize)>("gmshFinalize")(&error);
  }

  /// Calls a function by its name with all arguments except for the last, the error code.
  /// Throws IoError when it fails.
  template <class Function, class... Arguments>
  void call(const char* name, Arguments... arguments) const {
    int error = 0;
    function<Function>(name)(arguments..., &error);
    if (error != 0) throw IoError(path_, "", "Gmsh cannot read it: " + last_error());
  }

  /// Frees memory that a call has allocated.
  void free(void* memory) const { function<decltype(gmshFree)>("gmshFree")(memory); }

 private:
  std::string last_error() const {
    char* text = nullptr;
    int error = 0;
    function<decltype(gmshLoggerGetLastError)>("gmshLoggerGetLastError")(&text, &error);
    std::string copy = text != nullptr ? text : "no reason given";
    free(text);
    return copy;
  }

  template <class Function>
  Function* function(const char* name) const {
    void* const address = dlsym(library_, name);
    if (address == nullptr) throw IoError(path_, "", std::string(dlerror()));
    return reinterpret_cast<Function*>(address);
  }

  /// Initializes Gmsh without the configuration files of the user. Later versions have one more
  /// parameter.
  template <class Function>
  static void start(Function* initialize) {
    int error = 0;
    if constexpr (std::is_invocable_v<Function, int, char**, int, int*>) {
      initialize(0, nullptr, 0, &error);
    } else {
      initialize(0, nullptr, 0, 0, &error);
    }
  }

  std::string path_;
  void* library_;
};

/// An array that Gmsh has made.
template <class T>
struct GmshArray {
  explicit GmshArray(const GmshLibrary& library) : gmsh(library) {}
  GmshArray(const GmshArray&) = delete;
  GmshArray& operator=(const GmshArray&) = delete;
  ~GmshArray() { gmsh.free(data); }

  const T& operator[](std::size_t i) const { return data[i]; }

  const GmshLibrary& gmsh;
  T* data = nullptr;
  std::size_t size = 0;
};

/// An array of arrays of several sizes.
template <class T>
struct GmshArrays {
  explicit GmshArrays(const GmshLibrary& library) : gmsh(library) {}
  GmshArrays(const GmshArrays&) = delete;
  GmshArrays& operator=(const GmshArrays&) = delete;
  ~GmshArrays() {
    for (std::size_t i = 0; i < size; ++i) gmsh.free(data[i]);
    gmsh.free(data);
    gmsh.free(sizes);
  }

  const GmshLibrary& gmsh;
  T** data = nullptr;
  std::size_t* sizes = nullptr;
  std::size_t size = 0;
};

}  // namespace tetwarp
