/* The asset resolver: which source wins, what is recorded, what a damaged file does; and the pack's fetcher. */
#include <ambiance/assets.h>
#include <ambiance/io.h>

#include "scenes/asset_table.h"

#include <setjmp.h>
#include <sha2.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/ambiance-assets-XXXXXX";
static amb_context *context;

static const char *in_folder(const char *name)
{
    static char path[4][256];
    static int next;
    next = (next + 1) % 4;
    snprintf(path[next], sizeof path[next], "%s/%s", folder, name);
    return path[next];
}

static void must(amb_status status, const amb_error *error)
{
    if (status != AMB_OK)
        fail_msg("%s", error->detail);
}

static int shell(const char *format, ...) __attribute__((format(printf, 1, 2)));
static int shell(const char *format, ...)
{
    char command[2048];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(command, sizeof command, format, arguments);
    va_end(arguments);
    return system(command);
}

static void copy(const char *from, const char *to)
{
    assert_int_equal(shell("mkdir -p $(dirname '%s') && cp '%s' '%s'", in_folder(to), from, in_folder(to)), 0);
}

/* A constant panorama; its shape is wrong when `height` is not half the width. */
static void put_panorama(const char *name, int width, int height)
{
    amb_frame *frame;
    amb_error error;
    assert_int_equal(shell("mkdir -p $(dirname '%s')", in_folder(name)), 0);
    must(amb_frame_create(width, height, &frame, &error), &error);
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++)
                amb_image_row(frame->layer[0].image, c, y)[x] = 1.0f;
    must(amb_write_exr(frame, in_folder(name), AMB_HALF, &error), &error);
    amb_frame_close(&frame);
}

static amb_assets *open_assets(void)
{
    char user[256], pack[256];
    amb_assets *assets;
    amb_error error;
    snprintf(user, sizeof user, "%s", in_folder("user"));
    snprintf(pack, sizeof pack, "%s", in_folder("pack"));
    must(amb_assets_create(context, &(amb_assets_options){.user_dir = user, .pack_dir = pack}, &assets, &error),
         &error);
    return assets;
}

static amb_asset_info find(const amb_assets *assets, const char *name)
{
    amb_asset_info info;
    for (int i = 0; i < amb_assets_count(assets); i++) {
        amb_assets_describe(assets, i, &info);
        if (strcmp(info.name, name) == 0)
            return info;
    }
    fail_msg("no asset %s", name);
    return info;
}

static int start(void **state)
{
    (void)state;
    return shell("rm -rf %s && mkdir -p %s/user %s/pack", folder, folder, folder);
}

static void the_users_file_wins_then_the_pack_then_ours(void **state)
{
    amb_assets *assets = open_assets();
    (void)state;
    assert_int_equal(find(assets, "env/studio").source, AMB_ASSET_BUILTIN);
    assert_string_equal(find(assets, "env/studio").path, "");
    amb_assets_close(&assets);
    copy("tests/data/fuzz_ktx/cube.ktx", "pack/env/studio.ktx");
    assets = open_assets();
    assert_int_equal(find(assets, "env/studio").source, AMB_ASSET_PACK);
    assert_int_equal(find(assets, "env/studio/irradiance").source, AMB_ASSET_PACK);
    assert_int_equal(find(assets, "env/outdoor").source, AMB_ASSET_BUILTIN);
    amb_assets_close(&assets);
    put_panorama("user/env/studio.exr", 64, 32);
    assets = open_assets();
    assert_int_equal(find(assets, "env/studio").source, AMB_ASSET_USER);
    assert_string_equal(find(assets, "env/studio").path, in_folder("user/env/studio.exr"));
    assert_string_equal(find(assets, "env/studio/irradiance").path, in_folder("user/env/studio.exr"));

    const amb_texture *cube, *again, *irradiance;
    amb_error error;
    must(amb_assets_texture(assets, "env/studio", &cube, &error), &error);
    must(amb_assets_texture(assets, "env/studio", &again, &error), &error);
    must(amb_assets_texture(assets, "env/studio/irradiance", &irradiance, &error), &error);
    assert_ptr_equal(cube, again);
    assert_int_equal(amb_texture_describe(cube).kind, AMB_TEXTURE_CUBE);
    assert_int_equal(amb_texture_describe(cube).width, 16);
    assert_int_equal(amb_texture_describe(irradiance).kind, AMB_TEXTURE_CUBE);
    assert_int_equal(amb_texture_describe(irradiance).width, 32);
    amb_assets_close(&assets);

    amb_assets_options only = {.user_dir = folder, .builtin_only = true};
    must(amb_assets_create(context, &only, &assets, &error), &error);
    for (int i = 0; i < amb_assets_count(assets); i++) {
        amb_asset_info info;
        amb_assets_describe(assets, i, &info);
        assert_int_equal(info.source, AMB_ASSET_BUILTIN);
    }
    amb_assets_close(&assets);
}

