#include "shading/background_build.h"

#include <set>

#include "cl/machine.h"

namespace pel {
namespace {

// The running builds. A process that exits stops them first, because drivers shut down with it.
struct Running {
    std::mutex mutex;
    std::set<std::jthread*> threads;
    std::set<cl::BuildHelpers*> helpers;
};

Running& running() {
    static Running& all = *new Running;
    static const int registered = std::atexit([] {
        if (cl::isFork()) return;
        std::set<std::jthread*> threads;
        {
            const std::lock_guard lock(all.mutex);
            threads.swap(all.threads);
            for (cl::BuildHelpers* helpers : all.helpers) helpers->cancel();
        }
        for (std::jthread* thread : threads) thread->join();
    });
    (void)registered;
    return all;
}

}  // namespace

BackgroundBuild::BackgroundBuild(Ref<Shader> shader, uint64_t autoPixels,
                                 std::shared_ptr<cl::BuildHelpers> helpers, unsigned threads)
    : shader_(std::move(shader)), autoPixels_(autoPixels), helpers_(std::move(helpers)), threads_(threads) {
    const std::lock_guard lock(running().mutex);
    thread_ = std::jthread([this] { run(); });
    running().threads.insert(&thread_);
    running().helpers.insert(helpers_.get());
}

BackgroundBuild::~BackgroundBuild() {
    helpers_->cancel();
    const std::lock_guard lock(running().mutex);
    running().threads.erase(&thread_);
    running().helpers.erase(helpers_.get());
}

const Shader& BackgroundBuild::built() const {
    if (failure_) std::rethrow_exception(failure_);
    return *shader_;
}

void BackgroundBuild::run() {
    try {
        BuildJobs jobs;
        {
            const cl::HelpScope scope(*helpers_);
            shader_->addBuildJobs(jobs, autoPixels_);
        }
        runJobs(shader_->device(), jobs, threads_, *helpers_, [&](size_t) { helpers_->checkCancelled(); });
    } catch (...) {
        failure_ = std::current_exception();
    }
    done_ = true;
}

}  // namespace pel
