#include "native.h"

#ifdef PELLUCID_BATCH
#include "io/image/image_compare.h"
#endif

namespace pel::python {

void bindCompare(py::module_& module) {
#ifdef PELLUCID_BATCH
    module.def("compare_images", [](uintptr_t a, uintptr_t b, size_t pixels, uintptr_t mask) {
        const auto values = [&](uintptr_t p) {
            return std::span(static_cast<const float*>(pointer(p)), 3 * pixels);
        };
        size_t invalid = 0;
        pellucid::io::ImageDifference d;
        {
            const WithoutGil free;
            d = pellucid::io::compareImages(
                values(a), values(b),
                mask ? std::span(static_cast<const uint8_t*>(pointer(mask)), pixels)
                     : std::span<const uint8_t>(),
                &invalid);
        }
        py::dict result;
        result["pixels"] = d.pixels;
        result["invalid_pixels"] = invalid;
        result["rmse"] = d.rmse;
        result["rmse_all"] = d.rmseAll;
        result["psnr"] = d.psnr;
        result["mean"] = d.mean;
        result["p99"] = d.p99;
        result["max"] = d.max;
        result["delta_e_mean"] = d.deltaEMean;
        result["delta_e_p99"] = d.deltaE99;
        result["delta_e_max"] = d.deltaEMax;
        return result;
    });
#else
    (void)module;
#endif
}

}  // namespace pel::python
