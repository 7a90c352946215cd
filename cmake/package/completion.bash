# Completion in bash for vip-study, vip-stats, vip-bench and vip-view: the commands, options and values that
# their --help lists, and the names of installed protocols.
_vip_lab() {
  local program=$1 word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD - 1]} command='' help words='' share
  COMPREPLY=()
  if [ "$COMP_CWORD" -gt 1 ] && [ "${1##*/}" != vip-view ]; then command=${COMP_WORDS[1]}; fi
  help=$("$program" ${command:+"$command"} --help 2>/dev/null) || return 0
  if [[ $word == -* ]]; then
    words=$(sed -nE 's/^ {2,4}(-[a-z],)?(--[a-z0-9-]+).*/\2/p' <<<"$help")
  elif [[ $before == --* ]]; then  # the values of an option: --help lists "--clock TEXT:{real,virtual}"
    words=$(sed -nE "s/^ {2,4}$before [^ ]*\{([^}]*)\}.*/\1/p" <<<"$help" | tr , ' ')
  elif [ -z "$command" ] && grep -q '^Subcommands:' <<<"$help"; then
    words=$(sed -nE '/^Subcommands:/,$ s/^  ([a-z][a-z0-9-]*) .*/\1/p' <<<"$help")
  fi
  if [ -z "$words" ] && { [ "$before" = --protocol ] || grep -q '^  protocols\? ' <<<"$help"; } && [[ $word != */* ]]; then
    share=$(dirname "$(readlink -f "$(type -P "$program")")")/../share/vip-lab
    words=$(find "$share/protocols" -maxdepth 1 -name '*.toml' -printf '%f\n' 2>/dev/null | sed 's/\.toml$//')
    compopt -o default 2>/dev/null
    mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word"; compgen -f -- "$word")
    return 0
  fi
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -o bashdefault -o default -F _vip_lab vip-study vip-stats vip-bench vip-view
