/* The chain: reads its text, and applies passes in order, fusing streaming passes into one sweep over memory. */
#include "post/scratch.h"

#include "core/names.h"

#include <omp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct link {
    const amb_post_pass *pass;
    void *params; /* pass->params.size bytes */
} link;

typedef struct idle { /* scratches no frame is using */
    amb_scratch *scratch[16];
    int count;
} idle;

struct amb_chain {
    const amb_context *context;
    link link[AMB_MAX_CHAIN];
    int count;
    idle *idle; /* guarded by lock; apart, so that applying leaves the chain const */
    omp_lock_t *lock;
};

/* ---- text ------------------------------------------------------------------------------------------------------- */

static char *trim(char *text)
{
    text += strspn(text, " \t\n");
    size_t length = strlen(text);
    while (length && strchr(" \t\n", text[length - 1]))
        text[--length] = '\0';
    return text;
}

static const char *pass_name(const void *isa, int index)
{
    return amb_post_by_index(*(const amb_isa *)isa, index)->name;
}

static amb_status unknown_pass(amb_isa isa, const char *name, amb_error *error)
{
    char hint[320];
    return amb_fail(error, AMB_ERROR_NOT_FOUND, "unknown post pass: %.64s; %s", name,
                    amb_names_hint(name, amb_post_count(), pass_name, &isa, hint, sizeof hint));
}

/* Cuts the next "name=value" off *rest: up to the comma before the next name, so that x,y,z stays together. */
static char *next_setting(char **rest)
{
    char *start = *rest;
    if (!start)
        return NULL;
    char *end = strchr(start, ',');
    while (end) {
        size_t piece = strcspn(end + 1, ",=");
        if (end[1 + piece] == '=' || end[1 + strspn(end + 1, " \t\n")] == '\0')
            break;
        end = strchr(end + 1, ',');
    }
    if (end)
        *end++ = '\0';
    *rest = end;
    return trim(start);
}

static amb_status read_settings(const link *made, char *text, amb_error *error)
{
    char owner[80];
    snprintf(owner, sizeof owner, "post pass %s", made->pass->name);
    for (char *setting; (setting = next_setting(&text));) {
        char *equals = strchr(setting, '=');
        if (!equals || equals == setting)
            return amb_fail(error, AMB_ERROR_ARGUMENT, "%s: '%.80s' is not name=value", owner, setting);
        *equals = '\0';
        amb_status status =
            amb_params_set(&made->pass->params, made->params, owner, trim(setting), trim(equals + 1), error);
        if (status != AMB_OK)
            return status;
    }
    return AMB_OK;
}

/* "name" or "name:settings" */
static amb_status read_pass(amb_chain *chain, char *text, amb_error *error)
{
    char *colon = strchr(text, ':');
    if (colon)
        *colon = '\0';
    char *name = trim(text);
    if (!*name)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "post chain: pass %d has no name", chain->count + 1);
    if (chain->count == AMB_MAX_CHAIN)
        return amb_fail(error, AMB_ERROR_LIMIT, "post chain: at most %d passes", AMB_MAX_CHAIN);
    amb_isa isa = amb_context_isa(chain->context);
    link made = {.pass = amb_post_by_name(isa, name)};
    if (!made.pass)
        return unknown_pass(isa, name, error);
    made.params = malloc(made.pass->params.size ? made.pass->params.size : 1);
    if (!made.params)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a post chain");
    amb_params_defaults(&made.pass->params, made.params);
    chain->link[chain->count++] = made;
    return colon ? read_settings(&made, colon + 1, error) : AMB_OK;
}

static amb_status read_chain(amb_chain *chain, char *text, amb_error *error)
{
    text = trim(text);
    if (!*text || strcmp(text, "none") == 0)
        return AMB_OK;
    while (text) {
        char *end = text + strcspn(text, ";");
        char *rest = *end ? end + 1 : NULL;
        *end = '\0';
        amb_status status = read_pass(chain, text, error);
        if (status != AMB_OK)
            return status;
        if (rest && !*trim(rest))
            break; /* a ';' at the very end is harmless */
        text = rest;
    }
    return AMB_OK;
}

amb_status amb_chain_create(const amb_context *context, const char *text, amb_chain **out, amb_error *error)
{
    *out = NULL;
    amb_status status = AMB_OK;
    amb_chain *chain = calloc(1, sizeof *chain);
    char *copy = NULL;
    if (!chain)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a post chain");
    chain->context = context;
    chain->idle = calloc(1, sizeof *chain->idle);
    copy = strdup(text ? text : "");
    chain->lock = malloc(sizeof *chain->lock);
    if (chain->lock)
        omp_init_lock(chain->lock);
    if (!chain->idle || !copy || !chain->lock) {
        status = amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a post chain");
        goto done;
    }
    status = read_chain(chain, copy, error);
done:
    free(copy);
    if (status != AMB_OK)
        amb_chain_close(&chain);
    *out = chain;
    return status;
}

void amb_chain_close(amb_chain **chain)
{
    if (!chain || !*chain)
        return;
    for (int i = 0; i < (*chain)->count; i++)
        free((*chain)->link[i].params);
    for (int i = 0; (*chain)->idle && i < (*chain)->idle->count; i++)
        amb_scratch_close((*chain)->idle->scratch[i]);
    free((*chain)->idle);
    if ((*chain)->lock)
        omp_destroy_lock((*chain)->lock);
    free((*chain)->lock);
    free(*chain);
    *chain = NULL;
}

/* snprintf at the end of text[0…length), never past size. */
static int append(char *text, size_t size, int length, const char *first, const char *second, const char *third)
{
    size_t used = (size_t)length < size ? (size_t)length : size;
    return length + snprintf(used < size ? text + used : NULL, size - used, "%s%s%s", first, second, third);
}

