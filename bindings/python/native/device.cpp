// Devices, events and buffers.
#include "native.h"

namespace pel::python {
namespace {
py::object errorCallback = py::none(), logCallback = py::none();

template <class... Arguments>
void tell(const py::object& callback, const char* what, Arguments... arguments) {
    WithGil gil;
    const py::object now = callback;  // which may replace itself, or has just been removed
    if (now.is_none()) return;
    try {
        now(arguments...);
    } catch (py::error_already_set& error) {
        error.discard_as_unraisable(what);
    }
}
void onError(void*, PelError code, const char* message) {
    tell(errorCallback, "pellucid error callback", int(code), message);
}
void onLog(void*, PelLogLevel level, const char* object, const char* text) {
    tell(logCallback, "pellucid log callback", int(level), object, text);
}

// `create()` makes a pellucid::Device.
template <class Create>
std::unique_ptr<Device> created(Create create) {
    opensDevices();
    pellucid::Device device(nullptr);
    callThrowing([&] { device = create(); });
    return std::make_unique<Device>(std::move(device));
}
}  // namespace

void bindDevice(py::module_& module) {
    module.def("set_error_callback", [](const py::object& callback) {
        errorCallback = callback;
        pelSetErrorCallback(callback.is_none() ? nullptr : onError, nullptr);
    });
    module.def("set_log_callback", [](const py::object& callback) {
        logCallback = callback;
        pelSetLogCallback(callback.is_none() ? nullptr : onLog, nullptr);
    });
    // No Python object may be left in static storage when the interpreter ends.
    py::module_::import("atexit").attr("register")(py::cpp_function([] {
        pelSetErrorCallback(nullptr, nullptr);
        pelSetLogCallback(nullptr, nullptr);
        errorCallback = logCallback = py::none();
        interpreterEnds();
    }));
    module.def("devices", [] {
        opensDevices();
        uint32_t count = 0;
        call([&] { return pelDeviceCount(&count); });
        const auto describe = structure<pelDeviceInfoDefaults>(pelDeviceEnumerate);
        py::list infos;
        for (uint32_t i = 0; i < count; ++i) infos.append(describe(i));
        return infos;
    });
    py::class_<Cancel, std::shared_ptr<Cancel>>(module, "Cancel")
        .def(py::init<>())
        .def("watch", &Cancel::watch)
        .def("ask", &Cancel::ask);
    py::class_<Device>(module, "Device")
        .def_static("create",
                    [](const std::string& selector, uint32_t profiling) {
                        PelDeviceDesc desc = pelDeviceDescDefaults();
                        desc.selector = selector.c_str();
                        desc.profiling = profiling;
                        return created([&] { return pellucid::Device(desc); });
                    })
        .def_static("from_cl",
                    [](uintptr_t context, uintptr_t device, uintptr_t queue) {
                        return created([&] {
                            return pellucid::Device::fromCl(pointer(context), pointer(device),
                                                            pointer(queue));
                        });
                    })
        .def("set_name", named<Device>())
        .def("address", [](const Device& d) { return reinterpret_cast<uintptr_t>(d.get()); })
        .def("info", structure<pelDeviceInfoDefaults>(pelDeviceGetInfo))
        .def("stats", structure<pelDeviceStatsDefaults>(pelDeviceGetStats))
        .def("cl",
             [](const Device& d) {
                 void *context = nullptr, *device = nullptr, *queue = nullptr;
                 call([&] { return pelDeviceGetCl(d.get(), &context, &device, &queue); });
                 return py::make_tuple(address(context), address(device), address(queue));
             })
        .def("marker", [](const Device& d) { return markerOf(d.handle); })
        .def_readwrite("progress", &Device::progress);

    using pellucid::Buffer, pellucid::Event;
    py::class_<Event, Owner<Event>>(module, "Event")
        .def_static("from_cl", maker<Event>(pelEventCreateFromCl))
        .def("wait", &waitInterruptibly)
        .def("is_done", value<int>(pelEventIsDone))
        .def("cl", value<void*>(pelEventGetCl));

    py::class_<Buffer, Owner<Buffer>>(module, "Buffer")
        .def_static("create", maker<Buffer>(pelBufferCreate))
        .def_static("from_host", maker<Buffer>(pelBufferCreateFromHost))
        .def_static("from_cl", maker<Buffer>(pelBufferCreateFromCl))
        .def("set_name", named<Buffer>())
        .def("size", value<size_t>(pelBufferGetSize))
        .def("cl", value<void*>(pelBufferGetCl))
        .def("read", function(pelBufferRead))
        .def("write", function(pelBufferWrite))
        .def("map", value<void*>(pelBufferMap))
        .def("unmap", function(pelBufferUnmap));
}

}  // namespace pel::python
