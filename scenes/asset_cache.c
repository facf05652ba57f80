#include "scenes/asset_cache.h"

#include "core/texture_layout.h"

#include <ambiance/io.h>
#include <dirent.h>
#include <elf.h>
#include <fcntl.h>
#include <link.h>
#include <sha2.h>
#include <stdio.h>
#include <stdlib.h>
#include <sys/stat.h>
#include <unistd.h>
#include <zlib.h>

#define SUFFIX ".texture"

typedef struct entry_head {
    char magic[8];
    amb_texture_info info;
    uint32_t crc; /* of the texels */
    uint64_t words;
} entry_head;
static const char magic[8] = "AMBTEX1";

/* ---- which build ------------------------------------------------------------------------------------------------ */

typedef struct build_search {
    uintptr_t inside; /* an address of the object that is looked for */
    char *hex;        /* 65 chars */
} build_search;

/* The note of the linker's build ID in one segment, as hexadecimal digits. */
static void read_notes(const char *at, const char *end, char hex[65])
{
    while ((size_t)(end - at) >= sizeof(ElfW(Nhdr))) {
        ElfW(Nhdr) note;
        memcpy(&note, at, sizeof note);
        const char *owner = at + sizeof note, *data = owner + ((note.n_namesz + 3u) & ~3u);
        const char *next = data + ((note.n_descsz + 3u) & ~3u);
        if (next > end || next <= at)
            return;
        if (note.n_type == NT_GNU_BUILD_ID && note.n_namesz == 4 && memcmp(owner, "GNU", 4) == 0) {
            for (size_t i = 0; i < note.n_descsz && i < 32; i++)
                snprintf(hex + 2 * i, 3, "%02x", (unsigned char)data[i]);
            return;
        }
        at = next;
    }
}

static int visit_object(struct dl_phdr_info *object, size_t size, void *user)
{
    (void)size;
    const build_search *search = user;
    bool is_ours = false;
    for (int i = 0; i < object->dlpi_phnum; i++) {
        const ElfW(Phdr) *segment = &object->dlpi_phdr[i];
        is_ours |=
            segment->p_type == PT_LOAD && search->inside - (object->dlpi_addr + segment->p_vaddr) < segment->p_memsz;
    }
    for (int i = 0; i < object->dlpi_phnum && is_ours; i++) {
        const ElfW(Phdr) *segment = &object->dlpi_phdr[i];
        const char *start = (const char *)(uintptr_t)(object->dlpi_addr + segment->p_vaddr); /* NOLINT: an address */
        if (segment->p_type == PT_NOTE && search->hex[0] == '\0')
            read_notes(start, start + segment->p_memsz, search->hex);
    }
    return is_ours;
}

/* ---- where ------------------------------------------------------------------------------------------------------ */

static const char *variable(const char *name)
{
    const char *value = getenv(name);
    return value && *value ? value : NULL;
}

void asset_cache_open(asset_cache *cache, bool asked)
{
    const char *own = variable("AMBIANCE_CACHE"), *xdg = variable("XDG_CACHE_HOME"), *home = variable("HOME");
    int length = 0;
    *cache = (asset_cache){.most_bytes = (uint64_t)2 << 30};
    if (!asked || (own && strcmp(own, "off") == 0))
        return;
    build_search search = {(uintptr_t)&asset_cache_open, cache->build};
    dl_iterate_phdr(visit_object, &search);
    if (cache->build[0] == '\0')
        return;
    if (own)
        length = snprintf(cache->folder, sizeof cache->folder, "%s", own);
    else if (xdg)
        length = snprintf(cache->folder, sizeof cache->folder, "%s/ambiance", xdg);
    else if (home)
        length = snprintf(cache->folder, sizeof cache->folder, "%s/.cache/ambiance", home);
    if (length <= 0 || length > (int)sizeof cache->folder - 100) /* an entry's name still has to fit */
        cache->folder[0] = '\0';
}

static void entry_path(const asset_cache *cache, const char *name, const char *identity, char path[1024])
{
    char text[512], key[65];
    int length = snprintf(text, sizeof text, "%s %s %s", cache->build, name, identity);
    SHA256Data((const uint8_t *)text, (size_t)length, key);
    snprintf(path, 1024, "%.900s/%s" SUFFIX, cache->folder, key);
}

