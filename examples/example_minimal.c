/* A sphere of skin, lit from the side: G-buffer in, picture out. Writes example_minimal.ppm. */
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>
#include <stdlib.h>

enum { SIZE = 256 };
static const float radius = 8.0f; /* millimetres: small enough to see light wrap round it */
static float normals[SIZE * SIZE][3], curvature[SIZE * SIZE], radiance[SIZE * SIZE][3];
static unsigned char material[SIZE * SIZE];

static void check(PelError error) {
    if (error == PEL_SUCCESS) return;
    fprintf(stderr, "%s: %s\n", pelErrorName(error), pelGetErrorMessage());
    exit(1);
}

static PelImageDesc image(PelDevice device, PelFormat format, void* pixels, size_t bytes) {
    PelImageDesc desc = pelImageDescDefaults();
    desc.format = format;
    desc.width = desc.height = SIZE;
    check(pelBufferCreateFromHost(device, pixels, bytes, &desc.buffer)); /* in place, nothing is copied on a CPU */
    return desc;
}

int main(void) {
    for (int i = 0; i < SIZE * SIZE; ++i) { /* what a renderer would have drawn */
        const float x = (i % SIZE + 0.5f) / SIZE * 2.2f - 1.1f, y = 1.1f - (i / SIZE + 0.5f) / SIZE * 2.2f;
        material[i] = x * x + y * y < 1.0f;
        normals[i][0] = x, normals[i][1] = y, normals[i][2] = material[i] ? sqrtf(1.0f - x * x - y * y) : 0.0f;
        curvature[i] = 1.0f / radius;
    }
    PelDevice device;
    check(pelDeviceCreate(NULL, &device));
    PelCurvatureLutDesc lutDesc = pelCurvatureLutDescDefaults();
    PelLut lut;
    check(pelCurvatureLutCreate(device, &lutDesc, &lut, NULL));

    const PelLight light = pelLightDefaults();
    PelLight fromTheLeft = light;
    fromTheLeft.toLight[0] = -1.0f, fromTheLeft.toLight[2] = 0.0f;
    const PelMaterial skin = pelMaterialDefaults();
    const PelImageDesc target = image(device, PEL_FORMAT_RGB32F, radiance, sizeof radiance);
    const PelImageDesc inputs[] = {image(device, PEL_FORMAT_RGB32F, normals, sizeof normals),
                                   image(device, PEL_FORMAT_R32F, curvature, sizeof curvature),
                                   image(device, PEL_FORMAT_R8_UINT, material, sizeof material)};
    PelShader shader;
    check(pelShaderCreate(device, &shader));
    check(pelShaderSetImage(shader, PEL_SLOT_RADIANCE, &target));
    check(pelShaderSetImage(shader, PEL_SLOT_NORMAL_SHADING, &inputs[0]));
    check(pelShaderSetImage(shader, PEL_SLOT_CURVATURE, &inputs[1]));
    check(pelShaderSetImage(shader, PEL_SLOT_MATERIAL, &inputs[2]));
    check(pelShaderSetMaterial(shader, 1, &skin, lut, NULL));
    check(pelShaderSetLights(shader, &fromTheLeft, 1));
    check(pelShaderCommit(shader));
    check(pelShaderExecute(shader, NULL));

    void* result;
    check(pelBufferMap(target.buffer, &result)); /* the caller's own memory again, now with the result */
    FILE* file = fopen("example_minimal.ppm", "wb");
    if (!file) return perror("example_minimal.ppm"), 1;
    fprintf(file, "P6 %d %d 255\n", SIZE, SIZE);
    for (int i = 0; i < SIZE * SIZE * 3; ++i) fputc((int)(255.0f * powf(((float*)result)[i], 1 / 2.2f) + 0.5f), file);
    fclose(file);
    const float* terminator = radiance[SIZE / 2 * SIZE + SIZE / 2 + 8]; /* just beyond it: red light only */
    printf("just beyond the terminator: %.3f %.3f %.3f\n", terminator[0], terminator[1], terminator[2]);
    check(pelBufferUnmap(target.buffer));
    pelShaderRelease(shader);
    pelLutRelease(lut);
    for (int i = 0; i < 3; ++i) pelBufferRelease(inputs[i].buffer);
    pelBufferRelease(target.buffer);
    pelDeviceRelease(device);
    return 0;
}
