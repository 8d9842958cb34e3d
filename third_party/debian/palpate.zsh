#compdef palpate
# Completion of palpate for zsh: the program lists the possible next words, and which files may follow: none, any
# ("/"), those with some endings ("/ .csv .json") or folders alone ("/ /").
_palpate() {
  local -a found
  found=("${(@f)$(${~${(Q)words[1]}} complete -- "${(@Q)words[2,CURRENT]}" 2> /dev/null)}")
  local files=no
  if [[ ${found[-1]:-/} == /* ]]; then
    files=${found[-1]:-/}
    found[-1]=()
  fi
  (( ${#found} )) && compadd -- "${found[@]}"
  [[ $files == no ]] && return
  compset -P '--*='
  case $files in
    /) _files ;;
    '/ /') _files -/ ;;
    *) _files -g "*(${(j:|:)${=files#/}})(-.)" ;;
  esac
}
if [[ ${funcstack[1]} == _palpate ]]; then
  _palpate "$@"
else
  compdef _palpate palpate
fi
