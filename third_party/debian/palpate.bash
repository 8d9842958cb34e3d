# Completion of palpate for bash: the program lists the possible next words, and whether a file may follow.
_palpate() {
  local word=${COMP_WORDS[COMP_CWORD]} found
  [[ $word != "=" ]] || word=""
  mapfile -t found < <("${COMP_WORDS[0]/#~/$HOME}" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  COMPREPLY=()
  if [[ ${found[-1]:-/} == / ]]; then
    unset 'found[-1]'
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames 2> /dev/null
  fi
  COMPREPLY+=("${found[@]}")
}
complete -F _palpate palpate
