#include <pellucid/pellucid.h>
#include <stdio.h>

int main(void) {
    PelDevice device;
    if (pelDeviceCreate(NULL, &device)) return fprintf(stderr, "%s\n", pelGetErrorMessage()), 1;
    PelDeviceInfo info = pelDeviceInfoDefaults();
    pelDeviceGetInfo(device, &info);
    printf("%s\n", info.name);
    pelDeviceRelease(device);
    return 0;
}
