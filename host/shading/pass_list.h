// The passes of a shader, and the memory that they share.
#pragma once
#include <span>

#include "shading/pass.h"

namespace pel {

class PassList {
  public:
    PassList() = default;
    explicit PassList(std::span<const PassKind> kinds) : kinds_(kinds), passes_(kinds.size()) {}

    // Makes the needed passes and drops the others. Their images hold as many rows of tiles as
    // PelShaderOptions.scratchBudget, memory and `mostRows` allow.
    void allocate(const Ref<Device>& device, ShaderPlan& plan, uint32_t mostRows);
    size_t bytes() const;
    // That the passes of a plan will take, if one of them works on the whole frame at a time; else 0.
    uint64_t bytesOfWholeFrame(const ShaderPlan& plan);
    bool empty() const { return kinds_.empty(); }

    template <class Call>
    void each(Call&& call) const {
        for (const auto& pass : passes_)
            if (pass) call(*pass);
    }

  private:
    PassScratch choose(const ShaderPlan& plan);

    std::span<const PassKind> kinds_;
    std::vector<std::unique_ptr<Pass>> passes_;  // one for each kind; empty: not needed
};

}  // namespace pel
