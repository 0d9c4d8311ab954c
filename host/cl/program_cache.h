// Programs for one device: each is built once per kernel file and options, or loaded from disk
// (docs/guide/devices.md, "Compiled programs").
#pragma once
#include <map>
#include <memory>
#include <mutex>
#include <vector>

#include "cl/binary_files.h"
#include "cl/handle.h"

namespace pel::cl {

// Compile-time choices of a program, NAME=VALUE. Only for structure: values of a scene are kernel arguments.
struct DefineValue : std::string {
    using std::string::string;
    DefineValue(std::string text) : std::string(std::move(text)) {}
    template <class Number>
    requires std::is_integral_v<Number> || std::is_enum_v<Number> DefineValue(Number number)
        : std::string(std::to_string(static_cast<long long>(number))) {}
};
using Defines = std::map<std::string, DefineValue>;

// The sources of a program: kernel files in order, each included file once; and the choices.
struct ProgramKey {
    std::vector<std::string> files;
    Defines defines;
    bool operator==(const ProgramKey&) const = default;
};

// Programs from binaries that earlier processes left on disk.
class BinaryCache {
  public:
    // If the driver keeps programs itself: loads only PoCL's, stores only if PELLUCID_CACHE is "on".
    BinaryCache(cl_context context, cl_device_id device);

    // Empty when there is none, or the driver refuses it.
    Program load(const std::string& source, const std::string& options) const;
    // False if it could not be stored.
    bool store(const Program& program, const std::string& source, const std::string& options) const;

    // The program of another process's binary, which is stored, too. Empty if the driver refuses it.
    Program take(const std::string& binary, const std::string& source, const std::string& options,
                 uint32_t& stored) const;

  private:
    Program programOf(const std::string& binary, const std::string& options) const;
    Digest name(const std::string& source, const std::string& options) const {
        return Digest().addPart(builtBy_).addPart(options).addPart(source);
    }

    cl_context context_;
    cl_device_id device_;
    std::string builtBy_;  // everything else that affects the driver's output
    std::optional<BinaryFiles> files_;
    bool stores_ = false;
};

class ProgramCache {
  public:
    // `defines`: of all programs, unless a key has its own.
    ProgramCache(Context context, cl_device_id device, Defines defines);

    // Thread-safe. Different programs are built at the same time by the threads that ask for them, if the
    // driver can do that. PEL_WIDTH and PEL_GROUP are the device's unless `defines` has them.
    Program get(const ProgramKey& key);
    Program get(const std::string& file, const Defines& defines) { return get(ProgramKey{{file}, defines}); }

    // The files and options of a program.
    std::string name(const ProgramKey& key) const;

    struct Counts {
        uint32_t built = 0;   // includes loaded ones
        uint32_t loaded = 0;  // from binaries on disk
        uint32_t stored = 0;  // there
        double milliseconds = 0;
    };
    Counts counts() const;

  private:
    struct Entry {
        std::mutex building;
        Program program;
    };
    std::string optionsOf(const ProgramKey& key) const;
    Program build(const std::vector<std::string>& files, const std::string& options, Counts& counts) const;
    Program compile(const std::string& source, const std::vector<std::string>& files,
                    const std::string& options) const;

    Context context_;
    cl_device_id device_;
    Defines defines_;
    BinaryCache binaries_;
    mutable std::mutex mutex_;  // of the rest
    std::map<std::string, std::shared_ptr<Entry>> programs_;
    Counts counts_;
};

}  // namespace pel::cl
