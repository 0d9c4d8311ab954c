/* The program of half.c twice, against two versions of the header. */
#include <stdint.h>
#include <stdio.h>

const char* half_now(uint32_t* sizeOfInfo);
const char* half_later(uint32_t* sizeOfInfo);

int main(void) {
    uint32_t now = 0, later = 0;
    const char* wrong[2];
    wrong[0] = half_now(&now);
    wrong[1] = half_later(&later);
    printf("structures of %u and %u bytes in one program\n", (unsigned)now, (unsigned)later);
    for (int i = 0; i < 2; ++i)
        if (wrong[i]) fprintf(stderr, "%s header: %s\n", i ? "longer" : "this", wrong[i]);
    return wrong[0] || wrong[1] || later <= now;
}