static void folders_from_the_environment(void **state)
{
    amb_assets *assets;
    amb_error error;
    (void)state;
    put_panorama("data/ambiance/env/outdoor.exr", 64, 32);
    put_panorama("named/env/studio.exr", 64, 32);
    copy("tests/data/fuzz_image/rgb3.png", "data/ambiance-pack/mercury/color.jpg");
    setenv("XDG_DATA_HOME", in_folder("data"), 1);
    unsetenv("AMBIANCE_ASSETS");
    unsetenv("AMBIANCE_PACK");
    must(amb_assets_create(context, NULL, &assets, &error), &error);
    assert_string_equal(find(assets, "env/outdoor").path, in_folder("data/ambiance/env/outdoor.exr"));
    assert_string_equal(find(assets, "mercury/color").path, in_folder("data/ambiance-pack/mercury/color.jpg"));
    amb_assets_close(&assets);
    setenv("AMBIANCE_ASSETS", in_folder("named"), 1);
    setenv("AMBIANCE_PACK", in_folder("pack"), 1);
    must(amb_assets_create(context, NULL, &assets, &error), &error);
    assert_int_equal(find(assets, "env/outdoor").source, AMB_ASSET_BUILTIN);
    assert_int_equal(find(assets, "mercury/color").source, AMB_ASSET_BUILTIN);
    assert_int_equal(find(assets, "env/studio").source, AMB_ASSET_USER);
    amb_assets_close(&assets);
    setenv("AMBIANCE_ASSETS", in_folder("nowhere"), 1);
    assert_int_equal(amb_assets_create(context, NULL, &assets, &error), AMB_ERROR_IO);
    assert_null(assets);
    assert_non_null(strstr(error.detail, "nowhere"));
    setenv("AMBIANCE_ASSETS", "", 1); /* as if unset */
    must(amb_assets_create(context, NULL, &assets, &error), &error);
    assert_int_equal(find(assets, "env/outdoor").source, AMB_ASSET_USER);
    amb_assets_close(&assets);
    unsetenv("AMBIANCE_ASSETS");
    unsetenv("AMBIANCE_PACK");
    unsetenv("XDG_DATA_HOME");
}

static void a_damaged_file_is_an_error_and_never_skipped(void **state)
{
    static const char *const kinds[] = {"user", "pack"};
    (void)state;
    for (size_t i = 0; i < 2; i++) {
        char name[64];
        const amb_texture *texture;
        amb_error error;
        snprintf(name, sizeof name, "%s/env/studio.ktx", kinds[i]);
        copy("Makefile", name);
        amb_assets *assets = open_assets();
        assert_int_equal(amb_assets_texture(assets, "env/studio", &texture, &error), AMB_ERROR_FORMAT);
        assert_null(texture);
        assert_non_null(strstr(error.detail, in_folder(name)));
        assert_int_equal(amb_assets_texture(assets, "env/studio/irradiance", &texture, &error), AMB_ERROR_FORMAT);
        assert_string_equal(find(assets, "env/studio").sha256, "");
        amb_assets_close(&assets);
        start(NULL);
    }
    const amb_texture *texture;
    amb_error error;
    put_panorama("user/env/studio.exr", 48, 32);
    amb_assets *assets = open_assets();
    assert_int_equal(amb_assets_texture(assets, "env/studio", &texture, &error), AMB_ERROR_FORMAT);
    assert_non_null(strstr(error.detail, "48x32"));
    amb_assets_close(&assets);
}

