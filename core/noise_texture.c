#include <ambiance/noise_texture.h>

static uint32_t byte_at(uint32_t x, uint32_t y, uint32_t seed)
{
    const uint32_t mask = AMB_NOISE_TEXTURE - 1u;
    return amb_hash((x & mask) + amb_hash((y & mask) + seed)) >> 24;
}

void amb_noise_texture_make(amb_noise_texture *texture, uint32_t seed)
{
    for (uint32_t y = 0; y < AMB_NOISE_TEXTURE; y++)
        for (uint32_t x = 0; x < AMB_NOISE_TEXTURE; x++)
            texture->corners[y * AMB_NOISE_TEXTURE + x] = byte_at(x, y, seed) | byte_at(x + 1, y, seed) << 8 |
                                                          byte_at(x, y + 1, seed) << 16 |
                                                          byte_at(x + 1, y + 1, seed) << 24;
}
