/* Textures painted for the workloads: the same bytes go to us and to the peer. */
#ifndef AMB_BENCH_PAINT_H
#define AMB_BENCH_PAINT_H

#include <ambiance/texture.h>

/* A chain of square levels down to one texel, packed as amb_texture_desc wants it. */
typedef struct paint_chain {
    int size; /* of level 0; a power of two */
    amb_texture_kind kind;
    amb_texel texel; /* RGBA8 or RGBA16F */
    void *data;
    size_t texel_bytes;
} paint_chain;

/* Rust-coloured blotches with holes in their alpha, and the normals of the same bumps; RGBA8, box-filtered. */
amb_status paint_surface(int size, paint_chain *color, paint_chain *normal, amb_error *error);
/* A sky cube with a soft bright window and noise clouds, halves; every level is painted anew, not filtered. */
amb_status paint_sky(int size, paint_chain *sky, amb_error *error);
amb_status paint_texture(const paint_chain *chain, amb_texture **out, amb_error *error);
void paint_close(paint_chain *chain);

#endif
