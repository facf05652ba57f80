/* The cache of made assets: what comes back is what went in, bit for bit, and nothing else ever comes back. */
#include "core/texture_layout.h"
#include "scenes/asset_cache.h"

#include <ambiance/assets.h>
#include <dirent.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[256];

static asset_cache open_cache(void)
{
    asset_cache cache;
    setenv("AMBIANCE_CACHE", folder, 1);
    asset_cache_open(&cache, true);
    assert_string_equal(cache.folder, folder);
    assert_int_equal(strlen(cache.build), 40);
    return cache;
}

static int empty_folder(void **state)
{
    char command[300];
    (void)state;
    snprintf(command, sizeof command, "rm -rf %s", folder);
    return system(command); /* NOLINT: a folder of ours */
}

static amb_texture *texture_of(amb_texture_kind kind, amb_texel texel, int size, uint32_t seed)
{
    const int depth = kind == AMB_TEXTURE_3D || kind == AMB_TEXTURE_2D_ARRAY ? 3 : 1;
    const int slices = kind == AMB_TEXTURE_CUBE ? 6 : depth;
    size_t bytes = (size_t)size * (size_t)size * (size_t)slices * texel_bytes(texel);
    unsigned char *data = malloc(bytes);
    amb_texture *texture;
    assert_non_null(data);
    for (size_t i = 0; i < bytes; i++)
        data[i] = (unsigned char)((seed = seed * 1664525u + 1013904223u) >> 25); /* no NaN: below 0x80 */
    amb_texture_desc desc = {.kind = kind,
                             .texel = texel,
                             .width = size,
                             .height = size,
                             .depth = depth,
                             .make_mips = true,
                             .data = data,
                             .data_bytes = bytes};
    assert_int_equal(amb_texture_create(&desc, &texture, NULL), AMB_OK);
    free(data);
    return texture;
}

static bool same(const amb_texture *a, const amb_texture *b)
{
    return memcmp(&a->info, &b->info, sizeof a->info) == 0 && a->storage == b->storage && a->words == b->words &&
           memcmp(a->data, b->data, a->words * sizeof *a->data) == 0 && memcmp(a->base, b->base, sizeof a->base) == 0 &&
           memcmp(a->pitch, b->pitch, sizeof a->pitch) == 0;
}

static void every_kind_and_format_comes_back_bit_for_bit(void **state)
{
    asset_cache cache = open_cache();
    char name[32];
    (void)state;
    for (int kind = 0; kind <= AMB_TEXTURE_2D_ARRAY; kind++)
        for (int texel = 0; texel <= AMB_TEXEL_LAST; texel++) {
            amb_texture *in = texture_of((amb_texture_kind)kind, (amb_texel)texel, 19, (uint32_t)texel);
            snprintf(name, sizeof name, "%d/%d", kind, texel);
            assert_null(asset_cache_get(&cache, name, "1"));
            asset_cache_put(&cache, name, "1", in);
            amb_texture *out = asset_cache_get(&cache, name, "1");
            assert_non_null(out);
            assert_true(same(in, out));
            amb_texture_close(&in);
            amb_texture_close(&out);
        }
}

static void another_name_identity_or_build_finds_nothing(void **state)
{
    asset_cache cache = open_cache();
    amb_texture *texture = texture_of(AMB_TEXTURE_2D, AMB_TEXEL_R8, 8, 1);
    (void)state;
    asset_cache_put(&cache, "moon", "1", texture);
    assert_null(asset_cache_get(&cache, "moon", "2"));
    assert_null(asset_cache_get(&cache, "moo", "n 1"));
    asset_cache other = cache;
    other.build[0] = other.build[0] == '0' ? '1' : '0';
    assert_null(asset_cache_get(&other, "moon", "1"));
    amb_texture_close(&texture);
}

/* The only entry in the folder. */
static void entry_path(char path[512])
{
    DIR *list = opendir(folder);
    assert_non_null(list);
    path[0] = '\0';
    for (const struct dirent *file = readdir(list); file; file = readdir(list))
        if (file->d_name[0] != '.')
            snprintf(path, 512, "%s/%s", folder, file->d_name);
    closedir(list);
    assert_true(path[0] != '\0');
}

static void damaged_entries_are_passed_over(void **state)
{
    asset_cache cache = open_cache();
    amb_texture *texture = texture_of(AMB_TEXTURE_CUBE, AMB_TEXEL_RGBA16F, 8, 5), *got;
    char path[512];
    static unsigned char bytes[1 << 16];
    (void)state;
    asset_cache_put(&cache, "moon", "1", texture);
    entry_path(path);
    FILE *file = fopen(path, "rb");
    size_t size = fread(bytes, 1, sizeof bytes, file);
    fclose(file);
    assert_true(size > 64 && size < sizeof bytes);
    for (size_t i = 0; i < size + 3; i += i < 64 ? 1 : 61) { /* a bit flipped; at the end: cut, and longer */
        size_t length = i < size ? size : i == size ? size - 1 : i == size + 1 ? 0 : size + 1;
        if (i < size)
            bytes[i] ^= 0x41;
        file = fopen(path, "wb");
        assert_int_equal(fwrite(bytes, 1, length, file), length);
        fclose(file);
        got = asset_cache_get(&cache, "moon", "1");
        if (got) /* padding of the head, or a field that does not change what is stored */
            assert_true(same(got, texture));
        amb_texture_close(&got);
        if (i < size)
            bytes[i] ^= 0x41;
        if (i >= 64 || i < 8)
            assert_null(got);
    }
    for (size_t length = 0; length < size; length += 97) {
        assert_int_equal(truncate(path, 0), 0);
        file = fopen(path, "wb");
        assert_int_equal(fwrite(bytes, 1, length, file), length);
        fclose(file);
        assert_null(asset_cache_get(&cache, "moon", "1"));
    }
    amb_texture_close(&texture);
}

