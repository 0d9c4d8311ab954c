/* Host memory in place: curvature is read from and written into one interleaved vertex array of the host's.
 * On a device that shares its memory nothing is copied, which the counters show; on any other, mapping brings
 * the result over. */
#define _POSIX_C_SOURCE 200112L
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>
#include <stdlib.h>

#define CHECK(call) \
    if (call) return fprintf(stderr, "%s: %s\n", #call, pelGetErrorMessage()), 1

typedef struct Vertex {
    float position[3], normal[3], curvature, uv[2];
} Vertex;

enum { ROWS = 64, COLUMNS = 128, COUNT = ROWS * COLUMNS };

int main(void) {
    /* A band of a sphere of radius 50. Memory aligned to 4096 bytes can be shared by any device that shares
     * memory. */
    const size_t bytes = (sizeof(Vertex) * COUNT + 4095) / 4096 * 4096;
    void* memory;
    if (posix_memalign(&memory, 4096, bytes)) return 1;
    Vertex* vertices = memory;
    static uint32_t triangles[(ROWS - 1) * (COLUMNS - 1) * 6];
    uint32_t* t = triangles;
    for (int y = 0; y < ROWS; ++y)
        for (int x = 0; x < COLUMNS; ++x) {
            Vertex* v = &vertices[y * COLUMNS + x];
            const float a = 0.01f * (float)(y - ROWS / 2), b = 0.02f * (float)x;
            const float n[3] = {cosf(a) * cosf(b), cosf(a) * sinf(b), sinf(a)};
            for (int i = 0; i < 3; ++i) {
                v->normal[i] = n[i];
                v->position[i] = 50 * n[i];
            }
            v->curvature = v->uv[0] = v->uv[1] = -1;
            if (x == 0 || y == 0) continue;
            const uint32_t d = (uint32_t)(y * COLUMNS + x), c = d - 1, e = d - COLUMNS, f = e - 1;
            const uint32_t quad[6] = {f, e, c, c, e, d};
            for (int i = 0; i < 6; ++i) *t++ = quad[i];
        }

    PelDevice device;
    CHECK(pelDeviceCreate(NULL, &device));
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = COUNT;
    mesh.indices = triangles;
    mesh.numIndices = sizeof triangles / sizeof *triangles;
    PelMeshTopology topology;
    CHECK(pelMeshTopologyCreate(device, &mesh, &topology, NULL));
    PelBuffer buffer;
    CHECK(pelBufferCreateFromHost(device, memory, bytes, &buffer));
    const PelVertexView p = {buffer, offsetof(Vertex, position), sizeof(Vertex), COUNT};
    const PelVertexView n = {buffer, offsetof(Vertex, normal), sizeof(Vertex), COUNT};
    const PelVertexView c = {buffer, offsetof(Vertex, curvature), sizeof(Vertex), COUNT};
    const PelCurvatureParams params = pelCurvatureParamsDefaults();

    PelDeviceInfo info = pelDeviceInfoDefaults();
    PelDeviceStats before = pelDeviceStatsDefaults(), after = before;
    CHECK(pelDeviceGetInfo(device, &info));
    CHECK(pelDeviceGetStats(device, &before));
    CHECK(pelMeshCurvature(topology, &params, &p, &n, &c, NULL, NULL));
    CHECK(pelDeviceGetStats(device, &after));
    const unsigned long moved =
        (unsigned long)(after.bytesToDevice + after.bytesToHost - before.bytesToDevice - before.bytesToHost);

    /* The memory belongs to the device until it is mapped. */
    void* mapped;
    CHECK(pelBufferMap(buffer, &mapped));
    int wrong = mapped != memory;
    for (int i = 0; i < COUNT; ++i)
        wrong += fabsf(vertices[i].curvature * 50 - 1) > 1e-3f || vertices[i].uv[0] != -1;
    CHECK(pelBufferUnmap(buffer));
    printf("%d vertices in place, %lu bytes copied, %d wrong\n", COUNT, moved, wrong);

    pelBufferRelease(buffer);
    pelMeshTopologyRelease(topology);
    pelDeviceRelease(device);
    free(memory);
    return wrong || (info.sharedMemory && moved);
}
