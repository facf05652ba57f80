#include <ambiance/param.h>
#include <ambiance/vec.h>

#include "core/names.h"

#include <locale.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int components(const amb_param *param)
{
    return param->type == AMB_PARAM_VEC3 || param->type == AMB_PARAM_COLOR ? 3 : 1;
}

static bool is_integer(const amb_param *param)
{
    return param->type == AMB_PARAM_INT || param->type == AMB_PARAM_BOOL || param->type == AMB_PARAM_CHOICE;
}

static void store(const amb_param *param, void *values, const float number[3])
{
    char *field = (char *)values + param->offset;
    if (is_integer(param)) {
        int whole = (int)number[0];
        memcpy(field, &whole, sizeof whole);
    } else {
        memcpy(field, number, (size_t)components(param) * sizeof(float));
    }
}

void amb_params_defaults(const amb_params *params, void *values)
{
    memset(values, 0, params->size);
    for (size_t i = 0; i < params->count; i++)
        store(&params->table[i], values, params->table[i].fallback);
}

/* A finite number that ends at *end; the decimal point is a point in every locale. */
static bool read_number(const char *text, const char **end, float *number)
{
    locale_t c_locale = newlocale(LC_ALL_MASK, "C", (locale_t)0);
    if (!c_locale)
        return false;
    char *stop;
    *number = strtof_l(text, &stop, c_locale);
    freelocale(c_locale);
    *end = stop;
    return stop != text && isfinite(*number);
}

static bool read_bool(const char *text, float *number)
{
    static const char *const words[2][4] = {{"false", "off", "no", "0"}, {"true", "on", "yes", "1"}};
    for (int value = 0; value < 2; value++)
        for (int i = 0; i < 4; i++)
            if (strcmp(text, words[value][i]) == 0) {
                *number = (float)value;
                return true;
            }
    return false;
}

static bool read_choice(const amb_param *param, const char *text, float *number)
{
    for (int i = 0; param->choices[i]; i++)
        if (strcmp(text, param->choices[i]) == 0) {
            *number = (float)i;
            return true;
        }
    return false;
}

static bool read_numbers(const amb_param *param, const char *text, float number[3])
{
    int count = components(param);
    for (int i = 0; i < count; i++) {
        if (!read_number(text, &text, &number[i]))
            return false;
        if (!(number[i] >= param->minimum && number[i] <= param->maximum))
            return false;
        if (is_integer(param) && number[i] != truncf(number[i]))
            return false;
        if (*text != (i + 1 < count ? ',' : '\0'))
            return false;
        text++;
    }
    return true;
}

/* "a number from 0 to 1", "one of a, b, c", … for error lines. */
static void describe_allowed(const amb_param *param, char *text, size_t size)
{
    if (param->type == AMB_PARAM_BOOL) {
        snprintf(text, size, "true or false");
    } else if (param->type == AMB_PARAM_CHOICE) {
        size_t length = (size_t)snprintf(text, size, "one of");
        for (int i = 0; param->choices[i] && length < size; i++)
            length += (size_t)snprintf(text + length, size - length, "%s %s", i ? "," : "", param->choices[i]);
    } else {
        snprintf(text, size, "%s from %.9g to %.9g",
                 components(param) == 3         ? "three numbers x,y,z each"
                 : param->type == AMB_PARAM_INT ? "a whole number"
                                                : "a number",
                 (double)param->minimum, (double)param->maximum);
    }
}

static const char *param_name(const void *user, int index) { return ((const amb_params *)user)->table[index].name; }

static amb_status unknown(const amb_params *params, const char *owner, const char *name, amb_error *error)
{
    int nearest = amb_nearest_name(name, (int)params->count, param_name, params);
    if (nearest >= 0)
        return amb_fail(error, AMB_ERROR_NOT_FOUND, "%s has no parameter '%s'; did you mean '%s'?", owner, name,
                        params->table[nearest].name);
    char known[320] = "none";
    size_t length = 0;
    for (size_t i = 0; i < params->count && length < sizeof known; i++)
        length += (size_t)snprintf(known + length, sizeof known - length, "%s%s", i ? ", " : "", params->table[i].name);
    return amb_fail(error, AMB_ERROR_NOT_FOUND, "%s has no parameter '%s'; it has: %s", owner, name, known);
}

amb_status amb_params_set(const amb_params *params, void *values, const char *owner, const char *name, const char *text,
                          amb_error *error)
{
    for (size_t i = 0; i < params->count; i++) {
        const amb_param *param = &params->table[i];
        if (strcmp(param->name, name) != 0)
            continue;
        float number[3] = {0, 0, 0};
        bool good = param->type == AMB_PARAM_BOOL     ? read_bool(text, number)
                    : param->type == AMB_PARAM_CHOICE ? read_choice(param, text, number)
                                                      : read_numbers(param, text, number);
        if (!good) {
            char allowed[256];
            describe_allowed(param, allowed, sizeof allowed);
            return amb_fail(error, AMB_ERROR_ARGUMENT, "%s, parameter %s: '%.80s' is not %s%s%s", owner, name, text,
                            allowed, param->unit[0] ? " " : "", param->unit);
        }
        store(param, values, number);
        return AMB_OK;
    }
    return unknown(params, owner, name, error);
}

/* The shortest decimal that reads back as the same float. */
static int print_number(float number, char *text, size_t size)
{
    char digits[32];
    for (int precision = 1; precision <= 9; precision++) {
        const char *end;
        float back;
        snprintf(digits, sizeof digits, "%.*g", precision, (double)number);
        for (char *c = digits; *c; c++)
            if (*c == ',') /* a host program's locale */
                *c = '.';
        if (read_number(digits, &end, &back) && memcmp(&back, &number, sizeof back) == 0)
            break;
    }
    return snprintf(text, size, "%s", digits);
}

int amb_params_print(const amb_param *param, const void *values, char *text, size_t size)
{
    const char *field = (const char *)values + param->offset;
    if (is_integer(param)) {
        int whole;
        memcpy(&whole, field, sizeof whole);
        if (param->type == AMB_PARAM_BOOL)
            return snprintf(text, size, "%s", whole ? "true" : "false");
        if (param->type == AMB_PARAM_CHOICE)
            return snprintf(text, size, "%s", param->choices[whole]);
        return snprintf(text, size, "%d", whole);
    }
    int length = 0;
    for (int i = 0; i < components(param); i++) {
        float number;
        char digits[40];
        memcpy(&number, field + (size_t)i * sizeof number, sizeof number);
        print_number(number, digits, sizeof digits);
        bool has_room = (size_t)length < size;
        length += snprintf(has_room ? text + length : NULL, has_room ? size - (size_t)length : 0, "%s%s", i ? "," : "",
                           digits);
    }
    return length;
}
