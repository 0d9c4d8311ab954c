/* Progress and cancelling: a callback receives the progress of long work, here the analysis of a mesh of a
 * million triangles, and ends it by returning 0. A cancelled call leaves nothing behind, and everything stays
 * usable. */
#include <pellucid/pellucid.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIDE = 708, COUNT = SIDE * SIDE };

typedef struct Watcher {
    double stopAt; /* fraction */
    int calls;
} Watcher;

static int onProgress(void* user, double fraction, const char* what) {
    Watcher* watcher = user;
    ++watcher->calls;
    printf("%3.0f %% %s\n", 100 * fraction, what);
    return fraction < watcher->stopAt;
}

static PelError analyse(PelDevice device, const uint32_t* triangles, const float* positions) {
    PelMeshTopologyDesc mesh = pelMeshTopologyDescDefaults();
    mesh.numVertices = COUNT;
    mesh.indices = triangles;
    mesh.numIndices = (uint64_t)(SIDE - 1) * (SIDE - 1) * 6;
    mesh.weld = PEL_WELD_EXACT;
    mesh.positions = positions;
    PelMeshTopology topology = NULL;
    const PelError error = pelMeshTopologyCreate(device, &mesh, &topology, NULL);
    pelMeshTopologyRelease(topology);
    return error;
}

int main(void) {
    float* positions = malloc(COUNT * 3 * sizeof *positions);
    uint32_t* triangles = malloc((size_t)(SIDE - 1) * (SIDE - 1) * 6 * sizeof *triangles);
    if (!positions || !triangles) return 1;
    uint32_t* t = triangles;
    for (uint32_t i = 0; i < COUNT; ++i) {
        positions[3 * i] = (float)(i % SIDE);
        positions[3 * i + 1] = (float)(i / SIDE);
        positions[3 * i + 2] = 0;
        if (i % SIDE == 0 || i < SIDE) continue;
        const uint32_t quad[6] = {i - SIDE - 1, i - SIDE, i - 1, i - 1, i - SIDE, i};
        for (int k = 0; k < 6; ++k) *t++ = quad[k];
    }
    PelDevice device;
    if (pelDeviceCreate(NULL, &device)) return fprintf(stderr, "%s\n", pelGetErrorMessage()), 1;

    Watcher impatient = {0.2, 0}, patient = {2, 0};
    pelDeviceSetProgress(device, onProgress, &impatient);
    const PelError cancelled = analyse(device, triangles, positions);
    printf("%s: %s\n", pelErrorName(cancelled), pelGetErrorMessage());
    pelDeviceSetProgress(device, onProgress, &patient);
    const PelError finished = analyse(device, triangles, positions);
    printf("%s\n", pelErrorName(finished));

    pelDeviceRelease(device);
    free(positions);
    free(triangles);
    return cancelled != PEL_ERROR_CANCELLED || finished != PEL_SUCCESS || patient.calls <= impatient.calls;
}