static void names_that_are_not_there(void **state)
{
    amb_assets *assets = open_assets();
    const amb_texture *texture;
    const amb_mesh *mesh;
    amb_error error;
    (void)state;
    assert_int_equal(amb_assets_texture(assets, "env/outdor", &texture, &error), AMB_ERROR_NOT_FOUND);
    assert_non_null(strstr(error.detail, "env/outdoor"));
    assert_int_equal(amb_assets_texture(assets, NULL, &texture, &error), AMB_ERROR_NOT_FOUND);
    assert_int_equal(amb_assets_mesh(assets, "env/outdoor", &mesh, &error), AMB_ERROR_NOT_FOUND);
    assert_int_equal(amb_assets_texture(assets, "lucy/mesh", &texture, &error), AMB_ERROR_NOT_FOUND);
    char digest[65];
    amb_assets_digest(assets, digest);
    assert_string_equal(digest, "");
    amb_assets_close(&assets);
}

static void meshes_without_normals_get_them(void **state)
{
    const amb_mesh *mesh;
    amb_error error;
    (void)state;
    copy("tests/data/fuzz_mesh/ascii.ply", "user/lucy/lucy100k.ply");
    amb_assets *assets = open_assets();
    must(amb_assets_mesh(assets, "lucy/mesh", &mesh, &error), &error);
    assert_int_equal(mesh->triangle_count, 3);
    assert_non_null(mesh->normal);
    amb_assets_close(&assets);
}

/* SHA-256 over "name source sha256\n", sorted by name, of what was handed out; the order of loading does not matter. */
static void the_digest_is_what_the_header_says(void **state)
{
    static const char *const names[] = {"mercury/color", "env/studio/irradiance", "stars"};
    char digest[65], expected[65], text[512], file_hash[65], builtin_hash[65];
    const amb_texture *texture;
    amb_error error;
    (void)state;
    copy("tests/data/fuzz_ktx/cube.ktx", "pack/env/studio.ktx");
    copy("tests/data/fuzz_image/rgb3.png", "user/mercury/color.png");
    copy("tests/data/fuzz_image/rgb1.png", "user/stars.png");
    for (int round = 0; round < 3; round++) {
        amb_assets *assets = open_assets();
        for (int i = 0; i < 3; i++)
            must(amb_assets_texture(assets, names[(i + round) % 3], &texture, &error), &error);
        amb_assets_digest(assets, digest);
        size_t used = 0;
        static const struct {
            const char *name, *source, *path;
        } lines[] = {{"env/studio/irradiance", "pack", "tests/data/fuzz_ktx/cube.ktx"},
                     {"mercury/color", "user", "tests/data/fuzz_image/rgb3.png"},
                     {"stars", "user", "tests/data/fuzz_image/rgb1.png"}};
        for (int i = 0; i < 3; i++) {
            assert_non_null(SHA256File(lines[i].path, file_hash));
            assert_string_equal(find(assets, lines[i].name).sha256, file_hash);
            used += (size_t)snprintf(text + used, sizeof text - used, "%s %s %s\n", lines[i].name, lines[i].source,
                                     file_hash);
        }
        SHA256Data((const uint8_t *)text, used, expected);
        assert_string_equal(digest, expected);
        amb_assets_close(&assets);
    }
    amb_assets *assets = open_assets();
    must(amb_assets_texture(assets, "env/outdoor", &texture, &error), &error);
    SHA256Data((const uint8_t *)"builtin:env/outdoor:1", 21, builtin_hash);
    assert_string_equal(find(assets, "env/outdoor").sha256, builtin_hash);
    amb_assets_close(&assets);
}

