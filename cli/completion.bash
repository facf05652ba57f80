# bash completion for ambiance; installed as share/bash-completion/completions/ambiance

_ambiance_options() {
    case $1 in
    list) echo --post --assets --assets-dir --pack --json --names --help ;;
    render) echo --output --time --size --set --aov --post --intermediates --half --float --frame --threads --isa --assets --pack \
        --json --quiet --help ;;
    info) echo --json --help ;;
    compare) echo --tolerance --max-ulp --layer --peak --diff --json --quiet --help ;;
    esac
}

# The scene among the words of the command line, if there is one.
_ambiance_scene() {
    local word names
    names=" $(ambiance list --names 2>/dev/null | tr '\n' ' ') "
    for word in "${COMP_WORDS[@]:2}"; do
        [[ -n $word && $names == *" $word "* ]] && echo "$word" && return
    done
}

_ambiance() {
    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command=${COMP_WORDS[1]}
    COMPREPLY=()
    if ((COMP_CWORD == 1)); then
        mapfile -t COMPREPLY < <(compgen -W "list render info compare --help --version" -- "$word")
        return
    fi
    case $before in
    --isa) mapfile -t COMPREPLY < <(compgen -W "auto v2 v3 v4" -- "$word") && return ;;
    --set)
        mapfile -t COMPREPLY < <(compgen -S = -W "$(ambiance list "$(_ambiance_scene)" --names 2>/dev/null)" -- "$word")
        compopt -o nospace
        return
        ;;
    --post)
        if [[ $command == render ]]; then
            mapfile -t COMPREPLY < <(compgen -W "scene none $(ambiance list --post --names 2>/dev/null)" -- "$word")
            return
        fi
        ;;
    --assets-dir | --pack) mapfile -t COMPREPLY < <(compgen -d -- "$word") && return ;;
    --assets)
        if [[ $command == render ]]; then
            mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -W builtin -- "$word")
            return
        fi
        ;;
    -o | --output | --diff) mapfile -t COMPREPLY < <(compgen -f -- "$word") && compopt -o filenames && return ;;
    --time | --size | --threads | --frame | --tolerance | --max-ulp | --peak | --layer | --aov) return ;;
    esac
    if [[ $word == -* ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(_ambiance_options "$command")" -- "$word")
    elif [[ $command == info || $command == compare ]]; then
        mapfile -t COMPREPLY < <(compgen -f -- "$word")
        compopt -o filenames
    elif [[ " ${COMP_WORDS[*]} " == *" --post "* && $command == list ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$(ambiance list --post --names 2>/dev/null)" -- "$word")
    else
        mapfile -t COMPREPLY < <(compgen -W "$(ambiance list --names 2>/dev/null)" -- "$word")
    fi
}

complete -F _ambiance ambiance
