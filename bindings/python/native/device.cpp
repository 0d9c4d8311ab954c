// Devices and events.
#include "progress.h"

#include <memory>

namespace pel::python {

namespace {
py::object errorCallback = py::none();

void onError(void*, PelError code, const char* message) {
    WithGil gil;
    try {
        errorCallback(int(code), message);
    } catch (py::error_already_set& error) {
        error.discard_as_unraisable("pellucid error callback");
    }
}

// `create()` makes a pellucid::Device.
template <class Create>
std::unique_ptr<Device> created(Create create) {
    opensDevices();
    pellucid::Device device(nullptr);
    call([&] {
        try {
            device = create();
            return PEL_SUCCESS;
        } catch (const pellucid::Error& e) {
            return e.code();
        }
    });
    return std::make_unique<Device>(std::move(device));
}
}  // namespace

void bindDevice(py::module_& module) {
    module.def("set_error_callback", [](const py::object& callback) {
        errorCallback = callback;
        pelSetErrorCallback(callback.is_none() ? nullptr : onError, nullptr);
    });
    // The interpreter's end must find no Python object in static storage.
    py::module_::import("atexit").attr("register")(py::cpp_function([] {
        pelSetErrorCallback(nullptr, nullptr);
        errorCallback = py::none();
        interpreterEnds();
    }));
    module.def("devices", [] {
        opensDevices();
        uint32_t count = 0;
        call([&] { return pelDeviceCount(&count); });
        py::list infos;
        for (uint32_t i = 0; i < count; ++i) {
            PelDeviceInfo info = pelDeviceInfoDefaults();
            call([&] { return pelDeviceEnumerate(i, &info); });
            infos.append(bytesOf(info));
        }
        return infos;
    });
    py::class_<Cancel, std::shared_ptr<Cancel>>(module, "Cancel")
        .def(py::init<>())
        .def("watch", &Cancel::watch)
        .def("ask", &Cancel::ask);
    py::class_<Device>(module, "Device")
        .def_static(
            "create",
            [](const std::string& selector) { return created([&] { return pellucid::Device(selector); }); })
        .def_static("from_cl",
                    [](uintptr_t context, uintptr_t device, uintptr_t queue) {
                        return created([&] {
                            return pellucid::Device::fromCl(pointer(context), pointer(device),
                                                            pointer(queue));
                        });
                    })
        .def("address", [](const Device& d) { return reinterpret_cast<uintptr_t>(d.handle.get()); })
        .def("info",
             [](const Device& d) {
                 PelDeviceInfo info = pelDeviceInfoDefaults();
                 call([&] { return pelDeviceGetInfo(d.handle.get(), &info); });
                 return bytesOf(info);
             })
        .def("stats",
             [](const Device& d) {
                 PelDeviceStats stats = pelDeviceStatsDefaults();
                 call([&] { return pelDeviceGetStats(d.handle.get(), &stats); });
                 return bytesOf(stats);
             })
        .def("cl",
             [](const Device& d) {
                 void *context = nullptr, *device = nullptr, *queue = nullptr;
                 call([&] { return pelDeviceGetCl(d.handle.get(), &context, &device, &queue); });
                 return py::make_tuple(address(context), address(device), address(queue));
             })
        .def("marker", [](const Device& d) { return markerOf(d.handle); })
        .def_readwrite("progress", &Device::progress);

    py::class_<pellucid::Event, Owner<pellucid::Event>>(module, "Event")
        .def_static("from_cl",
                    [](const Device& d, uintptr_t event) {
                        PelEvent handle = nullptr;
                        call([&] { return pelEventCreateFromCl(d.handle.get(), pointer(event), &handle); });
                        return pellucid::Event(handle);
                    })
        .def("wait", &waitInterruptibly)
        .def("is_done",
             [](const pellucid::Event& e) {
                 int done = 0;
                 call([&] { return pelEventIsDone(e.get(), &done); });
                 return done != 0;
             })
        .def("cl", [](const pellucid::Event& e) {
            void* event = nullptr;
            call([&] { return pelEventGetCl(e.get(), &event); });
            return address(event);
        });
}

}  // namespace pel::python