static void entries_used_longest_ago_go_first(void **state)
{
    asset_cache cache = open_cache();
    amb_texture *texture = texture_of(AMB_TEXTURE_2D, AMB_TEXEL_R32F, 64, 2), *got[3];
    (void)state;
    uint64_t bytes = texture->words * sizeof *texture->data;
    cache.most_bytes = 2 * bytes + bytes / 2;
    asset_cache_put(&cache, "a", "", texture);
    usleep(20000);
    asset_cache_put(&cache, "b", "", texture);
    usleep(20000);
    got[0] = asset_cache_get(&cache, "a", ""); /* used: now b is older */
    usleep(20000);
    asset_cache_put(&cache, "c", "", texture);
    amb_texture_close(&got[0]);
    for (int i = 0; i < 3; i++) {
        got[i] = asset_cache_get(&cache, (const char *[]){"a", "b", "c"}[i], "");
        assert_int_equal(got[i] != NULL, i != 1);
        amb_texture_close(&got[i]);
    }
    amb_texture_close(&texture);
}

static void it_can_be_off_and_a_bad_folder_is_no_error(void **state)
{
    asset_cache cache;
    amb_texture *texture = texture_of(AMB_TEXTURE_2D, AMB_TEXEL_R8, 4, 3);
    (void)state;
    setenv("AMBIANCE_CACHE", "off", 1);
    asset_cache_open(&cache, true);
    assert_string_equal(cache.folder, "");
    setenv("AMBIANCE_CACHE", folder, 1);
    asset_cache_open(&cache, false);
    assert_string_equal(cache.folder, "");
    asset_cache_put(&cache, "a", "", texture);
    assert_null(asset_cache_get(&cache, "a", ""));
    setenv("AMBIANCE_CACHE", "/dev/null/x", 1);
    asset_cache_open(&cache, true);
    asset_cache_put(&cache, "a", "", texture);
    assert_null(asset_cache_get(&cache, "a", ""));
    amb_texture_close(&texture);
}

static void what_the_resolver_hands_out_is_the_same_with_and_without_it(void **state)
{
    static const char *const name[] = {"env/studio", "env/studio/irradiance", "uranus/rings"};
    char digest[3][65];
    amb_assets *assets[3];
    amb_context *context;
    (void)state;
    setenv("AMBIANCE_CACHE", folder, 1);
    assert_int_equal(amb_context_create(NULL, &context, NULL), AMB_OK);
    for (int run = 0; run < 3; run++) { /* without; filling it; from it, what is derived first */
        amb_assets_options options = {.builtin_only = true, .keep_made = run > 0};
        assert_int_equal(amb_assets_create(context, &options, &assets[run], NULL), AMB_OK);
        for (int i = 0; i < 3; i++) {
            const amb_texture *texture, *first;
            const char *wanted = name[run == 2 ? 2 - i : i];
            assert_int_equal(amb_assets_texture(assets[run], wanted, &texture, NULL), AMB_OK);
            assert_int_equal(amb_assets_texture(assets[0], wanted, &first, NULL), AMB_OK);
            assert_true(same(texture, first));
        }
        amb_assets_digest(assets[run], digest[run]);
        assert_string_equal(digest[run], digest[0]);
    }
    for (int run = 0; run < 3; run++)
        amb_assets_close(&assets[run]);
    amb_context_close(&context);
    char path[512];
    entry_path(path); /* it was filled */
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(every_kind_and_format_comes_back_bit_for_bit, empty_folder),
        cmocka_unit_test_setup(another_name_identity_or_build_finds_nothing, empty_folder),
        cmocka_unit_test_setup(damaged_entries_are_passed_over, empty_folder),
        cmocka_unit_test_setup(entries_used_longest_ago_go_first, empty_folder),
        cmocka_unit_test_setup(it_can_be_off_and_a_bad_folder_is_no_error, empty_folder),
        cmocka_unit_test_setup(what_the_resolver_hands_out_is_the_same_with_and_without_it, empty_folder),
    };
    snprintf(folder, sizeof folder, "%s/ambiance-test-cache-%ld", getenv("TMPDIR") ? getenv("TMPDIR") : "/tmp",
             (long)getpid());
    int failed = cmocka_run_group_tests(tests, NULL, NULL);
    empty_folder(NULL);
    return failed;
}