int amb_chain_print(const amb_chain *chain, char *text, size_t size)
{
    int length = 0;
    if (size)
        text[0] = '\0';
    for (int i = 0; i < chain->count; i++) {
        const link *l = &chain->link[i];
        length = append(text, size, length, i ? ";" : "", l->pass->name, "");
        for (size_t p = 0; p < l->pass->params.count; p++) {
            char value[128];
            amb_params_print(&l->pass->params.table[p], l->params, value, sizeof value);
            length = append(text, size, length, p ? "," : ":", l->pass->params.table[p].name, "=");
            length = append(text, size, length, value, "", "");
        }
    }
    return length;
}

/* ---- sweeps ----------------------------------------------------------------------------------------------------- */

typedef struct stage { /* a streaming pass at work on a frame */
    const amb_post_pass *pass;
    amb_post_job job;
    void *state;
} stage;

typedef struct sweep { /* streaming passes waiting to be played, then perhaps one that collects */
    stage stage[AMB_MAX_CHAIN];
    int count;
    const stage *collector; /* or NULL */
    const amb_image *color;
} sweep;

/* One band of rows: every waiting pass on each piece of a row while it is in the first-level cache, then the collector
 * while the band is in the second. */
static void play_band(void *user, int band, int thread)
{
    const sweep *s = user;
    const amb_image *color = s->color;
    int y0 = band * AMB_POST_BAND;
    int y1 = y0 + AMB_POST_BAND < color->height ? y0 + AMB_POST_BAND : color->height;
    int columns = (int)color->stride;
    for (int y = y0; y < y1 && s->count; y++)
        for (int x = 0; x < columns; x += AMB_POST_SPAN) {
            amb_post_span span = {.x = x, .y = y, .count = columns - x < AMB_POST_SPAN ? columns - x : AMB_POST_SPAN};
            for (int c = 0; c < 3; c++)
                span.rgb[c] = amb_image_row(color, c, y) + x;
            for (int i = 0; i < s->count; i++)
                s->stage[i].pass->span(&s->stage[i].job, s->stage[i].state, &span);
        }
    if (s->collector)
        s->collector->pass->collect(&s->collector->job, s->collector->state, y0, y1, thread);
}

static void play(const amb_context *context, sweep *s)
{
    if (s->count || s->collector)
        amb_parallel_for(context, (s->color->height + AMB_POST_BAND - 1) / AMB_POST_BAND, play_band, s);
    s->count = 0;
    s->collector = NULL;
}

static amb_status begin_stage(sweep *s, const stage *next, amb_error *error)
{
    bool collects = false;
    if (next->pass->begin) {
        amb_status status = next->pass->begin(&next->job, next->state, &collects, error);
        if (status != AMB_OK)
            return status;
    }
    if (collects) {
        s->collector = next;
        play(next->job.context, s);
        if (next->pass->finish)
            next->pass->finish(&next->job, next->state);
    }
    s->stage[s->count++] = *next;
    return AMB_OK;
}

static amb_status apply_links(const amb_chain *chain, const amb_post_job *common, amb_error *error)
{
    sweep s = {.color = common->color};
    for (int i = 0; i < chain->count; i++) {
        stage next = {.pass = chain->link[i].pass, .job = *common};
        next.job.params = chain->link[i].params;
        amb_status status;
        if (next.pass->apply) {
            play(chain->context, &s);
            status = next.pass->apply(&next.job, error);
        } else {
            next.state = amb_scratch_take(common->scratch, 1, next.pass->state_size);
            if (!next.state)
                return amb_fail(error, AMB_ERROR_MEMORY, "post pass %s: out of memory", next.pass->name);
            memset(next.state, 0, next.pass->state_size);
            status = begin_stage(&s, &next, error);
        }
        if (status != AMB_OK)
            return status;
    }
    play(chain->context, &s);
    return AMB_OK;
}

/* ---- frames ----------------------------------------------------------------------------------------------------- */

static amb_scratch *borrow(const amb_chain *chain)
{
    omp_set_lock(chain->lock);
    amb_scratch *scratch = chain->idle->count ? chain->idle->scratch[--chain->idle->count] : NULL;
    omp_unset_lock(chain->lock);
    return scratch ? scratch : amb_scratch_create();
}

static void give_back(const amb_chain *chain, amb_scratch *scratch)
{
    amb_scratch_reset(scratch);
    omp_set_lock(chain->lock);
    bool room = chain->idle->count < (int)(sizeof chain->idle->scratch / sizeof chain->idle->scratch[0]);
    if (room)
        chain->idle->scratch[chain->idle->count++] = scratch;
    omp_unset_lock(chain->lock);
    if (!room)
        amb_scratch_close(scratch);
}

amb_status amb_chain_apply(const amb_chain *chain, amb_frame *frame, long frame_index, int intermediates,
                           amb_error *error)
{
    if (chain->count == 0)
        return AMB_OK;
    amb_image *color = amb_frame_layer(frame, "color");
    if (!color)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "post chain: the frame has no layer 'color'");
    if (color->channels < 3)
        return amb_fail(error, AMB_ERROR_ARGUMENT, "post chain: layer 'color' has %d channels, allowed are 3 and 4",
                        color->channels);
    amb_scratch *scratch = borrow(chain);
    if (!scratch)
        return amb_fail(error, AMB_ERROR_MEMORY, "out of memory for a post chain");
    amb_post_job job = {.context = chain->context,
                        .frame = frame,
                        .frame_index = frame_index,
                        .intermediates = intermediates,
                        .color = color,
                        .scratch = scratch};
    amb_status status = apply_links(chain, &job, error);
    give_back(chain, scratch);
    return status;
}
