#include <pellucid/pellucid.h>
#include <stdio.h>

/* The device functions for a renderer's own kernels are where the package says that they are. */
static int readable(const char* name) {
    char path[1024];
    snprintf(path, sizeof path, "%s/%s", KERNELS, name);
    FILE* file = fopen(path, "r");
    if (!file) return fprintf(stderr, "%s is not there\n", path), 0;
    fclose(file);
    return 1;
}

int main(void) {
    if (!readable("lib/shading/specular.clh") || !readable("shared/lut.h")) return 1;
    PelDevice device;
    if (pelDeviceCreate(NULL, &device)) return fprintf(stderr, "%s\n", pelGetErrorMessage()), 1;
    PelDeviceInfo info = pelDeviceInfoDefaults();
    pelDeviceGetInfo(device, &info);
    printf("%s\n", info.name);
    pelDeviceRelease(device);
    return 0;
}
