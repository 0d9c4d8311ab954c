// Shared by the files of the native module: errors as Python exceptions, release of the GIL during calls,
// waits that Ctrl-C can end, and structures passed as their bytes. The caller keeps the Python arguments
// alive. The public interface is in the Python files next to this folder.
#pragma once
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <atomic>
#include <functional>
#include <memory>
#include <optional>
#include <pellucid/pellucid.hpp>
#include <tuple>
#include <type_traits>

namespace pel::python {

namespace py = pybind11;

// A failed call on its way to becoming pellucid.PellucidError.
struct CallError {
    PelError code;
    std::string message;
};

// Releases the GIL in this scope.
class WithoutGil {
  public:
    WithoutGil() : state_(PyEval_SaveThread()) {}
    ~WithoutGil();
    WithoutGil(const WithoutGil&) = delete;
    WithoutGil& operator=(const WithoutGil&) = delete;

  private:
    PyThreadState* state_;
};

// Holds the GIL in this scope, also on threads that Python did not create, as in callbacks.
class WithGil {
  public:
    WithGil();
    ~WithGil() { PyGILState_Release(state_); }
    WithGil(const WithGil&) = delete;
    WithGil& operator=(const WithGil&) = delete;

  private:
    PyGILState_STATE state_;
};

// Call this before OpenCL is first used. A process that is forked later does not inherit OpenCL's threads:
// calls there would wait for ever, so they throw instead.
void opensDevices();
void refuseForked();

// Runs `body` without the GIL and throws its error. An exception of a progress callback, such as
// KeyboardInterrupt, takes precedence: long work in the library reports its progress.
void call(const std::function<PelError()>& body);

// The same for a body that throws the C++ interface's errors.
template <class Body>
void callThrowing(Body&& body) {
    call([&] {
        try {
            body();
            return PEL_SUCCESS;
        } catch (const pellucid::Error& e) {
            return e.code();
        }
    });
}

// Waits without the GIL and checks for Ctrl-C, which ends the wait but not the work.
void waitInterruptibly(const pellucid::Event& event);

// Whether a signal handler raised an exception, such as KeyboardInterrupt. The body of a long `call` checks
// this and returns early; py::error_already_set is then thrown.
bool signalled();

// An event that is done when all work submitted to the device before is done.
pellucid::Event markerOf(const pellucid::Device& device);

// Called by the thread that ends the process: other threads that request the GIL from now on wait for ever.
void interpreterEnds();

// The bytes of a C structure that a Python object holds; throws unless they are one T.
template <class T>
T* structOf(const py::object& object) {
    const py::buffer_info info = py::reinterpret_borrow<py::buffer>(object).request(true);
    if (size_t(info.size * info.itemsize) != sizeof(T))
        throw CallError{PEL_ERROR_UNKNOWN, "a structure of " + std::to_string(info.size * info.itemsize) +
                                               " bytes instead of one of " + std::to_string(sizeof(T))};
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

// Owns a library object for a Python object, and releases it without the GIL: the last reference to a device
// waits for its queue, whose callbacks and events may need the GIL.
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

// A device, and the Python callable that is called while it works.
struct Device {
    pellucid::Device handle;
    py::object progress = py::none();

    explicit Device(pellucid::Device device);
    ~Device();
    Device(const Device&) = delete;
    Device& operator=(const Device&) = delete;
    PelDevice get() const { return handle.get(); }
};

// Cancels the call of the thread that watches it, at the call's next progress report.
class Cancel : public std::enable_shared_from_this<Cancel> {
  public:
    void watch();
    void ask() { asked_ = true; }
    bool asked() const { return asked_; }

  private:
    std::atomic<bool> asked_{false};
};

// Vertex data as Python passes it: buffer, byte offset, byte stride, count.
using VertexView = std::tuple<pellucid::Buffer, uint64_t, uint32_t, uint32_t>;
inline PelVertexView vertexView(const VertexView& v) {
    return pellucid::vertexView(std::get<0>(v), std::get<3>(v), std::get<1>(v), std::get<2>(v));
}

// An image as Python passes it: buffer, format, width, height, byte offset, pixel, row and plane stride.
using ImageView =
    std::tuple<pellucid::Buffer, uint32_t, uint32_t, uint32_t, uint64_t, uint64_t, uint64_t, uint64_t>;
PelImageDesc imageDesc(const ImageView& v);

// Argument<C>: converts a Python value to a parameter of type C of the C interface. Numbers and enumerations
// are integers or floats.
template <class C>
struct Argument {
    using Python = std::conditional_t<std::is_enum_v<C>, uint32_t, C>;
    explicit Argument(Python given) : value(C(given)) {}
    C get() { return value; }
    C value;
};
// Pointers to numbers and arrays are passed as addresses; single structures as their objects, or None.
template <class T>
struct Argument<T*> {
    static constexpr bool address =
        std::is_void_v<T> || std::is_arithmetic_v<T> || std::is_same_v<T, const PelGaussian> ||
        std::is_same_v<T, const PelLight> || std::is_same_v<T, const PelVertexRange>;
    using Python = std::conditional_t<address, uintptr_t, py::object>;
    explicit Argument(const Python& given) {
        if constexpr (address)
            value = static_cast<T*>(pointer(given));
        else if (!given.is_none())
            value = structOf<std::remove_const_t<T>>(given);
    }
    T* get() { return value; }
    T* value = nullptr;
};
template <>
struct Argument<const char*> {
    using Python = std::string;
    explicit Argument(std::string given) : text(std::move(given)) {
        if (text.find('\0') != std::string::npos) throw py::value_error("a text holds a NUL character");
    }
    const char* get() { return text.c_str(); }
    std::string text;
};
template <class Desc, class View, Desc (*describe)(const View&)>
struct ViewArgument {
    using Python = std::optional<View>;
    explicit ViewArgument(const Python& given) {
        if (given) desc = describe(*given);
    }
    const Desc* get() { return desc ? &*desc : nullptr; }
    std::optional<Desc> desc;
};
template <>
struct Argument<const PelImageDesc*> : ViewArgument<PelImageDesc, ImageView, imageDesc> {
    using ViewArgument::ViewArgument;
};
template <>
struct Argument<const PelVertexView*> : ViewArgument<PelVertexView, VertexView, vertexView> {
    using ViewArgument::ViewArgument;
};
// Events to wait for; the event of the work comes back.
template <>
struct Argument<const PelSubmit*> {
    using Python = Waits;
    explicit Argument(Waits given) : waits(std::move(given)) {
        for (const pellucid::Event& e : waits) handles.push_back(e.get());
    }
    const PelSubmit* get() {
        submit = {handles.data(), uint32_t(handles.size()), &done};
        return &submit;
    }
    Waits waits;
    std::vector<PelEvent> handles;
    PelEvent done = nullptr;
    PelSubmit submit{};
};
template <class Wrapper>
struct HandleArgument {
    using Python = const Wrapper*;  // None: nullptr
    explicit HandleArgument(Python given) : object(given) {}
    auto get() { return object ? object->get() : nullptr; }
    Python object;
};
#define PEL_HANDLE(handle, wrapper)                     \
    template <>                                         \
    struct Argument<handle> : HandleArgument<wrapper> { \
        using HandleArgument::HandleArgument;           \
    }
PEL_HANDLE(PelDevice, Device);
PEL_HANDLE(PelEvent, pellucid::Event);
PEL_HANDLE(PelBuffer, pellucid::Buffer);
PEL_HANDLE(PelMeshTopology, pellucid::MeshTopology);
PEL_HANDLE(PelLiveMesh, pellucid::LiveMesh);
PEL_HANDLE(PelProfile, pellucid::Profile);
PEL_HANDLE(PelLut, pellucid::Lut);
PEL_HANDLE(PelScatter, pellucid::Scatter);
PEL_HANDLE(PelTextureScatter, pellucid::TextureScatter);
#undef PEL_HANDLE

// A Python function that calls `f`; returns the event of submitted work.
template <class... A>
auto function(PelError (*f)(A...)) {
    return [f](typename Argument<A>::Python... given) {
        std::tuple<Argument<A>...> arguments(given...);
        call([&] { return std::apply([&](Argument<A>&... a) { return f(a.get()...); }, arguments); });
        if constexpr ((std::is_same_v<A, const PelSubmit*> || ...))
            return pellucid::Event(std::get<Argument<const PelSubmit*>>(arguments).done);
    };
}

// The same for an `f` whose last parameter is an output, `initial()` before: returns `result(output)`.
template <class Initial, class Result, class... A, size_t... I>
auto functionWithout(PelError (*f)(A...), Initial initial, Result result, std::index_sequence<I...>) {
    using All = std::tuple<A...>;
    return [=](typename Argument<std::tuple_element_t<I, All>>::Python... given) {
        std::tuple<Argument<std::tuple_element_t<I, All>>...> arguments(given...);
        auto value = initial();
        call([&] { return f(std::get<I>(arguments).get()..., &value); });
        return result(value);
    };
}
template <class Initial, class Result, class... A>
auto functionOf(PelError (*f)(A...), Initial initial, Result result) {
    return functionWithout(f, initial, result, std::make_index_sequence<sizeof...(A) - 1>());
}
// The bytes of a structure, from a function such as pelLutGetInfo.
template <auto defaults, class... A>
auto structure(PelError (*f)(A...)) {
    return functionOf(f, defaults, [](const auto& value) { return bytesOf(value); });
}
// A number, an address or a text.
template <class T, class... A>
auto value(PelError (*f)(A...)) {
    return functionOf(
        f, [] { return T{}; },
        [](T value) {
            if constexpr (std::is_same_v<T, void*>)
                return address(value);
            else if constexpr (std::is_same_v<T, const char*>)
                return std::string(value);
            else
                return value;
        });
}
// An object.
template <class Wrapper, class... A>
auto maker(PelError (*f)(A...)) {
    using H = std::remove_pointer_t<std::tuple_element_t<sizeof...(A) - 1, std::tuple<A...>>>;
    return functionOf(
        f, [] { return H(nullptr); }, [](H handle) { return Wrapper(handle); });
}

// An object whose creation needs more than forwarded arguments: `create(&handle)`.
template <class Wrapper, class Create>
Wrapper wrapped(Create&& create) {
    decltype(std::declval<const Wrapper&>().get()) handle = nullptr;
    call([&] { return create(&handle); });
    return Wrapper(handle);
}

// pelSetName of the handle of a T.
template <class T>
auto named() {
    return [](const T& object, const std::string& name) {
        call([&] { return pelSetName(object.get(), name.c_str()); });
    };
}

void bindDevice(py::module_& module);
void bindMesh(py::module_& module);
void bindProfile(py::module_& module);
void bindScatter(py::module_& module);
void bindLut(py::module_& module);
void bindShader(py::module_& module);
void bindBatch(py::module_& module);

}  // namespace pel::python
