# SPDX-License-Identifier: BSD-3-Clause
# Completion in bash: source scripts/completion.bash. The help of the program lists the commands, options and values.
_shearwake() {
    local current=${COMP_WORDS[COMP_CWORD]} command= word help choices kind
    for word in "${COMP_WORDS[@]:1:COMP_CWORD-1}"; do
        if [[ $word != -* ]]; then command=$word; break; fi
    done
    help=$("${COMP_WORDS[0]}" ${command:+"$command"} --help 2> /dev/null)
    if [[ $current == -* ]]; then
        choices=$(sed -nE 's/^ +(-[^ ]+).*/\1/p' <<< "$help" | tr , '\n')
    elif [[ -z $command ]]; then
        choices=$(sed -nE 's/^  ([a-z]+)(, [a-z]+)* {2,}.*/\1/p' <<< "$help")
    else # values such as NAME {layered,spectral,pstd}
        choices=$(sed -nE '/^Positionals:/,/^$/s/.*\{(.*)\}.*/\1/p' <<< "$help" | tr , '\n')
    fi
    if [[ $choices ]]; then
        mapfile -t COMPREPLY < <(compgen -W "$choices" -- "$current")
        return
    fi
    kind=$(sed -nE 's/^ +(JOB|CASE|DIR) .*/\1/p' <<< "$help")
    case ${kind%%$'\n'*} in
    JOB) mapfile -t COMPREPLY < <(compgen -d -- "$current"; compgen -f -X '!*.toml' -- "$current") ;;
    CASE) mapfile -t COMPREPLY < <(compgen -d -- "$current"; compgen -f -X '!*.h5' -- "$current") ;;
    DIR) mapfile -t COMPREPLY < <(compgen -d -- "$current") ;;
    *) mapfile -t COMPREPLY < <(compgen -f -- "$current") ;;
    esac
}
complete -o filenames -F _shearwake shearwake
