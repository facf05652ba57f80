/* Files that appear whole or not at all, and readers of files cut short at every byte. */
#include "io/file.h"

#include <dirent.h>
#include <errno.h>
#include <fcntl.h>
#include <setjmp.h>
#include <signal.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cmocka.h>

static char folder[] = "/tmp/ambiance-files-XXXXXX";

static const char *in_folder(const char *name)
{
    static char path[4][512];
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

static void must_fail(amb_status status, const amb_error *error, const char *mentions)
{
    if (status != AMB_ERROR_IO || !strstr(error->detail, mentions) || strchr(error->detail, '\n'))
        fail_msg("status %d, expected an input/output error mentioning '%s': %s", status, mentions,
                 status ? error->detail : "(succeeded)");
}

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    assert_non_null(file);
    fputs(text, file);
    assert_int_equal(fclose(file), 0);
}

static void must_hold(const char *path, const char *text)
{
    uint8_t *data;
    size_t bytes;
    amb_error error;
    must(amb_read_file(path, &data, &bytes, &error), &error);
    assert_int_equal(bytes, strlen(text));
    assert_memory_equal(data, text, bytes);
    free(data);
}

/* Files in the folder whose names hold `part` (all but . and .. for ""). */
static int count_files(const char *path, const char *part)
{
    int count = 0;
    DIR *open_folder = opendir(path);
    assert_non_null(open_folder);
    for (struct dirent *entry; (entry = readdir(open_folder));)
        count += strcmp(entry->d_name, ".") != 0 && strcmp(entry->d_name, "..") != 0 && strstr(entry->d_name, part);
    closedir(open_folder);
    return count;
}

static amb_frame *noise_frame(int width, int height, unsigned seed)
{
    amb_frame *frame;
    amb_error error;
    must(amb_frame_create(width, height, &frame, &error), &error);
    for (int c = 0; c < 4; c++)
        for (int y = 0; y < height; y++)
            for (int x = 0; x < width; x++) {
                seed = seed * 1664525u + 1013904223u;
                amb_image_row(frame->layer[0].image, c, y)[x] = (float)(seed >> 8);
            }
    return frame;
}

static void commit_replaces_and_abort_leaves_alone(void **state)
{
    amb_output *output;
    amb_error error;
    (void)state;
    put(in_folder("a"), "old");
    must(amb_output_begin(in_folder("a"), &output, &error), &error);
    must(amb_output_write(output, "ne", 2, &error), &error);
    must_hold(in_folder("a"), "old");
    must(amb_output_write(output, "w", 1, &error), &error);
    must(amb_output_commit(&output, &error), &error);
    assert_null(output);
    must_hold(in_folder("a"), "new");
    must(amb_output_begin(in_folder("a"), &output, &error), &error);
    must(amb_output_write(output, "lost", 4, &error), &error);
    amb_output_abort(&output);
    assert_null(output);
    amb_output_abort(&output);
    must_hold(in_folder("a"), "new");
    assert_int_equal(count_files(folder, ""), 1);
    unlink(in_folder("a"));
}

static void two_writers_of_one_name(void **state)
{
    amb_output *first, *second;
    amb_error error;
    (void)state;
    must(amb_output_begin(in_folder("a"), &first, &error), &error);
    must(amb_output_begin(in_folder("a"), &second, &error), &error);
    must(amb_output_write(first, "first", 5, &error), &error);
    must(amb_output_write(second, "second", 6, &error), &error);
    must(amb_output_commit(&second, &error), &error);
    must_hold(in_folder("a"), "second");
    must(amb_output_commit(&first, &error), &error);
    must_hold(in_folder("a"), "first");
    assert_int_equal(count_files(folder, ""), 1);
    unlink(in_folder("a"));
}

static void links_and_permissions_stay(void **state)
{
    amb_output *output;
    amb_error error;
    struct stat info;
    (void)state;
    put(in_folder("target"), "old");
    assert_int_equal(chmod(in_folder("target"), 0640), 0);
    assert_int_equal(symlink("target", in_folder("link")), 0);
    must(amb_output_begin(in_folder("link"), &output, &error), &error);
    must(amb_output_write(output, "new", 3, &error), &error);
    must(amb_output_commit(&output, &error), &error);
    assert_int_equal(lstat(in_folder("link"), &info), 0);
    assert_true(S_ISLNK(info.st_mode));
    must_hold(in_folder("target"), "new");
    assert_int_equal(stat(in_folder("target"), &info), 0);
    assert_int_equal(info.st_mode & 0777, 0640);
    unlink(in_folder("link"));
    unlink(in_folder("target"));
}

