/* When memory runs out: every allocation of a texture and of a pass fails in turn. Each time the call must say so,
 * leave nothing behind, and leave what it was given usable. */
#include "raster/internal.h"
#include "tests/raster_shaders.h"
#include "tests/stage_shaders.h"

#include <setjmp.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

/* ---- an allocator that fails --------------------------------------------------------------------------------------
 * Sanitizers bring their own; there only the success is tested. */

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define OWN_ALLOCATOR 0
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
#define OWN_ALLOCATOR 0
#endif
#endif
#ifndef OWN_ALLOCATOR
#define OWN_ALLOCATOR 1
#endif

static bool armed;
static long allowed; /* allocations before one fails, while armed */
static long live;    /* blocks in use, counted while armed */

static bool fails(void)
{
    if (!armed)
        return false;
    if (allowed-- == 0)
        return true;
    live++;
    return false;
}

#if OWN_ALLOCATOR
void *__libc_malloc(size_t);
void *__libc_calloc(size_t, size_t);
void *__libc_realloc(void *, size_t);
void *__libc_memalign(size_t, size_t);
void __libc_free(void *);

void *malloc(size_t bytes) { return fails() ? NULL : __libc_malloc(bytes); }
void *calloc(size_t count, size_t bytes) { return fails() ? NULL : __libc_calloc(count, bytes); }
void *aligned_alloc(size_t alignment, size_t bytes) { return fails() ? NULL : __libc_memalign(alignment, bytes); }
void *realloc(void *old, size_t bytes)
{
    if (fails())
        return NULL;
    live -= armed && old;
    return __libc_realloc(old, bytes);
}
void free(void *block)
{
    live -= armed && block;
    __libc_free(block);
}
#endif

/* ---- what is tried ------------------------------------------------------------------------------------------------
 */

typedef struct tried {
    amb_context *context;
    amb_image *image;
    amb_texture *texture;
    const raster_test_vertex *vertex;
    int samples, threads;
} tried;

enum { SIDE = 70, TRIANGLES = 4500 }; /* two chunks: with batches of one, samples wait between batches */

static amb_status try_pass(const tried *t, amb_error *error)
{
    const raster_test_shaders *shaders = raster_test_shaders_of(amb_context_isa(t->context));
    raster_test_uniforms u = {.vertex = t->vertex};
    amb_target target = {.color = {t->image}, .color_texture = {{0}, {t->texture, 0, 0}}, .samples = t->samples};
    amb_draw d = {.lanes = shaders->lanes,
                  .vertex = shaders->vertex,
                  .fragment = shaders->value,
                  .uniforms = &u,
                  .uniforms_size = sizeof u,
                  .varying_floats = 4,
                  .count = TRIANGLES * 3};
    amb_pass *pass = NULL;
    amb_status status = raster_pass_begin(t->context, &target, 16, 0, &pass, error);
    for (int i = 0; i < 20 && status == AMB_OK; i++, d.count = 3) /* more records than are kept at first */
        status = amb_pass_draw(pass, &d, error);
    if (status == AMB_OK)
        status = amb_pass_finish(&pass, NULL, error);
    amb_pass_close(&pass);
    return status;
}

/* Patches, cut finely enough for two chunks, with a geometry shader behind. */
static amb_status try_patches(const tried *t, amb_error *error)
{
    static const v4 corner[4] = {{-1, -1, 0.5f, 1}, {1, -1, 0.5f, 1}, {1, 1, 0.5f, 1}, {-1, 1, 0.5f, 1}};
    static const float factor[2 * 6] = {3, 4, 5, 6, 7, 8, 64, 64, 64, 64, 64, 64};
    static const uint32_t index[8] = {0, 1, 2, 3, 0, 1, 2, 3};
    const stage_test_shaders *s = stage_test_shaders_of(amb_context_isa(t->context));
    const stage_test_uniforms u = {.clip = corner, .corners = 4, .factor = factor};
    amb_target target = {.color = {t->image}, .samples = t->samples};
    amb_draw d = {.lanes = s->lanes,
                  .fragment = s->shade,
                  .uniforms = &u,
                  .uniforms_size = sizeof u,
                  .varying_floats = 4,
                  .indices = index,
                  .count = 8,
                  .vertex_count = 4,
                  .topology = AMB_PATCHES};
    d.tessellation = (amb_tessellation){.hull = s->hull, .domain = s->quad, .corners = 4, .patch_floats = 16};
    amb_pass *pass = NULL;
    amb_status status = raster_pass_begin(t->context, &target, 16, 0, &pass, error);
    if (status == AMB_OK)
        status = amb_pass_draw(pass, &d, error);
    d.geometry = (amb_geometry){.shader = s->same, .vertices = 3};
    if (status == AMB_OK)
        status = amb_pass_draw(pass, &d, error);
    if (status == AMB_OK)
        status = amb_pass_finish(&pass, NULL, error);
    amb_pass_close(&pass);
    return status;
}

