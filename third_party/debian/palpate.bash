# Completion of palpate for bash: the program lists the possible next words, and which files may follow: none, any
# ("/"), those with some endings ("/ .csv .json") or folders alone ("/ /").
_palpate() {
  local word=${COMP_WORDS[COMP_CWORD]} found files=/ name ending
  [[ $word != [=:] ]] || word=""
  mapfile -t found < <("${COMP_WORDS[0]/#~/$HOME}" complete -- "${COMP_WORDS[@]:1:COMP_CWORD}" 2> /dev/null)
  COMPREPLY=()
  if ((${#found[@]})); then
    files=
    if [[ ${found[-1]} == /* ]]; then
      files=${found[-1]}
      unset 'found[-1]'
    fi
  fi
  if [[ $files ]]; then
    compopt -o filenames 2> /dev/null
    while IFS= read -r name; do
      [[ $files != / && ! -d ${name/#~/$HOME} ]] || { COMPREPLY+=("$name") && continue; }
      for ending in ${files#/}; do [[ ${name,,} != *"$ending" ]] || { COMPREPLY+=("$name") && break; }; done
    done < <(compgen -f -- "$word")
  fi
  COMPREPLY+=("${found[@]}")
}
complete -F _palpate palpate
