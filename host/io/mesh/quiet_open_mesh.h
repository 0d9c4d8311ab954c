// One caller at a time in OpenMesh, and no output from it on stderr: its reports become FileError.
#pragma once
#include <OpenMesh/Core/System/omstream.hh>
#include <mutex>

namespace pellucid::io {

// Its readers are singletons that keep state, and its error stream is global.
class QuietOpenMesh {
  public:
    QuietOpenMesh() : lock_(mutex()) { ::omerr().disable(); }
    ~QuietOpenMesh() { ::omerr().enable(); }

  private:
    static std::mutex& mutex() {
        static std::mutex m;
        return m;
    }
    std::lock_guard<std::mutex> lock_;
};

}  // namespace pellucid::io
