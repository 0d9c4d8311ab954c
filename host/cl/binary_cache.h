// Programs from binaries that earlier processes left on disk (docs/guide/devices.md, "Compiled programs").
#pragma once
#include <optional>
#include <string>

#include "cl/binary_files.h"
#include "cl/handle.h"

namespace pel::cl {

class BinaryCache {
  public:
    // If the driver keeps compiled programs itself, this cache loads only PoCL's, and stores none unless
    // PELLUCID_CACHE is "on".
    BinaryCache(cl_context context, cl_device_id device);

    // Empty when there is none, or the driver refuses it.
    Program load(const std::string& source, const std::string& options) const;
    // False if it could not be stored.
    bool store(const Program& program, const std::string& source, const std::string& options) const;

  private:
    Digest name(const std::string& source, const std::string& options) const;

    cl_context context_;
    cl_device_id device_;
    std::string builtBy_;  // whatever else the driver's output depends on
    std::optional<BinaryFiles> files_;
    bool stores_ = false;
};

}  // namespace pel::cl
