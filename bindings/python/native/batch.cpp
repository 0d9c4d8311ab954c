// Manifests and files of batches, and differences of images, by the same code as the command's.
#include "native.h"

#ifdef PELLUCID_BATCH
#include "batch/batch_manifest.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/image/flip.h"
#include "io/image/image_compare.h"
#include "io/lut/lut_exr.h"

namespace pel::python {
namespace {
using pellucid::io::BatchManifest;

// Made by `make()`; its errors become ValueError.
template <class Make>
BatchManifest manifest(Make&& make) {
    try {
        return make();
    } catch (const std::exception& e) {
        throw py::value_error(e.what());
    }
}

const pellucid::io::BatchEntry& entryOf(const BatchManifest& m, size_t index) {
    if (index >= m.entries.size())
        throw py::index_error("entry " + std::to_string(index) + " of " + std::to_string(m.entries.size()));
    return m.entries[index];
}

py::bytes made(const BatchManifest& m, const Device& device, size_t index) {
    const pellucid::io::BatchEntry& entry = entryOf(m, index);
    std::string bytes;
    callThrowing([&] { bytes = pellucid::io::makeEntryFile(device.handle, entry); });
    return py::bytes(bytes);
}
}  // namespace

void bindBatch(py::module_& module) {
    py::class_<BatchManifest>(module, "Manifest")
        .def_static("read",
                    [](const std::string& path) {
                        return manifest([&] { return pellucid::io::readManifest(path); });
                    })
        .def_static("parse",
                    [](const std::string& path, const std::string& text,
                       const std::map<std::string, std::string>& profiles) {
                        return manifest([&] { return pellucid::io::parseManifest(path, text, profiles); });
                    })
        .def("__len__", [](const BatchManifest& m) { return m.entries.size(); })
        .def("entry",
             [](const BatchManifest& m, size_t index) {
                 const auto& e = entryOf(m, index);
                 return std::make_tuple(e.file, e.key, e.line);
             })
        .def("errors",
             [](const BatchManifest& m) {
                 std::vector<std::pair<int, std::string>> errors;
                 for (const auto& e : m.errors) errors.emplace_back(e.line, e.message);
                 return errors;
             })
        .def("duplicates", [](const BatchManifest& m) { return m.duplicates; })
        .def("text", [](const BatchManifest& m) { return m.text; })
        .def("profiles", [](const BatchManifest& m) { return m.profiles; })
        .def("make", &made)
        .def("index_name",
             [](const BatchManifest&, const std::string& path) { return pellucid::io::batchIndexName(path); })
        .def("index", [](const BatchManifest& m, const std::string& path, const std::vector<bool>& there) {
            WithoutGil free;
            return pellucid::io::batchIndex(m, path, there);
        });
    // Complete or not at all, as the command writes its files.
    module.def("write_file", [](const std::string& path, const py::bytes& file) {
        const std::string_view bytes = file;
        try {
            WithoutGil free;
            pellucid::io::writeWholeFile(path, bytes);
        } catch (const pellucid::io::FileError& e) {
            PyErr_SetString(PyExc_OSError, e.what());
            throw py::error_already_set();
        }
    });
    module.def("verify_file", [](const py::bytes& file, const std::string& key) {
        const std::string_view bytes = file;
        WithoutGil free;
        return pellucid::io::verifyLutExr(bytes, key);
    });
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
        using namespace py::literals;
        return py::dict("pixels"_a = d.pixels, "invalid_pixels"_a = invalid, "rmse"_a = d.rmse,
                        "rmse_all"_a = d.rmseAll, "psnr"_a = d.psnr, "mean"_a = d.mean, "p99"_a = d.p99,
                        "max"_a = d.max, "delta_e_mean"_a = d.deltaEMean, "delta_e_p99"_a = d.deltaE99,
                        "delta_e_max"_a = d.deltaEMax);
    });
    module.def("flip", [](uintptr_t a, uintptr_t b, size_t values, int width) {
        const WithoutGil free;
        return pellucid::io::flip({static_cast<const float*>(pointer(a)), values},
                                  {static_cast<const float*>(pointer(b)), values}, width);
    });
}

}  // namespace pel::python

#else  // built without toml++: no manifests

namespace pel::python {
void bindBatch(py::module_&) {}
}  // namespace pel::python

#endif
