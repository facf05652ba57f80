/* The built-in ground textures, each a tile: linear albedo, whose luminance is also taken as the relief. */
#include "scenes/builtin/tile.h"

v4x WIDE(amb_hills_noise)(v2x uv);
v4x WIDE(amb_ground_grass)(v2x uv);
v4x WIDE(amb_ground_rock)(v2x uv);
v4x WIDE(amb_ground_sand)(v2x uv);
v4x WIDE(amb_ground_snow)(v2x uv);

AMB_INLINE v3x mix(v3x a, v3 b, f32x t) { return v3x_lerp(a, v3x_splat(b), t); }

/* Thin ridges along one direction, bent: one layer of blades. 0…1. */
static f32x blades(v2x uv, float a, float b, uint32_t seed)
{
    v2x turned = tile_turned(uv, a, b);
    f32x bend = tile_noise((v2x){uv.x * 16.0f, uv.y * 16.0f}, 16, seed) * 0.02f;
    v2x thin = {(turned.x + bend) * 64.0f, turned.y * 8.0f};
    f32x n = tile_noise(thin, 512, seed + 1u);
    return f_saturate(1.0f - f_abs(n) * 3.0f);
}

v4x WIDE(amb_ground_grass)(v2x uv)
{
    f32x clumps = tile_fbm(uv, 8, 201, 5, 0.55f), fine = tile_fbm(uv, 64, 202, 4, 0.6f);
    f32x blade = f_set(0.0f);
    static const float way[6][2] = {{2, 1}, {1, 2}, {2, -1}, {1, -2}, {3, 1}, {1, -3}};
    for (uint32_t i = 0; i < 6; i++)
        blade = f_max(blade * 0.86f, blades(uv, way[i][0], way[i][1], 210u + 7u * i));
    f32x light = f_saturate(0.10f + 0.55f * blade + 0.30f * clumps + 0.34f * fine);
    v3x colour = mix(v3x_splat((v3){0.016f, 0.030f, 0.007f}), (v3){0.105f, 0.150f, 0.036f}, light);
    f32x dry = f_smoothstep(f_set(0.15f), f_set(0.8f), tile_fbm(uv, 4, 203, 6, 0.6f) + 0.25f * blade);
    colour = mix(colour, (v3){0.165f, 0.140f, 0.055f}, dry * 0.30f);
    return v4x_of3(colour, f_set(1.0f));
}

/* Folds of a noise, sharp where it is 0: fractures. 0 in a fracture, 1 away from it. */
static f32x fractures(v2x uv, int cells, uint32_t seed, float width)
{
    f32x n = f_abs(tile_fbm(uv, cells, seed, 5, 0.5f));
    return f_smoothstep(f_set(0.0f), f_set(width), n);
}

v4x WIDE(amb_ground_rock)(v2x uv)
{
    v2x bent = {uv.x + 0.05f * tile_fbm(uv, 4, 221, 5, 0.5f), uv.y + 0.05f * tile_fbm(uv, 4, 222, 5, 0.5f)};
    f32x layers = tile_fbm((v2x){bent.x, bent.y * 4.0f}, 4, 228, 7, 0.55f); /* strata along u */
    tile_cells_ chips = tile_cells((v2x){bent.x, bent.y * 2.0f}, 16, 224);
    f32x crack = fractures(bent, 4, 223, 0.16f), fine = fractures((v2x){bent.x, bent.y * 2.0f}, 16, 229, 0.25f);
    f32x rough = tile_fbm(bent, 8, 225, 8, 0.66f);
    f32x light = f_saturate(0.46f + 0.26f * rough + 0.22f * layers + 0.16f * (chips.random - 0.5f));
    light = light * (0.45f + 0.55f * crack) * (0.75f + 0.25f * fine);
    v3x colour = mix(v3x_splat((v3){0.035f, 0.033f, 0.032f}), (v3){0.36f, 0.335f, 0.305f}, light);
    f32x lichen = f_smoothstep(f_set(0.25f), f_set(0.75f), tile_fbm(uv, 8, 226, 6, 0.6f));
    colour = mix(colour, (v3){0.17f, 0.165f, 0.085f}, lichen * 0.25f);
    f32x iron = f_smoothstep(f_set(0.2f), f_set(0.9f), tile_fbm(uv, 4, 227, 6, 0.55f));
    colour = mix(colour, (v3){0.22f, 0.14f, 0.085f}, iron * 0.25f);
    return v4x_of3(colour, f_set(1.0f));
}

v4x WIDE(amb_ground_sand)(v2x uv)
{
    f32x bend = tile_fbm(uv, 4, 231, 4, 0.5f);
    f32x ripple = f_sin((uv.y * 24.0f + bend * 0.75f) * (2.0f * AMB_PI));
    f32x grain = tile_fbm(uv, 256, 232, 2, 0.7f), soft = tile_fbm(uv, 8, 233, 5, 0.5f);
    tile_cells_ pebbles = tile_cells(uv, 64, 234);
    f32x pebble = f_smoothstep(f_set(0.30f), f_set(0.16f), pebbles.nearest) *
                  f_smoothstep(f_set(0.80f), f_set(0.84f), pebbles.random);
    f32x light = f_saturate(0.55f + 0.05f * ripple + 0.20f * grain + 0.14f * soft);
    v3x colour = mix(v3x_splat((v3){0.20f, 0.155f, 0.10f}), (v3){0.56f, 0.46f, 0.325f}, light);
    v3x stone = mix(v3x_splat((v3){0.14f, 0.13f, 0.12f}), (v3){0.46f, 0.44f, 0.42f}, f_fract(pebbles.random * 57.0f));
    return v4x_of3(v3x_lerp(colour, stone, pebble * 0.7f), f_set(1.0f));
}

v4x WIDE(amb_ground_snow)(v2x uv)
{
    v2x bent = {uv.x + 0.02f * tile_fbm(uv, 8, 241, 4, 0.5f), uv.y};
    f32x drift = tile_fbm((v2x){bent.x * 2.0f, bent.y}, 4, 242, 6, 0.52f), grain = tile_fbm(uv, 256, 243, 2, 0.7f);
    f32x light = f_saturate(0.55f + 0.32f * drift + 0.10f * grain);
    v3x colour = mix(v3x_splat((v3){0.66f, 0.71f, 0.79f}), (v3){0.93f, 0.935f, 0.945f}, light);
    return v4x_of3(colour, f_set(1.0f));
}

v4x WIDE(amb_hills_noise)(v2x uv)
{
    f32x n[4];
    for (uint32_t i = 0; i < 4; i++)
        n[i] = f_saturate(0.5f + 0.5f * tile_fbm(uv, 4, 251u + 16u * i, 7, 0.6f));
    return (v4x){n[0], n[1], n[2], n[3]};
}