/* The folder and those above it, for this user alone. */
static bool make_folder(const char *folder)
{
    char path[1024];
    snprintf(path, sizeof path, "%s", folder);
    for (char *slash = strchr(path + 1, '/'); slash; slash = strchr(slash + 1, '/')) {
        *slash = '\0';
        mkdir(path, 0700);
        *slash = '/';
    }
    mkdir(path, 0700);
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

/* ---- entries ---------------------------------------------------------------------------------------------------- */

static uint32_t checksum(const uint32_t *words, size_t count)
{
    return (uint32_t)crc32_z(0, (const unsigned char *)words, count * sizeof *words);
}

static amb_texture *read_entry(FILE *file)
{
    entry_head head;
    amb_texture *texture = NULL;
    if (fread(&head, sizeof head, 1, file) != 1 || memcmp(head.magic, magic, sizeof magic) != 0)
        return NULL;
    const amb_texture_desc desc = {.kind = head.info.kind,
                                   .texel = head.info.texel,
                                   .width = head.info.width,
                                   .height = head.info.height,
                                   .depth = head.info.depth,
                                   .levels = head.info.levels};
    if (amb_texture_create(&desc, &texture, NULL) != AMB_OK)
        return NULL;
    if (texture->words == head.words &&
        fread(texture->data, sizeof(uint32_t), texture->words, file) == texture->words && fgetc(file) == EOF &&
        checksum(texture->data, texture->words) == head.crc)
        return texture;
    amb_texture_close(&texture);
    return NULL;
}

amb_texture *asset_cache_get(const asset_cache *cache, const char *name, const char *identity)
{
    char path[1024];
    if (!cache->folder[0])
        return NULL;
    entry_path(cache, name, identity, path);
    FILE *file = fopen(path, "rbe");
    if (!file)
        return NULL;
    amb_texture *texture = read_entry(file);
    fclose(file);
    if (texture)
        utimensat(AT_FDCWD, path, NULL, 0); /* used now: among the last to go */
    return texture;
}

/* ---- what is kept ----------------------------------------------------------------------------------------------- */

typedef struct kept {
    struct timespec used;
    uint64_t bytes;
    char path[1024];
} kept;

static int newest_first(const void *a, const void *b)
{
    const kept *left = a, *right = b;
    if (left->used.tv_sec != right->used.tv_sec)
        return left->used.tv_sec > right->used.tv_sec ? -1 : 1;
    return left->used.tv_nsec > right->used.tv_nsec ? -1 : left->used.tv_nsec < right->used.tv_nsec;
}

static bool is_entry(const char *name)
{
    size_t length = strlen(name), suffix = sizeof SUFFIX - 1;
    return length == 64 + suffix && strcmp(name + 64, SUFFIX) == 0;
}

/* Removes the entries used longest ago until the rest is small enough. */
static void prune(const asset_cache *cache)
{
    size_t count = 0, room = 0;
    kept *list = NULL;
    uint64_t bytes = 0;
    DIR *folder = opendir(cache->folder);
    for (const struct dirent *file = folder ? readdir(folder) : NULL; file; file = readdir(folder)) {
        struct stat info;
        if (!is_entry(file->d_name))
            continue;
        if (count == room) {
            kept *grown = realloc(list, (room = 2 * room + 64) * sizeof *list);
            if (!grown)
                break;
            list = grown;
        }
        snprintf(list[count].path, sizeof list->path, "%.900s/%.100s", cache->folder, file->d_name);
        if (stat(list[count].path, &info) != 0)
            continue;
        list[count].used = info.st_mtim;
        list[count++].bytes = (uint64_t)info.st_size;
    }
    if (folder)
        closedir(folder);
    if (count > 0)
        qsort(list, count, sizeof *list, newest_first);
    for (size_t i = 0; i < count; i++) {
        bytes += list[i].bytes;
        if (bytes > cache->most_bytes)
            unlink(list[i].path);
    }
    free(list);
}

void asset_cache_put(const asset_cache *cache, const char *name, const char *identity, const amb_texture *texture)
{
    char path[1024];
    amb_output *output;
    if (!cache->folder[0] || !make_folder(cache->folder))
        return;
    entry_path(cache, name, identity, path);
    entry_head head;
    memset(&head, 0, sizeof head); /* the padding too */
    memcpy(head.magic, magic, sizeof magic);
    head.info = texture->info;
    head.crc = checksum(texture->data, texture->words);
    head.words = texture->words;
    if (amb_output_begin(path, &output, NULL) != AMB_OK)
        return;
    if (amb_output_write(output, &head, sizeof head, NULL) == AMB_OK &&
        amb_output_write(output, texture->data, texture->words * sizeof *texture->data, NULL) == AMB_OK)
        amb_output_commit(&output, NULL);
    amb_output_abort(&output);
    prune(cache);
}