static void places_that_cannot_be_written(void **state)
{
    amb_frame *frame = noise_frame(64, 64, 1);
    const amb_image *image = frame->layer[0].image;
    amb_error error;
    (void)state;
    must_fail(amb_write_exr(frame, in_folder("none/a.exr"), AMB_HALF, &error), &error, "No such file or directory");
    must_fail(amb_write_png(image, in_folder("none/a.png"), &error), &error, "No such file or directory");
    must_fail(amb_write_png(image, folder, &error), &error, "folder");
    must_fail(amb_write_exr(frame, folder, AMB_HALF, &error), &error, "folder");
    must_fail(amb_write_exr(frame, "/dev/full", AMB_HALF, &error), &error, "No space left");
    must_fail(amb_write_png(image, "/dev/full", &error), &error, "No space left");
    assert_int_equal(amb_write_png(image, "", &error), AMB_ERROR_ARGUMENT);
    char name[300];
    memset(name, 'n', sizeof name);
    name[sizeof name - 1] = '\0';
    must_fail(amb_write_png(image, in_folder(name), &error), &error, "File name too long");
    must(amb_write_png(image, "/dev/null", &error), &error); /* devices are written in place, never replaced */
    struct stat info;
    assert_int_equal(stat("/dev/null", &info), 0);
    assert_true(S_ISCHR(info.st_mode));
    assert_int_equal(count_files(folder, ""), 0);
    amb_frame_close(&frame);
}

static void a_folder_that_vanishes(void **state)
{
    amb_output *output;
    amb_error error;
    char moved[64];
    (void)state;
    assert_int_equal(mkdir(in_folder("gone"), 0777), 0);
    must(amb_output_begin(in_folder("gone/a"), &output, &error), &error);
    must(amb_output_write(output, "lost", 4, &error), &error);
    snprintf(moved, sizeof moved, "%s", in_folder("moved"));
    assert_int_equal(rename(in_folder("gone"), moved), 0);
    must_fail(amb_output_commit(&output, &error), &error, "gone/a");
    assert_null(output);
    assert_int_equal(count_files(folder, ""), 1);
    for (DIR *open_folder = opendir(moved); open_folder; closedir(open_folder), open_folder = NULL)
        for (struct dirent *entry; (entry = readdir(open_folder));)
            unlinkat(dirfd(open_folder), entry->d_name, 0);
    assert_int_equal(rmdir(moved), 0);
}

/* In a child whose files may not exceed `limit` bytes: the status of writing a frame, as the exit code. */
static int write_with_limit(const char *path, rlim_t limit, bool is_png)
{
    pid_t child = fork();
    assert_true(child >= 0);
    if (child == 0) {
        amb_frame *frame = noise_frame(256, 256, 3);
        amb_error error;
        signal(SIGXFSZ, SIG_IGN);
        setrlimit(RLIMIT_FSIZE, &(struct rlimit){limit, limit});
        amb_status status =
            is_png ? amb_write_png(frame->layer[0].image, path, &error) : amb_write_exr(frame, path, AMB_FLOAT, &error);
        amb_frame_close(&frame);
        _exit(status == AMB_ERROR_IO && !strstr(error.detail, "File too large") ? 99 : -status);
    }
    int result;
    assert_int_equal(waitpid(child, &result, 0), child);
    assert_true(WIFEXITED(result));
    return WEXITSTATUS(result);
}

/* As a full disk, at every stage: the header, the middle, the last bytes. */
static void a_disk_that_fills_up(void **state)
{
    static const rlim_t limits[] = {0, 1, 100, 400, 5000, 100000, 300000};
    (void)state;
    put(in_folder("kept.exr"), "old");
    for (size_t i = 0; i < sizeof limits / sizeof *limits; i++)
        for (int is_png = 0; is_png < 2; is_png++) {
            if (is_png && limits[i] > 400)
                continue; /* the PNG is smaller: most of its values are clipped to white */
            assert_int_equal(write_with_limit(in_folder("kept.exr"), limits[i], is_png), -AMB_ERROR_IO);
            must_hold(in_folder("kept.exr"), "old");
            assert_int_equal(count_files(folder, ""), 1);
        }
    assert_int_equal(write_with_limit(in_folder("kept.exr"), 1 << 24, false), 0);
    unlink(in_folder("kept.exr"));
}

/* A child writes one file again and again and is killed at some moment: the file is whole, what else is left has the
 * temporary suffix. */
static void kill_in_mid_write(void **state)
{
    amb_error error;
    (void)state;
    amb_frame *first = noise_frame(300, 200, 1), *frame;
    must(amb_write_exr(first, in_folder("a.exr"), AMB_FLOAT, &error), &error);
    amb_frame_close(&first);
    for (int round = 0; round < 12; round++) {
        pid_t child = fork();
        assert_true(child >= 0);
        if (child == 0) {
            amb_frame *again = noise_frame(300, 200, (unsigned)round);
            for (;;)
                if (amb_write_exr(again, in_folder("a.exr"), AMB_FLOAT, &error) != AMB_OK)
                    _exit(1);
        }
        usleep((useconds_t)(20000 + 3700 * round));
        kill(child, SIGKILL);
        int result;
        assert_int_equal(waitpid(child, &result, 0), child);
        assert_true(WIFSIGNALED(result));
        must(amb_read_exr(in_folder("a.exr"), &frame, &error), &error);
        assert_int_equal(frame->width, 300);
        amb_frame_close(&frame);
        assert_int_equal(count_files(folder, "") - 1, count_files(folder, ".ambiance-tmp"));
    }
    for (DIR *open_folder = opendir(folder); open_folder; closedir(open_folder), open_folder = NULL)
        for (struct dirent *entry; (entry = readdir(open_folder));)
            unlinkat(dirfd(open_folder), entry->d_name, 0);
}

