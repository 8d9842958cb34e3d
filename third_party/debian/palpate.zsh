#compdef palpate
# Completion of palpate for zsh: the program itself says what may come next, and whether a file may.
_palpate() {
  local -a found
  found=("${(@f)$(${~${(Q)words[1]}} complete -- "${(@Q)words[2,CURRENT]}" 2> /dev/null)}")
  local files=no
  if [[ ${found[-1]:-/} == / ]]; then
    files=yes
    found[-1]=()
  fi
  (( ${#found} )) && compadd -- "${found[@]}"
  if [[ $files == yes ]]; then
    compset -P '--*='
    _files
  fi
}
if [[ ${funcstack[1]} == _palpate ]]; then
  _palpate "$@"
else
  compdef _palpate palpate
fi
