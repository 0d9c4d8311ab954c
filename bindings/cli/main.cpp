// The `pellucid` command. Exit codes: 0 done, 2 wrong use, 3 bad input file, 4 no device or device failure.

#include "command.h"
#include "io/input_file.h"
#include "system/process.h"

using namespace pellucid;
using namespace pellucid::cli;

static int fail(ExitCode code, const char* message) {
    pel::system::restoreErrors();
    std::fprintf(stderr, "pellucid: %s\n", io::printable(message, true).c_str());
    return code;
}

// Also checks subcommands that need one themselves, such as `lut`. CLI11 would not list the choices.
static void checkSubcommand(const CLI::App& app, int argc, char** argv, const std::string& path = "") {
    if (argc < 2 || argv[1][0] == '-' || app.get_require_subcommand_min() == 0) return;
    std::vector<std::string> names;
    for (const CLI::App* known : app.get_subcommands({})) {
        if (known->check_name(argv[1]))
            return checkSubcommand(*known, argc - 1, argv + 1, path + argv[1] + " ");
        names.push_back(known->get_name());
    }
    throw UsageError(thereIsNo("subcommand '" + path + argv[1] + "'", argv[1], names));
}

// Closes standard output: if the report cannot be written, the command has failed.
static int finish(int code) {
    const bool written = std::cout.flush() && std::fflush(stdout) == 0 && !std::ferror(stdout);
    return written ? code
                   : fail(exitBadInput, "standard output cannot be written: the report is not complete");
}

int main(int argc, char** argv) {
    if (!pel::system::prepareStreams()) return exitWrongUse;
    CLI::App app("Subsurface scattering for deferred renderers on OpenCL", "pellucid");
    app.formatter(helpFormatter());  // before the subcommands, which inherit it
    app.require_subcommand(1);
    app.set_version_flag("--version",
                         io::concat(PEL_VERSION_MAJOR, ".", PEL_VERSION_MINOR, ".", PEL_VERSION_PATCH));
    for (const auto add :
         {addDevices, addCurvature, addLut, addProfile, addBatch, addShade, addReference, addImport,
          addCompare, addWarmUp, addDemo, addBench, addTune, addView, addDescribe})
        add(app);
    try {
        checkSubcommand(app, argc, argv);
        app.parse(argc, argv);
        return finish(exitDone);
    } catch (const CLI::Success& e) {
        return finish(app.exit(e));  // --help and --version
    } catch (const ExitWith& e) {
        return finish(e.code);
    } catch (const CLI::ExtrasError&) {
        return fail(exitWrongUse, unknownOptions(app).c_str());
    } catch (const CLI::ParseError& e) {
        // A mistyped option may be why a required one is missing.
        for (const std::string& word : app.remaining(true))
            if (word.starts_with("-")) return fail(exitWrongUse, unknownOptions(app).c_str());
        return fail(exitWrongUse,
                    (e.what() + std::string("\nRun with --help for more information.")).c_str());
    } catch (const UsageError& e) {
        return fail(exitWrongUse, e.what());
    } catch (const InputError& e) {
        return fail(exitBadInput, e.what());
    } catch (const io::ExtensionError& e) {
        // A name in a scene file or manifest is bad input.
        const bool isArgument = std::any_of(argv + 1, argv + argc, [&](const std::string& argument) {
            return argument == e.file() || argument.ends_with("=" + e.file());
        });
        return fail(isArgument ? exitWrongUse : exitBadInput, e.what());
    } catch (const io::FileError& e) {
        return fail(exitBadInput, e.what());
    } catch (const Error& e) {
        // Compilers inside a driver notice Ctrl-C too, and fail.
        if (wasInterrupted()) return fail(exitNoDevice, "interrupted");
        // Arguments that the library refuses are wrong use. All its other errors come from the device.
        const bool use = e.code() == PEL_ERROR_INVALID_ARGUMENT || e.code() == PEL_ERROR_INVALID_STATE;
        return fail(use ? exitWrongUse : exitNoDevice, e.what());
    } catch (const std::exception& e) {
        return fail(exitNoDevice, e.what());
    }
}
