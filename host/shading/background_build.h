// Builds the programs of a shader in the background (PelShaderOptions.buildInBackground).
#pragma once
#include <exception>
#include <thread>

#include "shading/shader.h"

namespace pel {

class BackgroundBuild {
  public:
    // Starts the build. `shader`: used by nothing else until the end; its images may be released meanwhile.
    // `autoPixels`: as a commit counted them.
    BackgroundBuild(Ref<Shader> shader, uint64_t autoPixels, std::shared_ptr<cl::BuildHelpers> helpers,
                    unsigned threads);
    // Stops the builds that have not finished.
    ~BackgroundBuild();

    bool done() const { return done_; }
    // The shader with its tables, once the build is done. Throws the error that stopped it.
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
