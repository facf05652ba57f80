/* Made assets kept on disk, so that a map is painted once and not once a run.
 *
 * An entry is named by a hash over this library's build (the linker's build ID, so a changed generator or layout never
 * meets an old entry), the asset's name and its identity. It appears whole or not at all, is checked against its CRC
 * when read, and is passed over when anything about it is wrong. The entries used last are kept, up to
 * 2 GiB of them. Several processes may share a folder; one cache serves one thread at a time. */
#ifndef AMBIANCE_SCENES_ASSET_CACHE_H
#define AMBIANCE_SCENES_ASSET_CACHE_H

#include <ambiance/texture.h>

typedef struct asset_cache {
    char folder[1024]; /* "": off */
    char build[65];
    uint64_t most_bytes; /* of all entries together */
} asset_cache;

/* Off when asked == false, when $AMBIANCE_CACHE is "off", when no folder is known, or when the program that holds the
 * library has no build ID. Folder: $AMBIANCE_CACHE, $XDG_CACHE_HOME/ambiance, ~/.cache/ambiance; made when first
 * written to. */
void asset_cache_open(asset_cache *cache, bool asked);
/* NULL when there is no such entry. `identity` tells versions and sources of one name apart. */
amb_texture *asset_cache_get(const asset_cache *cache, const char *name, const char *identity);
/* Failure leaves no entry, and is no error: the asset is there already. */
void asset_cache_put(const asset_cache *cache, const char *name, const char *identity, const amb_texture *texture);

#endif
