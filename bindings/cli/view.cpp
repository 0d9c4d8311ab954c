// pellucid view and pellucid gallery: run the Python package with all arguments.

#include "command.h"
#include "system/process.h"

namespace pellucid::cli {
namespace {

// Reports missing Python packages in the terms of this command, then starts the module.
constexpr const char* starter = R"(
import importlib.util, runpy, sys
if importlib.util.find_spec("pellucid") is None:
    print("pellucid: view and gallery need the Python package, which this python3 does not have: "
          "pip install 'pellucid[view]', or ./run view in a checkout", file=sys.stderr)
    sys.exit(2)
runpy.run_module(sys.argv.pop(1), run_name="__main__", alter_sys=True)
)";

void start(const char* module, const std::vector<std::string>& arguments) {
    const char* named = std::getenv("PELLUCID_PYTHON");
    const std::string python = named && *named ? named : "python3";
    std::vector<std::string> words{python, "-c", starter, module};
    words.insert(words.end(), arguments.begin(), arguments.end());
    const std::string why = pel::system::becomeProgram(words);
    throw UsageError(python + " cannot be started: " + why +
                     "; PELLUCID_PYTHON names the Python that has the package");
}

void add(CLI::App& app, const char* name, const char* module, const char* what) {
    CLI::App* command = app.add_subcommand(name, what);
    command->prefix_command();  // all arguments are those of the module
    command->set_help_flag();
    command->callback([=] { start(module, command->remaining()); });
}

}  // namespace

void addView(CLI::App& app) {
    add(app, "view", "pellucid.view", "A look-dev viewer in the browser (needs the Python package)");
    add(app, "gallery", "pellucid.view.gallery",
        "Pictures of materials, methods, lights and mistakes (needs the Python package)");
}

}  // namespace pellucid::cli
