#!/bin/sh
# Fetches the asset pack: fetch.sh FOLDER. Reads the list beside it (or $AMBIANCE_PACK_LIST), downloads only packages
# whose files are not all there, keeps only the listed files, checks every SHA-256, writes FOLDER/ATTRIBUTION.txt.
# Packages marked optional are fetched when $AMBIANCE_PACK_OPTIONAL is 1. Debian packages come from apt or the mirror
# ($AMBIANCE_PACK_MIRROR), npm packages from the registry ($AMBIANCE_PACK_NPM); neither npm nor root is needed.
# Downloads go to FOLDER.part and stay there when a run is cut short: the next run goes on. A file appears in FOLDER
# whole or not at all. When something cannot be had: one warning line and success, since every asset is also built in.
set -eu

folder=${1:?usage: fetch.sh FOLDER}
list=${AMBIANCE_PACK_LIST:-$(dirname "$0")/list}
mirror=${AMBIANCE_PACK_MIRROR:-http://deb.debian.org/debian}
registry=${AMBIANCE_PACK_NPM:-https://registry.npmjs.org}
work=$folder.part

give_up() {
    echo "warning: asset pack: $1; built-in assets stand in for what is missing (make assets tries again)" >&2
    write_credits
    exit 0
}

packages() { awk '$1 == "package" { print $2 }' "$list"; }
# field PACKAGE N: the N-th word of its package line
field() { awk -v name="$1" -v n="$2" '$1 == "package" && $2 == name { print $n }' "$list"; }
# files PACKAGE: its "TARGET SHA-256 PATH [zip]" lines
files() { awk -v name="$1" '$1 == "package" { here = $2 == name } here && $1 == "file" { print $2, $3, $4, $5 }' "$list"; }
credits() { awk -v name="$1" '$1 == "package" { here = $2 == name } here && $1 == "credit" { $1 = ""; print }' "$list"; }

is_whole() { # FILE SHA-256
    [ -f "$1" ] && [ "$(sha256sum < "$1" | cut -d ' ' -f 1)" = "$2" ]
}

is_complete() { # PACKAGE
    files "$1" | while read -r target sha path how; do
        is_whole "$folder/$target" "$sha" || exit 1
    done
}

write_credits() {
    [ -d "$folder" ] || return 0
    {
        echo "The files of this folder, and who made them:"
        for package in $(packages); do
            is_complete "$package" || continue
            echo
            files "$package" | while read -r target sha path how; do echo "$target"; done
            credits "$package"
        done
    } > "$folder/.ATTRIBUTION.part"
    mv "$folder/.ATTRIBUTION.part" "$folder/ATTRIBUTION.txt"
}

# get URL FILE: goes on with what $FILE.part holds
get() {
    if command -v curl > /dev/null; then
        bar=-s
        [ ! -t 2 ] || bar=-#
        curl -fL $bar -C - --connect-timeout 20 --retry 1 -o "$2.part" "$1" && mv "$2.part" "$2"
    else
        command -v wget > /dev/null || return 1
        wget -q -c -T 20 -t 2 -O "$2.part" "$1" && mv "$2.part" "$2"
    fi
}

apt_download() { # PACKAGE
    command -v apt-get > /dev/null || return 1
    quiet=-qq
    [ ! -t 1 ] || quiet=
    sandbox=
    [ "$(id -u)" != 0 ] || sandbox="-o APT::Sandbox::User=root"
    # shellcheck disable=SC2086
    (cd "$work" && apt-get $quiet $sandbox -o Acquire::Retries=1 -o Acquire::http::Timeout=20 download "$1") \
        2> "$work/log" || return 1
    for deb in "$work/$1"_*.deb; do
        mv "$deb" "$work/$1.package" && return 0
    done
}

# A Debian package of the system's own lists, or else the pinned file from the mirror; an npm package's pinned file from
# the registry. Leaves $work/PACKAGE.package.
download() { # PACKAGE
    [ ! -f "$work/$1.package" ] || return 0
    case $(field "$1" 5) in
    *.tgz) get "$registry/$(field "$1" 5)" "$work/$1.package" ;;
    *) apt_download "$1" || get "$mirror/$(field "$1" 5)" "$work/$1.package" ;;
    esac
}

# unpack PACKAGE FOLDER: the listed files of it
unpack() {
    files "$1" | cut -d ' ' -f 3 > "$work/patterns"
    case $(field "$1" 5) in
    *.tgz) tar -xz -C "$2" --wildcards -T "$work/patterns" -f "$work/$1.package" 2> "$work/log" ;;
    *) dpkg-deb --fsys-tarfile "$work/$1.package" 2> "$work/log" |
        tar -x -C "$2" --wildcards -T "$work/patterns" 2>> "$work/log" ;;
    esac
}

# Unpacks the listed files and moves each into place once its sum is right.
keep() { # PACKAGE
    rm -rf "$work/out"
    mkdir -p "$work/out"
    unpack "$1" "$work/out" || return 1
    files "$1" | while read -r target sha path how; do
        found=$(find "$work/out" -type f -path "$path" | head -n 1)
        if [ "$how" = zip ] && exrmaketiled -o -z zip "$found" "$work/packed.exr" 2>> "$work/log"; then
            found=$work/packed.exr
        fi
        is_whole "${found:-/nonexistent}" "$sha" || exit 1
        mkdir -p "$(dirname "$folder/$target")"
        mv "$found" "$folder/$target"
    done
}

bytes=0
wanted=
for package in $(packages); do
    [ "$(field "$package" 6)" != optional ] || [ "${AMBIANCE_PACK_OPTIONAL:-}" = 1 ] || continue
    is_complete "$package" && continue
    wanted="$wanted $package"
    bytes=$((bytes + $(field "$package" 4)))
done
if [ -z "$wanted" ]; then
    echo "asset pack: complete in $folder"
    exit 0
fi

# shellcheck disable=SC2086
set -- $wanted
echo "asset pack: fetching $((bytes / 1000000)) MB in $# package(s) to $folder (ASSETS=builtin does without)"
mkdir -p "$folder" "$work" 2> /dev/null || give_up "cannot write to $folder"
number=0
for package in "$@"; do
    number=$((number + 1))
    echo "asset pack: $number of $#: $package, $(($(field "$package" 4) / 1000000)) MB"
    download "$package" || give_up "cannot download $package"
    keep "$package" || {
        rm -rf "$work"
        give_up "$package does not hold the pinned files ($(field "$package" 3))"
    }
    rm -f "$work/$package.package"
done
rm -rf "$work"
write_credits
echo "asset pack: $(find "$folder" -type f ! -name ATTRIBUTION.txt | wc -l) files, $(du -sm "$folder" | cut -f 1) MB in $folder; credits in $folder/ATTRIBUTION.txt"
