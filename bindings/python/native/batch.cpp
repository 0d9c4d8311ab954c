// Manifests and the files of batches, by the same code as the command's.
#include "progress.h"

#ifdef PELLUCID_BATCH
#include "batch/batch_entry.h"
#include "batch/batch_index.h"
#include "io/atomic_file.h"
#include "io/file_error.h"
#include "io/lut/lut_exr.h"

namespace pel::python {

namespace {
using pellucid::io::BatchManifest;

BatchManifest read(const std::string& path) {
    try {
        return pellucid::io::readManifest(path);
    } catch (const std::exception& e) {
        throw py::value_error(e.what());
    }
}

BatchManifest parsed(const std::string& path, const std::string& text,
                     const std::map<std::string, std::string>& profiles) {
    try {
        return pellucid::io::parseManifest(path, text, profiles);
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
    call([&] {
        try {
            bytes = pellucid::io::makeEntryFile(device.handle, entry);
            return PEL_SUCCESS;
        } catch (const pellucid::Error& e) {
            return e.code();
        }
    });
    return py::bytes(bytes);
}
}  // namespace

void bindBatch(py::module_& module) {
    py::class_<BatchManifest>(module, "Manifest")
        .def_static("read", &read)
        .def_static("parse", &parsed)
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
}

}  // namespace pel::python

#else  // built without toml++: no manifests

namespace pel::python {
void bindBatch(py::module_&) {}
}  // namespace pel::python

#endif
