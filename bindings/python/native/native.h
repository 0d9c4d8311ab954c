// What the files of the native module share: errors as Python exceptions, the GIL let go during calls,
// waiting that Ctrl-C can end, and structures passed as their bytes. Arguments are Python's: whoever calls
// keeps them alive. Everything a user sees is in the Python files beside this.
#pragma once
#include <pellucid/pellucid.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <array>
#include <cstddef>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <pellucid/pellucid.hpp>
#include <span>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace pel::python {

namespace py = pybind11;

// A failed call on its way to becoming pellucid.PellucidError.
struct CallError {
    PelError code;
    std::string message;
};

// Lets go of the GIL, and takes it again at the end.
class WithoutGil {
  public:
    WithoutGil() : state_(PyEval_SaveThread()) {}
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

  private:
    PyThreadState* state_;
};

// Holds the GIL, on a thread that Python may not know, as in callbacks.
class WithGil {
  public:
    WithGil();
    ~WithGil() { PyGILState_Release(state_); }
    WithGil(const WithGil&) = delete;
    WithGil& operator=(const WithGil&) = delete;

  private:
    PyGILState_STATE state_;
};

// To be called before OpenCL is first used: its threads do not come along into a process that is forked
// later, so that calls there would wait for ever; they throw instead.
void opensDevices();
void refuseForked();

// Runs `body` without the GIL and throws its error. An exception that a progress callback raised comes
// first, KeyboardInterrupt among them: the library tells its progress where work is long.
void call(const std::function<PelError()>& body);

// Waits without the GIL, looking for Ctrl-C meanwhile; the work itself goes on when that comes.
void waitInterruptibly(const pellucid::Event& event);

// Whether a signal handler raised something, such as KeyboardInterrupt: the body of a `call` that takes long
// asks, ends early, and py::error_already_set is thrown after it.
bool signalled();

// Done when everything is that was given to the device before.
pellucid::Event markerOf(const pellucid::Device& device);

// On the thread that ends the process: others that ask for the GIL from here on wait for ever.
void interpreterEnds();

// The bytes of a C structure that a Python object holds; throws unless they are one T.
template <class T>
T* structOf(const py::object& object) {
    const py::buffer_info info = py::reinterpret_borrow<py::buffer>(object).request(true);
    if (size_t(info.size * info.itemsize) != sizeof(T))
        throw CallError{PEL_ERROR_UNKNOWN, "a structure of " + std::to_string(info.size * info.itemsize) +
                                               " bytes where one of " + std::to_string(sizeof(T)) +
                                               " belongs"};
    return static_cast<T*>(info.ptr);
}

template <class T>
py::bytes bytesOf(const T& value) {
    return py::bytes(reinterpret_cast<const char*>(&value), sizeof value);
}

inline void* pointer(uintptr_t address) {
    return reinterpret_cast<void*>(address);
}
inline uintptr_t address(void* p) {
    return reinterpret_cast<uintptr_t>(p);
}

// Owner of what a Python object holds of the library. The last reference to a device waits for its queue,
// where a host's own callbacks and events may need the GIL to get on; so nothing of the library is let go
// with the GIL held.
template <class T>
struct DeletedWithoutGil {
    void operator()(T* object) const {
        WithoutGil free;
        delete object;
    }
};
template <class T>
using Owner = std::unique_ptr<T, DeletedWithoutGil<T>>;

using Waits = std::vector<pellucid::Event>;

// Calls `body` with a PelSubmit after `waits`; returns the event.
template <class Body>
pellucid::Event submitted(const Waits& waits, Body&& body) {
    std::vector<PelEvent> handles;
    for (const pellucid::Event& e : waits) handles.push_back(e.get());
    PelEvent done = nullptr;
    const PelSubmit submit{handles.data(), uint32_t(handles.size()), &done};
    call([&] { return body(&submit); });
    return pellucid::Event(done);
}

// Vertex data as Python passes it: buffer, byte offset, byte stride, count.
using VertexView = std::tuple<pellucid::Buffer, uint64_t, uint32_t, uint32_t>;
inline PelVertexView vertexView(const VertexView& v) {
    return pellucid::vertexView(std::get<0>(v), std::get<3>(v), std::get<1>(v), std::get<2>(v));
}

// An image as Python passes it: buffer, format, width, height, byte offset, pixel, row and plane stride.
using ImageView =
    std::tuple<pellucid::Buffer, uint32_t, uint32_t, uint32_t, uint64_t, uint64_t, uint64_t, uint64_t>;
PelImageDesc imageDesc(const ImageView& v);

void bindStructs(py::module_& module);
void bindDevice(py::module_& module);
void bindBuffer(py::module_& module);
void bindMesh(py::module_& module);
void bindProfile(py::module_& module);
void bindScatter(py::module_& module);
void bindTextureScatter(py::module_& module);
void bindLut(py::module_& module);
void bindShader(py::module_& module);
void bindBatch(py::module_& module);
void bindCompare(py::module_& module);

}  // namespace pel::python
