// The `pellucid` command. Exit codes: 0 done, 2 wrong use, 3 bad input file, 4 no device or device failure.
#include <cstdio>

#include "command.h"
#include "io/file_error.h"

using namespace pellucid;
using namespace pellucid::cli;

namespace {

int fail(ExitCode code, const char* message) {
    std::fprintf(stderr, "pellucid: %s\n", message);
    return code;
}

// CLI11 would only say that a subcommand is required. Also of those that have some and need one, such as `lut`.
void checkSubcommand(const CLI::App& app, int argc, char** argv, const std::string& path = "") {
    if (argc < 2 || argv[1][0] == '-' || app.get_require_subcommand_min() == 0) return;
    std::string names;
    for (const CLI::App* known : app.get_subcommands({})) {
        if (known->get_name() == argv[1]) return checkSubcommand(*known, argc - 1, argv + 1, path + argv[1] + " ");
        names += (names.empty() ? "" : ", ") + known->get_name();
    }
    throw UsageError("there is no subcommand '" + path + argv[1] + "'; there are " + names);
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Subsurface scattering for deferred renderers on OpenCL", "pellucid");
    app.require_subcommand(1);
    app.set_version_flag("--version", std::to_string(PEL_VERSION_MAJOR) + "." +
                                          std::to_string(PEL_VERSION_MINOR) + "." +
                                          std::to_string(PEL_VERSION_PATCH));
    addDevices(app);
    addCurvature(app);
    addLut(app);
    addProfile(app);
    addBatch(app);
    addShade(app);
    addPrefill(app);
    addDemo(app);
    addBench(app);
    try {
        checkSubcommand(app, argc, argv);
        app.parse(argc, argv);
        return exitDone;
    } catch (const CLI::Success& e) {
        return app.exit(e);  // --help and --version
    } catch (const CLI::RuntimeError& e) {
        return e.get_exit_code();  // a subcommand's own
    } catch (const CLI::ParseError& e) {
        app.exit(e);
        return exitWrongUse;
    } catch (const UsageError& e) {
        return fail(exitWrongUse, e.what());
    } catch (const InputError& e) {
        return fail(exitBadInput, e.what());
    } catch (const io::FileError& e) {
        return fail(exitBadInput, e.what());
    } catch (const Error& e) {
        // The library's own complaints about arguments are wrong use; all others are the device's.
        const bool use = e.code() == PEL_ERROR_INVALID_ARGUMENT || e.code() == PEL_ERROR_INVALID_STATE;
        return fail(use ? exitWrongUse : exitNoDevice, e.what());
    } catch (const std::exception& e) {
        return fail(exitNoDevice, e.what());
    }
}