/* Every file of the pack is some asset's, and every asset that hopes for one has one. */
static void the_pack_list_and_the_table_agree(void **state)
{
    (void)state;
    assert_int_equal(shell("awk '$1 == \"file\" { print $2 }' scenes/pack/list | while read -r f; do"
                           " mkdir -p \"$(dirname %s/pack/$f)\" && touch %s/pack/$f; done",
                           folder, folder),
                     0);
    amb_assets *assets = open_assets();
    for (int i = 0; i < amb_assets_count(assets); i++) {
        amb_asset_info info;
        amb_assets_describe(assets, i, &info);
        if (asset_table[i].pack_file && info.source != AMB_ASSET_PACK)
            fail_msg("%s: %s is not in scenes/pack/list", info.name, asset_table[i].pack_file);
    }
    for (int i = 0; i < amb_assets_count(assets); i++)
        if (asset_table[i].pack_file)
            assert_int_equal(shell("rm -f %s/pack/%s", folder, asset_table[i].pack_file), 0);
    amb_assets_close(&assets);
    assert_int_equal(shell("test -z \"$(find %s/pack -type f)\"", folder), 0);
}

/* The fetcher against a package made here, served as file://. */
static void the_fetcher_keeps_checked_files_only(void **state)
{
    (void)state;
    if (shell("command -v curl dpkg-deb > /dev/null 2>&1") != 0)
        skip();
    assert_int_equal(
        shell(
            "cd %s && mkdir -p deb/DEBIAN deb/usr/share/t/deep && echo good > deb/usr/share/t/deep/a.txt &&"
            " printf 'Package: ambiance-no-such\\nVersion: 1\\nArchitecture: all\\nMaintainer: t\\nDescription: t\\n'"
            " > deb/DEBIAN/control && dpkg-deb -b deb pool.deb > log 2>&1 &&"
            " echo \"package ambiance-no-such 1 1000 pool.deb\nfile x/b.txt $(sha256sum < deb/usr/share/t/deep/a.txt |"
            " cut -d ' ' -f 1) */t/deep/a.txt\ncredit Someone, CC0\" > list",
            folder),
        0);
    const char *run =
        "AMBIANCE_PACK_LIST=%s/list AMBIANCE_PACK_MIRROR=file://%s scenes/pack/fetch.sh %s/got > %s/out 2>&1";
    assert_int_equal(shell(run, folder, folder, folder, folder), 0);
    assert_int_equal(
        shell("test \"$(cat %s/got/x/b.txt)\" = good && grep -q 'Someone, CC0' %s/got/ATTRIBUTION.txt", folder, folder),
        0);
    assert_int_equal(shell(run, folder, folder, folder, folder), 0);
    assert_int_equal(shell("grep -q complete %s/out", folder), 0);
    /* Damaged on disk: fetched again. */
    assert_int_equal(shell("echo bad > %s/got/x/b.txt", folder), 0);
    assert_int_equal(shell(run, folder, folder, folder, folder), 0);
    assert_int_equal(shell("test \"$(cat %s/got/x/b.txt)\" = good", folder), 0);
    /* Another sum than pinned, then no package at all: success, one warning line, nothing kept. */
    for (int round = 0; round < 2; round++) {
        assert_int_equal(
            shell(round ? "rm %s/pool.deb" : "sed -i 's/^\\(file [^ ]*\\) .... /\\1 /;s/b.txt ./b.txt f/' %s/list",
                  folder),
            0);
        assert_int_equal(shell("rm -rf %s/got", folder), 0);
        assert_int_equal(shell(run, folder, folder, folder, folder), 0);
        assert_int_equal(shell("test $(grep -c ^warning: %s/out) = 1 && test ! -e %s/got/x/b.txt", folder, folder), 0);
    }
}

