/* Parameter tables: scenes and post passes describe their parameters once; the command line, listings, JSON and
 * viewers are all made from the table. */
#ifndef AMBIANCE_PARAM_H
#define AMBIANCE_PARAM_H

#include <ambiance/error.h>
#include <stddef.h>

typedef enum amb_param_type {
    AMB_PARAM_FLOAT,  /* float */
    AMB_PARAM_INT,    /* int */
    AMB_PARAM_BOOL,   /* int, 0 or 1; written true/false, on/off, 1/0 */
    AMB_PARAM_VEC3,   /* v3; written x,y,z */
    AMB_PARAM_COLOR,  /* v3, linear; written r,g,b */
    AMB_PARAM_CHOICE, /* int: index into `choices` */
} amb_param_type;

typedef struct amb_param {
    const char *name;
    amb_param_type type;
    const char *unit;           /* "" when it has none */
    float minimum, maximum;     /* inclusive; each component; unused by BOOL and CHOICE */
    float fallback[3];          /* the default */
    const char *const *choices; /* NULL-ended; CHOICE only */
    size_t offset;              /* of the field in the owner's parameter struct */
    const char *doc;            /* one line */
} amb_param;

typedef struct amb_params { /* a table and the struct it describes */
    const amb_param *table;
    size_t count;
    size_t size; /* bytes of the struct */
} amb_params;

/* Writes every default into `values` (params->size bytes, zeroed first). */
void amb_params_defaults(const amb_params *params, void *values);
/* Sets one from text. NOT_FOUND names the parameter and lists (or suggests) known ones; ARGUMENT names value and range.
 * On error nothing changes. `owner` ("scene julia") starts the error line. */
amb_status amb_params_set(const amb_params *params, void *values, const char *owner, const char *name, const char *text,
                          amb_error *error);
/* The value as text that amb_params_set reads back to the same bits. Returns the length as snprintf does. */
int amb_params_print(const amb_param *param, const void *values, char *text, size_t size);

#endif
