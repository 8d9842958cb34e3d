# Completion of palpate for bash: commands and options are those that the program names in its help.
_palpate() {
  local word=${COMP_WORDS[COMP_CWORD]} command="" i
  for ((i = 1; i < COMP_CWORD; ++i)); do
    if [[ ${COMP_WORDS[i]} != -* ]]; then command=${COMP_WORDS[i]}; break; fi
  done
  if [[ $word == -* ]]; then
    local options
    options=$({ "${COMP_WORDS[0]}" --help; [[ -z $command ]] || "${COMP_WORDS[0]}" "$command" --help; } 2> /dev/null |
      grep -oE -- '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+' | sort -u)
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    if [[ -z $command ]]; then
      local commands
      commands=$("${COMP_WORDS[0]}" --help 2> /dev/null | sed -n '/^Subcommands:/,/^$/s/^  \([a-z]*\) .*/\1/p')
      mapfile -t -O "${#COMPREPLY[@]}" COMPREPLY < <(compgen -W "$commands" -- "$word")
    fi
    compopt -o filenames 2> /dev/null
  fi
}
complete -F _palpate palpate
