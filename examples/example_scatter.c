/* Scattering alone: a host that has lit its own frame hands over its diffuse lighting, positions and ids, and
 * gets the lighting back scattered under the skin, in place. Here the frame is a ball of 10 mm, lit from the
 * right. */
#include <math.h>
#include <pellucid/pellucid.h>
#include <stdio.h>

#define CHECK(call) \
    if (call) return fprintf(stderr, "%s: %s\n", #call, pelGetErrorMessage()), 1

enum { SIDE = 200 };
static float light[SIDE * SIDE][3], positions[SIDE * SIDE][3];
static unsigned char ids[SIDE * SIDE];

int main(void) {
    for (int y = 0; y < SIDE; ++y)
        for (int x = 0; x < SIDE; ++x) {
            float* p = positions[y * SIDE + x];
            p[0] = 0.11f * ((float)x - SIDE / 2), p[1] = 0.11f * ((float)y - SIDE / 2);
            const float rest = 100 - p[0] * p[0] - p[1] * p[1];
            if (rest <= 0) continue;
            p[2] = sqrtf(rest);
            ids[y * SIDE + x] = 1; /* skin; 0 is background */
            for (int c = 0; c < 3; ++c) light[y * SIDE + x][c] = p[0] > 0 ? p[0] / 10 : 0;
        }

    PelDevice device;
    PelProfile skin;
    PelScatter scatter;
    CHECK(pelDeviceCreate(NULL, &device));
    CHECK(pelProfileCreateSkin(&skin));
    CHECK(pelScatterCreate(device, &scatter));
    CHECK(pelScatterSetMaterial(scatter, 1, skin, 1)); /* positions are in mm, as profiles are */

    PelImageDesc image = pelImageDescDefaults(), place = image, material = image;
    CHECK(pelBufferCreate(device, sizeof light, light, &image.buffer));
    CHECK(pelBufferCreate(device, sizeof positions, positions, &place.buffer));
    CHECK(pelBufferCreate(device, sizeof ids, ids, &material.buffer));
    image.format = place.format = PEL_FORMAT_RGB32F;
    material.format = PEL_FORMAT_R8_UINT;
    image.width = image.height = place.width = place.height = material.width = material.height = SIDE;
    const PelScatterParams params = pelScatterParamsDefaults();
    CHECK(pelScatterExecute(scatter, &params, &image, &place, NULL, &material, &image, NULL));
    CHECK(pelBufferRead(image.buffer, 0, sizeof light, light, NULL));

    PelScatterStats stats = pelScatterStatsDefaults();
    CHECK(pelScatterGetStats(scatter, &stats));
    const float* dark = light[SIDE / 2 * SIDE + SIDE / 2 - 5]; /* half a millimetre beyond the terminator */
    printf("half a millimetre into the dark: %.4f red, %.4f blue; %.0f of %.0f pixels were gathered\n",
           (double)dark[0], (double)dark[2], (double)stats.pixelsTapped, (double)stats.pixelsCovered);
    pelBufferRelease(image.buffer), pelBufferRelease(place.buffer), pelBufferRelease(material.buffer);
    pelScatterRelease(scatter), pelProfileRelease(skin), pelDeviceRelease(device);
    return dark[0] > dark[2] && dark[0] > 0 ? 0 : 1;
}
