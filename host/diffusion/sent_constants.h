// A structure on the device that kernels read, sent only when it has changed.
#pragma once
#include <algorithm>

#include "shading/scratch_image.h"
#include "shared/diffusion.h"

namespace pel {

template <class T>
class SentConstants {
  public:
    void send(Device& device, const T& value) {
        upload_.update(device, &value, sizeof value);
        sent_ = value;
    }
    const cl::Memory& memory() const { return upload_.memory(); }
    const T& sent() const { return sent_; }

  private:
    CachedUpload upload_;
    T sent_{};
};

// The distinct materials of all ids. `numberOf`: number of each id's material, from 1 on; 0: none.
template <class Material>
std::vector<Material> distinctOf(const std::map<uint32_t, Material>& materials,
                                 uint32_t (&numberOf)[PEL_DIFFUSION_IDS]) {
    std::vector<Material> distinct;
    std::fill_n(numberOf, PEL_DIFFUSION_IDS, 0);
    for (const auto& [id, material] : materials) {
        auto found = std::find(distinct.begin(), distinct.end(), material);
        if (found == distinct.end()) found = distinct.insert(found, material);
        numberOf[id] = uint32_t(found - distinct.begin()) + 1;
    }
    return distinct;
}

}  // namespace pel
