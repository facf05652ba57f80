#!/bin/sh
# Rules that the build itself must keep: who may include whom (ARCHITECTURE.md), and what may not be in the library's
# objects. Usage: tests/build_rules.sh BUILD_DIR [LIBRARY.a]
build=${1:?build directory}
library=${2:-$build/libambiance.a}
failed=0
complain() { echo "build rules: $*" >&2; failed=1; }

# ---- include rule: folder, then the folders it may include from ----
while read -r folder allowed; do
    [ -d "$folder" ] || continue
    pattern=$(echo "$folder $allowed" | tr ' ' '|')
    found=$(grep -rnE '^#include "' --include='*.c' --include='*.h' --include='*.inc' "$folder" |
        grep -vE "#include \"($pattern)/" | grep -E '#include "[^"]*/')
    [ -z "$found" ] || complain "$folder/ may include only its own files and: ${allowed:-nothing else}
$found"
done <<RULES
core
shade core
raster core
march core
post core shade
io core
scenes core shade raster march post io
cli core shade raster march post io scenes
RULES
for header in include/ambiance/*.h; do
    found=$(grep -nE '^#include "' "$header")
    [ -z "$found" ] || complain "$header: public headers include only <ambiance/...>: $found"
    echo "#include <ambiance/$(basename "$header")>" |
        ${CC:-cc} -std=c17 -Iinclude -D_GNU_SOURCE -fsyntax-only -xc - || complain "$header does not compile alone"
done

# ---- the library neither prints nor exits, and calls no libm transcendental ----
symbols=$(nm -u "$library" 2>/dev/null | awk '{print $NF}' | sort -u)
[ -n "$symbols" ] || complain "no symbols in $library: is it built?"
for banned in printf puts putchar vprintf perror exit _exit abort quick_exit rand random time clock_gettime gettimeofday \
    sin sinf cos cosf tan tanf sincosf asin asinf acos acosf atan atanf atan2 atan2f exp expf exp2 exp2f log logf log2 \
    log2f log10f pow powf cbrt cbrtf fma fmaf; do
    ! echo "$symbols" | grep -qx "$banned" || complain "$library calls $banned"
done

# ---- no contraction and no approximate reciprocals anywhere in it ----
if command -v objdump >/dev/null; then
    approximate=$(objdump -d --no-show-raw-insn "$library" |
        grep -oE '\bv?(fn?m(add|sub)[0-9a-z]*|fmaddsub[0-9a-z]*|fmsubadd[0-9a-z]*|rcp(14|28)?[ps]s|rsqrt(14|28)?[ps]s)\b' | sort | uniq -c)
    [ -z "$approximate" ] || complain "fused or approximate instructions in $library:
$approximate"
fi

[ $failed = 0 ] && echo "build rules: kept"
exit $failed
