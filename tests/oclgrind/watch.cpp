// A plugin of Oclgrind (oclgrind --plugins) that writes down which kernels ran, and every report, so that
// processes started by a test count as well.
//
// PELLUCID_OCLGRIND_DIR: the folder for the files reports, kernels.
#include <fcntl.h>
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <string>

#include "Context.h"
#include "Kernel.h"
#include "KernelInvocation.h"
#include "Plugin.h"

using namespace oclgrind;

namespace {

// By one call each, which no other process cuts in two.
void append(const char* file, const std::string& text) {
    const char* folder = getenv("PELLUCID_OCLGRIND_DIR");
    if (!folder) return;
    const int to = open((std::string(folder) + "/" + file).c_str(), O_WRONLY | O_CREAT | O_APPEND, 0644);
    if (to < 0 || write(to, text.data(), text.size()) != ssize_t(text.size())) abort();
    close(to);
}

// What is released after main crashes in Oclgrind, whose thread-local stack of calls is gone by then.
// Handlers run in the reverse order of their registration: the last of these, which comes after all that
// the test has made so far, before any release.
void endWithoutReleasing() {
    on_exit(
        +[](int status, void*) { fflush(nullptr), _exit(status); }, nullptr);
}

class Watch : public Plugin {
  public:
    using Plugin::Plugin;
    void memoryAllocated(const Memory* memory, size_t, size_t, cl_mem_flags, const uint8_t*) override {
        if (memory == (const Memory*)m_context->getGlobalMemory()) endWithoutReleasing();
    }
    void kernelBegin(const KernelInvocation* invocation) override {
        endWithoutReleasing();
        append("kernels", invocation->getKernel()->getName() + "\n");
    }
    void log(MessageType type, const char* message) override {
        if (type == WARNING || type == ERROR) append("reports", std::string("\n") + message + "\n");
    }
};

}  // namespace

extern "C" void initializePlugins(Context* context) {
    context->registerPlugin(new Watch(context));
}
extern "C" void releasePlugins(Context*) {}
