/* A small sphere of skin lit from the left: G-buffer in, picture out (example_minimal.ppm). */
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 256 };
static float normals[SIZE * SIZE][3], curvature[SIZE * SIZE], radiance[SIZE * SIZE][3];
static unsigned char material[SIZE * SIZE];

static void check(PelError error) {
    if (error == PEL_SUCCESS) return;
    fprintf(stderr, "%s: %s\n", pelErrorName(error), pelGetErrorMessage());
    exit(1);
}

/* Describes the caller's own memory; on a CPU nothing is copied. */
static PelImageDesc image(PelDevice device, PelFormat format, void* pixels, size_t bytes) {
    PelImageDesc desc = pelImageDescDefaults();
    desc.format = format;
    desc.width = desc.height = SIZE;
    check(pelBufferCreateFromHost(device, pixels, bytes, &desc.buffer));
    return desc;
}

int main(void) {
    for (int i = 0; i < SIZE * SIZE; ++i) { /* what a renderer would have drawn: a sphere of 8 mm radius */
        const float column = (float)(i % SIZE), row = (float)(i / SIZE);
        const float x = (column + 0.5f) / SIZE * 2.2f - 1.1f, y = 1.1f - (row + 0.5f) / SIZE * 2.2f;
        material[i] = x * x + y * y < 1.0f;
        normals[i][0] = x, normals[i][1] = y,
        normals[i][2] = material[i] ? sqrtf(1.0f - x * x - y * y) : 0.0f;
        curvature[i] = 1.0f / 8.0f;
    }
    PelDevice device;
    PelLut lut;
    PelShader shader;
    const PelCurvatureLutDesc lutDesc = pelCurvatureLutDescDefaults();
    const PelMaterial skin = pelMaterialDefaults();
    PelLight light = pelLightDefaults();
    light.toLight[0] = -1.0f, light.toLight[2] = 0.0f;
    check(pelDeviceCreate(NULL, &device));
    check(pelCurvatureLutCreate(device, &lutDesc, &lut, NULL));
    const PelImageSlot slots[4] = {PEL_SLOT_RADIANCE, PEL_SLOT_NORMAL_SHADING, PEL_SLOT_CURVATURE,
                                   PEL_SLOT_MATERIAL};
    const PelImageDesc images[4] = {image(device, PEL_FORMAT_RGB32F, radiance, sizeof radiance),
                                    image(device, PEL_FORMAT_RGB32F, normals, sizeof normals),
                                    image(device, PEL_FORMAT_R32F, curvature, sizeof curvature),
                                    image(device, PEL_FORMAT_R8_UINT, material, sizeof material)};
    check(pelShaderCreate(device, &shader));
    for (int i = 0; i < 4; ++i) check(pelShaderSetImage(shader, slots[i], &images[i]));
    check(pelShaderSetMaterial(shader, 1, &skin, lut, NULL));
    check(pelShaderSetLights(shader, &light, 1));
    check(pelShaderCommit(shader));
    check(pelShaderExecute(shader, NULL));

    float* result; /* the same memory again, now with the picture in it */
    check(pelBufferMap(images[0].buffer, (void**)&result));
    FILE* file = fopen("example_minimal.ppm", "wb");
    if (!file) return perror("example_minimal.ppm"), 1;
    fprintf(file, "P6 %d %d 255\n", SIZE, SIZE);
    for (int i = 0; i < SIZE * SIZE * 3; ++i) fputc((int)(255.0f * powf(result[i], 1 / 2.2f) + 0.5f), file);
    fclose(file);
    /* just past the terminator: red light only */
    const float* beyond = radiance[SIZE / 2 * SIZE + SIZE / 2 + 8];
    printf("just past the terminator: %.3f %.3f %.3f\n", beyond[0], beyond[1], beyond[2]);
    check(pelBufferUnmap(images[0].buffer));
    for (int i = 0; i < 4; ++i) pelBufferRelease(images[i].buffer);
    pelShaderRelease(shader), pelLutRelease(lut), pelDeviceRelease(device);
    return beyond[0] > beyond[2] ? 0 : 1;
}
