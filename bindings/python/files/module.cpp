// The extension module pellucid._files: meshes, images and scenes from files, and the heads of the demo.
#include <algorithm>
#include <new>

#include "demo/demo_hair.h"
#include "files.h"
#include "io/image/image_format.h"
#include "io/image/tone_map.h"

namespace py = pybind11;

namespace {

using namespace pellucid;
using python::array, python::Pixels, python::rows, python::toDict;

std::vector<double> list(sample::Vec3 v) {
    return {v.x, v.y, v.z};
}

py::dict loadMesh(const std::string& path, int levels) {
    io::MeshData mesh;
    {
        const py::gil_scoped_release free;
        io::MeshLoadOptions options;
        options.splitUvSeams = levels == 0;  // subdivision would round the sides of a seam off by themselves
        mesh = io::loadMesh(path, options);
        io::loopSubdivide(mesh, levels);
        if (mesh.normals.empty()) io::computeNormals(mesh);
    }
    return toDict(mesh);
}

#ifdef PELLUCID_SAMPLE
// The demo's hair: x, y, z of each point, from root to tip, with the radius at the root, mm; and how many
// points each strand has.
py::tuple headStrands(const std::string& path, int levels) {
    const demo::DemoHead head = demo::loadDemoHead(path, levels);
    const io::MeshData& mesh = head.mesh;
    const sample::Scene skin({mesh.positions, mesh.normals, {}, {}, mesh.triangles, head.materials});
    std::vector<float> values;
    std::vector<int32_t> counts;
    for (const demo::Strand& strand : demo::strandsOf(skin, head)) {
        counts.push_back(int32_t(strand.points.size()));
        for (const sample::Vec3 p : strand.points)
            values.insert(values.end(), {float(p.x), float(p.y), float(p.z), float(strand.radius)});
    }
    return py::make_tuple(rows(values, 4), array(counts, {std::ssize(counts)}));
}
#endif

// One of the project's heads, or None for a mesh without its parts. A vertex's albedo has look and zones.
py::object loadHead(const std::string& path, int levels) {
    demo::DemoHead head;
    std::vector<float> albedo;
    std::vector<uint32_t> ids;
    {
        const py::gil_scoped_release free;
        if (!demo::hasHeadParts(path)) return py::none();
        head = demo::loadDemoHead(path, levels);
        if (!head.cornerUvs.empty()) io::splitAtSeams(head.mesh, head.cornerUvs);
        ids.assign(head.mesh.vertexCount(), demo::DEMO_SKIN);  // parts share no vertices
        for (size_t c = 0; c < head.mesh.triangles.size(); ++c)
            ids[head.mesh.triangles[c]] = head.materials[c / 3];
        for (size_t v = 0; v < ids.size(); ++v) {
            const sample::Look& look = head.looks[ids[v] - 1];
            sample::LinearColor color{look.albedo[0], look.albedo[1], look.albedo[2]};
            if (look.kind == sample::Look::Kind::Skin)
                for (const sample::SkinZone& zone : head.zones) {
                    const float* p = &head.mesh.positions[3 * v];
                    const sample::LinearColor factor = zone.colorAt({p[0], p[1], p[2]});
                    for (int c = 0; c < 3; ++c) color[c] *= factor[c];
                }
            albedo.insert(albedo.end(), {float(color[0]), float(color[1]), float(color[2])});
        }
    }
    py::dict d = toDict(head.mesh);
    d["albedo"] = rows(albedo, 3);
    d["ids"] = array(ids, {py::ssize_t(ids.size())});
    d["up"] = list(head.pose.up);
    d["front"] = list(head.pose.front);
    d["low"] = list(head.frame.low);
    d["high"] = list(head.frame.high);
    py::list eyes;
    for (const sample::EyeLook& eye : head.eyes) {
        using namespace py::literals;
        eyes.append(py::dict("centre"_a = list(eye.centre), "gaze"_a = list(eye.gaze),
                             "radius"_a = eye.radius, "sclera"_a = eye.sclera));
    }
    d["eyes"] = eyes;
    return d;
}

py::dict readImage(const std::string& path) {
    io::Image image;
    {
        const py::gil_scoped_release free;
        image = io::readImage(path);
    }
    py::dict channels;
    for (const io::Channel& c : image.channels)
        channels[py::str(c.name)] = array(c.pixels, {py::ssize_t(image.height), py::ssize_t(image.width)});
    return channels;
}

using Bytes = py::array_t<uint8_t, py::array::c_style>;

void writeExr(const std::string& path, const std::vector<std::string>& names, const Pixels& pixels,
              bool half) {
    io::Image image;
    image.height = int(pixels.shape(0));
    image.width = int(pixels.shape(1));
    const std::span<const float> values(pixels.data(), size_t(pixels.size()));
    const py::gil_scoped_release free;
    image.addInterleaved(names, values, half ? io::ChannelType::Half : io::ChannelType::Float);
    io::writeExr(path, image);
}

void writeBytes(const std::string& path, const Bytes& pixels) {
    const int height = int(pixels.shape(0)), width = int(pixels.shape(1)), channels = int(pixels.shape(2));
    const std::span<const uint8_t> values(pixels.data(), size_t(pixels.size()));
    const py::gil_scoped_release free;
    io::writeImage8(path, width, height, channels, values, true);
}

Bytes toneMapped(const Pixels& rgb, float exposure, float shoulder, const std::string& curve) {
    const auto known = std::ranges::find(io::toneCurves, curve);
    if (known == std::end(io::toneCurves))
        throw py::value_error("curve is '" + curve + "'; it must be soft, none, filmic or agx-like");
    if (curve == "agx-like" && (rgb.ndim() == 0 || rgb.shape(rgb.ndim() - 1) != 3))
        throw py::value_error("agx-like mixes red, green and blue: the shape (..., 3) is needed");
    std::vector<uint8_t> bytes;
    {
        const std::span<const float> values(rgb.data(), size_t(rgb.size()));
        const py::gil_scoped_release free;
        bytes = io::toSrgb8(values, {exposure, shoulder, io::ToneCurve(known - std::begin(io::toneCurves))});
    }
    return array(bytes, {rgb.shape(), rgb.shape() + rgb.ndim()});
}

// If each module has its own C++ library, as in wheels, pybind11's translator only recognises exceptions of
// the first loaded module, so this module needs its own. Translators registered later are tried first.
void translateExceptions(std::exception_ptr pending) {
    try {
        if (pending) std::rethrow_exception(pending);
    } catch (py::error_already_set& e) {
        e.restore();
    } catch (const py::builtin_exception& e) {
        e.set_error();
    } catch (const std::bad_alloc&) {
        PyErr_NoMemory();
    } catch (const std::invalid_argument& e) {
        PyErr_SetString(PyExc_ValueError, e.what());
    } catch (const std::exception& e) {
        PyErr_SetString(PyExc_RuntimeError, e.what());
    }
}

}  // namespace

PYBIND11_MODULE(_files, module) {
    module.doc() = "Meshes, images and scenes from files, for the Python files of this package alone.";
    py::register_exception_translator(&translateExceptions);
    py::register_exception<io::FileError>(module, "FileError", PyExc_OSError);
    module.def("load_mesh", &loadMesh);
    module.def("load_head", &loadHead);
#ifdef PELLUCID_SAMPLE
    module.def("head_strands", &headStrands);
#endif
    module.def("read_image", &readImage);
    module.def("write_exr", &writeExr);
    module.def("write_bytes", &writeBytes);
    module.def("tone_mapped", &toneMapped);
    python::bindScene(module);
    python::bindGltf(module);
}