static amb_status try_texture(const tried *t, amb_error *error)
{
    amb_texture *made = NULL;
    amb_image *copy = NULL;
    amb_status status = amb_texture_from_image(t->image, AMB_TEXEL_SRGB8_A8, true, &made, error);
    if (status == AMB_OK)
        status = amb_texture_make_mips(made, error);
    if (status == AMB_OK)
        status = amb_texture_to_image(made, 1, 0, &copy, error);
    assert_true((status == AMB_OK) == (copy != NULL));
    amb_image_close(&copy);
    amb_texture_close(&made);
    return status;
}

/* An attempt with a context of its own, which keeps memory from pass to pass until it is closed. */
static amb_status try_in_context(const tried *t, amb_status (*attempt)(const tried *, amb_error *), amb_error *error)
{
    const amb_context_options options = {.threads = 1};
    amb_context *context = NULL;
    amb_status status = amb_context_create(&options, &context, error);
    tried in_context = *t;
    in_context.context = context;
    if (status == AMB_OK)
        status = attempt(&in_context, error);
    amb_context_close(&context);
    return status;
}

/* Lets the first, the second, … allocation fail until none does. */
static void fail_in_turn(const tried *t, amb_status (*attempt)(const tried *, amb_error *))
{
    amb_error error;
    assert_int_equal(try_in_context(t, attempt, &error), AMB_OK); /* also wakes what libraries keep for good */
    for (long n = 0; OWN_ALLOCATOR; n++) {
        memset(&error, 0, sizeof error);
        allowed = n, live = 0, armed = true;
        amb_status status = try_in_context(t, attempt, &error);
        armed = false;
        assert_int_equal(live, 0);
        if (status == AMB_OK) {
            assert_true(n > 5 && allowed >= 0);
            print_message("%ld allocations, each missed once\n", n);
            break;
        }
        assert_int_equal(status, AMB_ERROR_MEMORY);
        assert_int_equal(error.status, AMB_ERROR_MEMORY);
        assert_non_null(strstr(error.detail, "memory"));
    }
    assert_int_equal(try_in_context(t, attempt, &error), AMB_OK);
}

static void memory_may_run_out_anywhere(void **state)
{
    (void)state;
    tried t = {0};
    raster_test_vertex *vertex = calloc(TRIANGLES * 3, sizeof *vertex);
    uint32_t random = 1;
    for (int i = 0; i < TRIANGLES * 3; i++) {
        float at[2];
        for (int k = 0; k < 2; k++) {
            random = random * 1664525u + 1013904223u;
            at[k] = (float)(random >> 8) / 8388608.0f - 1.0f;
        }
        const v4 *first = &vertex[i - i % 3].clip; /* small triangles, some of them clipped */
        vertex[i].clip = i % 3 ? (v4){first->x + at[0] * 0.1f, first->y + at[1] * 0.1f, i % 7 ? 0.5f : -0.5f, 1}
                               : (v4){at[0], at[1], 0.5f, 1};
    }
    t.vertex = vertex;
    amb_texture_desc desc = {.texel = AMB_TEXEL_SRGB8_A8, .width = SIDE, .height = SIDE};
    assert_int_equal(amb_image_create(SIDE, SIDE, 4, &t.image, NULL), AMB_OK);
    assert_int_equal(amb_texture_create(&desc, &t.texture, NULL), AMB_OK);
    fail_in_turn(&t, try_texture);
    for (t.samples = 1; t.samples <= 4; t.samples *= 4)
        fail_in_turn(&t, try_pass);
    t.samples = 1;
    fail_in_turn(&t, try_patches);
    amb_texture_close(&t.texture);
    amb_image_close(&t.image);
    free(vertex);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(memory_may_run_out_anywhere),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