/* An npm tarball from a registry, without npm; and a package that is fetched only when asked for. */
static void the_fetcher_takes_tarballs_and_options(void **state)
{
    (void)state;
    if (shell("command -v curl > /dev/null 2>&1") != 0)
        skip();
    assert_int_equal(
        shell("cd %s && rm -rf package got got.part && mkdir -p package/img && echo day > package/img/day.txt &&"
              " tar -czf one.tgz package && echo night > package/img/day.txt && tar -czf two.tgz package &&"
              " { echo 'package one 1 1000 one.tgz'; echo \"file x/day.txt $(echo day | sha256sum | cut -d ' ' -f 1)"
              " */img/day.txt\"; echo 'credit Someone, MIT';"
              " echo 'package two 1 1000 two.tgz optional'; echo \"file x/night.txt $(echo night | sha256sum |"
              " cut -d ' ' -f 1) */img/day.txt\"; echo 'credit Another, CC0'; } > list",
              folder),
        0);
    const char *run =
        "%s AMBIANCE_PACK_LIST=%s/list AMBIANCE_PACK_NPM=file://%s scenes/pack/fetch.sh %s/got > %s/out 2>&1";
    assert_int_equal(shell(run, "AMBIANCE_PACK_OPTIONAL=", folder, folder, folder, folder), 0);
    assert_int_equal(shell("test \"$(cat %s/got/x/day.txt)\" = day && test ! -e %s/got/x/night.txt &&"
                           " ! grep -q Another %s/got/ATTRIBUTION.txt",
                           folder, folder, folder),
                     0);
    assert_int_equal(shell(run, "AMBIANCE_PACK_OPTIONAL=1", folder, folder, folder, folder), 0);
    assert_int_equal(
        shell("test \"$(cat %s/got/x/night.txt)\" = night && grep -q Another %s/got/ATTRIBUTION.txt", folder, folder),
        0);
}

/* Key frames follow whatever still map there is, and say so; a file of one's own goes before. */
static void maps_made_from_maps(void **state)
{
    amb_error error;
    const amb_texture *map;
    char text[192], still[65], expected[65];
    (void)state;
    copy("tests/data/fuzz_image/rgb3.png", "user/jupiter/color.png");
    copy("tests/data/fuzz_image/rgb1.png", "user/jupiter/color2.png");
    amb_assets *assets = open_assets();
    assert_int_equal(find(assets, "jupiter/color1").source, AMB_ASSET_USER);
    must(amb_assets_texture(assets, "jupiter/color1", &map, &error), &error);
    assert_non_null(SHA256File("tests/data/fuzz_image/rgb3.png", still));
    assert_string_equal(find(assets, "jupiter/color").sha256, still);
    snprintf(text, sizeof text, "jupiter/color1:3 of %s", still);
    SHA256Data((const uint8_t *)text, strlen(text), expected);
    assert_string_equal(find(assets, "jupiter/color1").sha256, expected);
    must(amb_assets_texture(assets, "jupiter/color2", &map, &error), &error);
    assert_non_null(SHA256File("tests/data/fuzz_image/rgb1.png", still));
    assert_string_equal(find(assets, "jupiter/color2").sha256, still);
    /* Mars's height is our own as long as its colour is. */
    assert_int_equal(find(assets, "mars/height").source, AMB_ASSET_BUILTIN);
    amb_assets_close(&assets);
    copy("tests/data/fuzz_image/rgb3.png", "user/mars/color.png");
    assets = open_assets();
    assert_int_equal(find(assets, "mars/height").source, AMB_ASSET_USER);
    amb_assets_close(&assets);
}

static int open_all(void **state)
{
    (void)state;
    amb_error error;
    return mkdtemp(folder) && amb_context_create(NULL, &context, &error) == AMB_OK ? 0 : -1;
}

static int close_all(void **state)
{
    (void)state;
    amb_context_close(&context);
    return shell("rm -rf %s", folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test_setup(the_users_file_wins_then_the_pack_then_ours, start),
        cmocka_unit_test_setup(folders_from_the_environment, start),
        cmocka_unit_test_setup(a_damaged_file_is_an_error_and_never_skipped, start),
        cmocka_unit_test_setup(names_that_are_not_there, start),
        cmocka_unit_test_setup(meshes_without_normals_get_them, start),
        cmocka_unit_test_setup(the_digest_is_what_the_header_says, start),
        cmocka_unit_test_setup(the_pack_list_and_the_table_agree, start),
        cmocka_unit_test_setup(the_fetcher_keeps_checked_files_only, start),
        cmocka_unit_test_setup(the_fetcher_takes_tarballs_and_options, start),
        cmocka_unit_test_setup(maps_made_from_maps, start),
    };
    return cmocka_run_group_tests(tests, open_all, close_all);
}