/* What a reader makes of the first `bytes` bytes of a sample. */
static amb_status read_part(const char *name, const uint8_t *data, size_t bytes, amb_error *error)
{
    const char *extension = strrchr(name, '.') + 1;
    amb_frame *frame = NULL;
    amb_texture *texture = NULL;
    amb_image *image = NULL;
    amb_mesh *mesh = NULL;
    amb_status status;
    uint8_t *exact = malloc(bytes ? bytes : 1); /* so that a sanitizer sees reads past the end */
    assert_non_null(exact);
    memcpy(exact, data, bytes);
    if (strcmp(extension, "exr") == 0)
        status = amb_read_exr_memory(exact, bytes, name, &frame, error);
    else if (strcmp(extension, "ktx") == 0)
        status = amb_read_ktx_memory(exact, bytes, name, &texture, error);
    else if (strstr("obj ply gltf glb", extension))
        status = amb_read_mesh_memory(exact, bytes, extension, name, &mesh, error);
    else
        status = amb_read_image_memory(exact, bytes, name, &image, NULL, error);
    free(exact);
    if ((status == AMB_OK) != (frame || texture || mesh || image))
        fail_msg("%s: status %d and what was read disagree", name, status);
    amb_frame_close(&frame);
    amb_texture_close(&texture);
    amb_mesh_close(&mesh);
    amb_image_close(&image);
    return status;
}

/* `slack`: bytes at the end that may be missing without harm: a final newline, levels that are not read; text formats
 * have no end mark at all. */
static void files_cut_at_every_byte(void **state)
{
    static const struct {
        const char *path;
        size_t slack;
    } files[] = {{"fuzz_exr/zip_float.exr", 0},     {"fuzz_exr/tiled_none.exr", 0}, {"fuzz_exr/flat_piz.exr", 0},
                 {"fuzz_exr/flat_rle.exr", 0},      {"fuzz_exr/mip_zip.exr", 9999}, {"fuzz_image/rgb3.png", 0},
                 {"fuzz_image/interlaced.png", 0},  {"fuzz_image/palette.png", 0},  {"fuzz_image/deep.png", 0},
                 {"fuzz_image/baseline.jpg", 0},    {"fuzz_image/flat.hdr", 0},     {"fuzz_image/runs.hdr", 0},
                 {"fuzz_image/progressive.jpg", 0}, {"fuzz_ktx/cube.ktx", 0},       {"fuzz_ktx/flat.ktx", 0},
                 {"fuzz_mesh/little.ply", 0},       {"fuzz_mesh/big.ply", 0},       {"fuzz_mesh/ascii.ply", 1},
                 {"fuzz_mesh/embedded.gltf", 0},    {"fuzz_mesh/binary.glb", 0},    {"fuzz_mesh/quad.obj", 9999},
                 {"fuzz_mesh/materials.obj", 9999}};
    (void)state;
    for (size_t i = 0; i < sizeof files / sizeof *files; i++) {
        char path[96];
        uint8_t *data;
        size_t bytes;
        amb_error error;
        snprintf(path, sizeof path, "tests/data/%s", files[i].path);
        must(amb_read_file(path, &data, &bytes, &error), &error);
        must(read_part(path, data, bytes, &error), &error);
        for (size_t cut = 0; cut < bytes; cut++) {
            amb_status status = read_part(path, data, cut, &error);
            if (status == AMB_OK ? cut + files[i].slack < bytes
                                 : (status != AMB_ERROR_FORMAT && status != AMB_ERROR_LIMIT) ||
                                       !strstr(error.detail, path) || strchr(error.detail, '\n'))
                fail_msg("%s cut at byte %zu of %zu: status %d: %s", path, cut, bytes, status,
                         status ? error.detail : "(succeeded)");
        }
        free(data);
    }
}

static int make_folder(void **state)
{
    (void)state;
    return mkdtemp(folder) ? 0 : -1;
}

static int remove_folder(void **state)
{
    (void)state;
    return rmdir(folder);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(commit_replaces_and_abort_leaves_alone),
        cmocka_unit_test(two_writers_of_one_name),
        cmocka_unit_test(links_and_permissions_stay),
        cmocka_unit_test(places_that_cannot_be_written),
        cmocka_unit_test(a_folder_that_vanishes),
        cmocka_unit_test(a_disk_that_fills_up),
        cmocka_unit_test(kill_in_mid_write),
        cmocka_unit_test(files_cut_at_every_byte),
    };
    return cmocka_run_group_tests(tests, make_folder, remove_folder);
}
