#!/bin/sh
# Installs into a temporary place, builds the README's shader against it for every instruction set and both ways of
# linking, and holds the outputs to be the same bytes. Then uninstalls and looks for leftovers.
# Environment: CC, MAKE, BUILD. Run from the top of the source.
set -eu
: "${CC:=cc}" "${MAKE:=make}" "${BUILD:=build}"
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
fail() { echo "test-install: $*" >&2; exit 1; }

if [ -f README.md ] && grep -q 'lantern_fragment' README.md; then
    awk '/^```c$/ { block = ""; inside = 1; next } /^```$/ { if (inside && block ~ /lantern_fragment/) printf "%s", block; inside = 0 }
         inside { block = block $0 "\n" }' README.md | cmp - tests/install/lantern.c ||
        fail "the shader in README.md is not tests/install/lantern.c"
fi

$MAKE --no-print-directory -s CC="$CC" BUILD="$BUILD" PREFIX="$place/usr" install >/dev/null
export PKG_CONFIG_PATH="$place/usr/lib/pkgconfig" LD_LIBRARY_PATH="$place/usr/lib"
[ "$(pkg-config --modversion ambiance)" = "$("$place/usr/bin/ambiance" --version | cut -d' ' -f2)" ] ||
    fail "pkg-config and the program disagree on the version"

# Every installed header compiles alone, as a user would include it.
(cd "$place/usr/include" && find ambiance -name '*.h') | while read -r header; do
    echo "#include <$header>" | $CC -std=c17 -Wall -Wextra -Werror $(pkg-config --cflags ambiance) -fsyntax-only -xc - ||
        fail "$header does not compile alone"
done

variants="4:"
[ "$(uname -m)" = x86_64 ] && variants="4:-march=x86-64-v2 8:-march=x86-64-v3 16:-march=x86-64-v4"
for variant in $variants; do
    lanes=${variant%%:*} march=${variant#*:}
    for linking in shared static; do
        folder=$place/$linking$lanes
        mkdir "$folder"
        if [ $linking = shared ]; then libs=$(pkg-config --libs ambiance); else
            libs="$place/usr/lib/libambiance.a $(pkg-config --static --libs ambiance | sed 's/-lambiance//')"
        fi
        $CC -std=c17 -O2 -Wall -Wextra -Werror $march -DAMB_LANES="$lanes" tests/install/lantern.c \
            $(pkg-config --cflags ambiance) $libs -o "$folder/lantern" || fail "$linking, $lanes lanes: does not build"
        if message=$(cd "$folder" && ./lantern 2>&1); then
            [ -s "$folder/lantern.exr" ] && [ -s "$folder/lantern.png" ] || fail "$linking, $lanes lanes: no picture"
            cmp "$folder/lantern.exr" "$place/shared4/lantern.exr"
            cmp "$folder/lantern.png" "$place/shared4/lantern.png"
            echo "  $linking, $lanes lanes: same bytes"
        else
            case $message in
            *"this processor has"*) echo "  $linking, $lanes lanes: built; $message" ;;
            *) fail "$linking, $lanes lanes: $message" ;;
            esac
        fi
    done
done
"$place/usr/bin/ambiance" info "$place/shared4/lantern.exr" | grep -q '640x480' || fail "the installed program reads no EXR"
if command -v man >/dev/null && command -v groff >/dev/null; then
    [ -z "$(man --warnings -l "$place/usr/share/man/man1/ambiance.1" 2>&1 >/dev/null)" ] || fail "the man page has warnings"
fi

# Completion: of a command, an option, a value, and of names that the program lists.
completes() { # expected word, then the words of the line, the last one being completed
    expected=$1
    shift
    PATH="$place/usr/bin:$PATH" bash -c '. "$0"; compopt() { :; }
        COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)); _ambiance; printf "%s\n" "${COMPREPLY[@]}"' \
        "$place/usr/share/bash-completion/completions/ambiance" "$@" | grep -qxF -- "$expected" ||
        fail "completion: '$*' does not offer '$expected'"
}
if command -v bash >/dev/null; then
    completes render ambiance re
    completes --tolerance ambiance compare --to
    completes v3 ambiance render --isa v
    completes bloom ambiance render x --post bl
    completes display ambiance list --post dis
    completes lucy ambiance render lu
    completes material= ambiance render lucy --set mat
fi

$MAKE --no-print-directory -s CC="$CC" BUILD="$BUILD" PREFIX="$place/usr" uninstall >/dev/null
left=$(find "$place/usr" -type f -o -type l)
[ -z "$left" ] || fail "uninstall left: $left"

# Staging: DESTDIR is where files go, PREFIX is what they say.
$MAKE --no-print-directory -s CC="$CC" BUILD="$BUILD" PREFIX=/usr DESTDIR="$place/stage" install >/dev/null
grep -qx 'prefix=/usr' "$place/stage/usr/lib/pkgconfig/ambiance.pc" || fail "DESTDIR leaked into ambiance.pc"
echo "test-install: passed"
