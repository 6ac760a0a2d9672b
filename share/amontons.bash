# Completion of amontons in bash; `make install` puts it to share/bash-completion/completions/amontons.
_amontons() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]}
  local options='--explain --estimate --check --resume --no-checkpoint --threads --outdir --partitions --dialect= --frd --user --oldjob --global --progress= --quiet --cards --version --help -i'
  # bash takes = for a word of its own
  [ "$word" = '=' ] && word=''
  [ "$before" = '=' ] && before=${COMP_WORDS[COMP_CWORD-2]}
  case $before in
    --dialect) COMPREPLY=($(compgen -W 'abaqus calculix' -- "$word")) ;;
    --progress) COMPREPLY=($(compgen -W 'auto plain none' -- "$word")) ;;
    --outdir) COMPREPLY=($(compgen -d -- "$word")) ;;
    --threads) COMPREPLY=($(compgen -W "1 2 4 8 $(nproc 2>/dev/null)" -- "$word")) ;;
    --partitions) COMPREPLY=($(compgen -W '2 4 8 16' -- "$word")) ;;
    --oldjob) COMPREPLY=($(compgen -f -X '!*.res' -- "$word") $(compgen -d -- "$word")) ;;
    --global) COMPREPLY=($(compgen -f -X '!*.@(vtkhdf|frd)' -- "$word") $(compgen -d -- "$word")) ;;
    --user) COMPREPLY=($(compgen -f -X '!*.@(f|f90|F90|so)' -- "$word") $(compgen -d -- "$word")) ;;
    *)
      if [[ $word == -* ]]; then
        COMPREPLY=($(compgen -W "$options" -- "$word"))
        [[ ${COMPREPLY[0]} != *= ]] || compopt -o nospace 2>/dev/null
      else
        COMPREPLY=($(compgen -f -X '!*.inp' -- "$word") $(compgen -d -- "$word"))
      fi
      ;;
  esac
}
shopt -s extglob
complete -o filenames -F _amontons amontons
