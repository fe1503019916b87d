# SPDX-License-Identifier: MIT
# Completion of tactor for bash. What there is to offer comes from the tool itself.

_tactor() {
    local typed=${COMP_LINE:0:COMP_POINT} rest word i line file
    local -a words=()
    # bash splits at ":" and "=" too, as in hw:CARD=Tactor: join again what no blank separates.
    rest=$typed
    for ((i = 0; i <= COMP_CWORD; i++)); do
        word=${COMP_WORDS[i]}
        ((i == COMP_CWORD)) && word=${rest#"${rest%%[![:blank:]]*}"}
        if ((i > 0)) && [[ $rest != [[:blank:]]* && -n $rest ]]; then
            words[-1]+=$word
        else
            words+=("$word")
        fi
        rest=${rest#"${rest%%[![:blank:]]*}"}
        rest=${rest#"$word"}
    done

    # What bash replaces begins after the last of these.
    local current=${words[-1]} breaks=${COMP_WORDBREAKS//[^:=]/} kept=
    [[ -n $breaks ]] && kept=${current%"${current##*[$breaks]}"}
    COMPREPLY=()
    while IFS= read -r line; do
        if [[ $line != :files ]]; then
            line=${line%%$'\t'*}
            COMPREPLY+=("${line#"$kept"}")
            continue
        fi
        compopt -o filenames 2>/dev/null
        [[ $current == --*=* ]] && current=${current#*=}
        while IFS= read -r file; do COMPREPLY+=("$file"); done < <(compgen -f -- "$current")
    done < <("$1" __complete "${words[@]:1}" 2>/dev/null)
}
complete -F _tactor tactor
