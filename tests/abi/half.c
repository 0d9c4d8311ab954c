/* One half of a program, compiled against one version of the header: HALF is its name. Returns what went
 * wrong, or NULL. */
#include <math.h>
#include <pellucid/pellucid.h>
#include <string.h>

#define JOIN_(a, b) a##_##b
#define JOIN(a, b) JOIN_(a, b)

const char* JOIN(half, HALF)(uint32_t* sizeOfInfo) {
    *sizeOfInfo = (uint32_t)sizeof(PelDeviceInfo);
    PelDevice device;
    if (pelDeviceCreate(NULL, &device)) return pelGetErrorMessage();
    /* Filled by the library: fields up to the caller's end, nothing past it, structSize as it was. */
    struct {
        PelDeviceInfo info;
        unsigned char guard[64];
    } s;
    memset(&s, 0x5a, sizeof s);
    s.info = pelDeviceInfoDefaults();
    if (pelDeviceGetInfo(device, &s.info)) return pelGetErrorMessage();
    if (s.info.structSize != sizeof s.info || !s.info.name[0] || !s.info.globalMemoryBytes)
        return "PelDeviceInfo is wrong";
    for (int i = 0; i < 64; ++i)
        if (s.guard[i] != 0x5a) return "memory after PelDeviceInfo was written";
    /* Read by the library: a tetrahedron with its directions as normals; scale is among the last fields. */
    const float p[24] = {1, 1, 1, 1, -1, -1, -1, 1, -1, -1, -1, 1};
    const uint32_t t[12] = {0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2};
    float vertices[24], curvature[4];
    for (int i = 0; i < 12; ++i) {
        vertices[i] = 2 * p[i];
        vertices[12 + i] = p[i] / sqrtf(3);
    }
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = 4;
    mesh.indices = t;
    mesh.numIndices = 12;
    PelMeshTopology topology;
    PelBuffer in, out;
    if (pelMeshTopologyCreate(device, &mesh, &topology, NULL)) return pelGetErrorMessage();
    if (pelBufferCreate(device, sizeof vertices, vertices, &in)) return pelGetErrorMessage();
    if (pelBufferCreate(device, sizeof curvature, NULL, &out)) return pelGetErrorMessage();
    const PelVertexView positions = {in, 0, 0, 4}, normals = {in, 48, 0, 4}, result = {out, 0, 0, 4};
    PelCurvatureParams params = pelCurvatureParamsDefaults();
    params.estimator = PEL_CURVATURE_EDGE;
    params.scale = 10;
    if (pelMeshCurvature(topology, &params, &positions, &normals, &result, NULL, NULL))
        return pelGetErrorMessage();
    if (pelBufferRead(out, 0, sizeof curvature, curvature, NULL)) return pelGetErrorMessage();
    pelBufferRelease(in);
    pelBufferRelease(out);
    pelMeshTopologyRelease(topology);
    pelDeviceRelease(device);
    for (int i = 0; i < 4; ++i)
        if (fabsf(curvature[i] * sqrtf(12) - 10) > 1e-3f) return "the curvature is wrong";
    return NULL;
}
