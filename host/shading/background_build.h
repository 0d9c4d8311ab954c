// Programs of a shader that are built while the caller goes on (PelShaderOptions.buildInBackground).
#pragma once
#include <exception>
#include <thread>

#include "shading/shader.h"

namespace pel {

class BackgroundBuild {
  public:
    // Begins. `shader`: nobody else uses it until the end; its images may go meanwhile. `autoPixels`: as a
    // commit counted them.
    BackgroundBuild(Ref<Shader> shader, uint64_t autoPixels, std::shared_ptr<cl::BuildHelpers> helpers,
                    unsigned threads);
    // Stops what has not been built by then.
    ~BackgroundBuild();

    bool done() const { return done_; }
    // With the tables that were made, once it is done. Throws what stopped it.
    const Shader& built() const;

  private:
    void run();

    Ref<Shader> shader_;
    uint64_t autoPixels_;
    std::shared_ptr<cl::BuildHelpers> helpers_;
    unsigned threads_;
    std::exception_ptr failure_;
    std::atomic<bool> done_ = false;
    std::jthread thread_;
};

}  // namespace pel
