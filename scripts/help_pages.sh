#!/usr/bin/env bash
# SPDX-License-Identifier: BSD-3-Clause
# Generates the man pages and the bash completion of a program from its --help:
#   scripts/help_pages.sh build/package/bin/dyslam-eval OUT
# writes OUT/man1/dyslam-eval.1.gz, one dyslam-eval-SUBCOMMAND.1.gz per subcommand, and
# OUT/completions/dyslam-eval. Needs help2man.
set -euo pipefail
program=$1 out=$2
name=$(basename "$program")
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$out/man1" "$out/completions"

help_of() { "$program" "$@" --help; }
subcommands() { help_of | awk '/^Subcommands:/ {on = 1; next} on && /^  [a-z]/ {print $1}'; }
# help2man reads "-i, --input"; CLI11 writes "-i,--input". Words on a line of their own are options' texts.
readable() { sed -E 's/^(  -[a-zA-Z]),--/\1, --/; s/^(Options|Positionals|Subcommands):$/\n\1:/'; }

# page NAME [SUBCOMMAND]: its first line of help is the page's title.
page() {
  local title=$1 text
  shift
  text=$(help_of "$@")
  { printf '#!/bin/sh\ncase "$1" in --version) echo "%s %s";; *) cat <<"HELP"\n' "$title" "$("$program" --version)"
    tail -n +2 <<<"$text" | readable
    printf 'HELP\n;; esac\n'; } >"$work/$title"
  chmod +x "$work/$title"
  help2man --no-info --section=1 --manual="DySLAM" --source="DySLAM" --name="$(head -1 <<<"$text")" \
    --include=<(printf '[see also]\nThe user guide and a page for each part are in /usr/share/doc/dyslam/doc.\n') \
    "$work/$title" | gzip -9n >"$out/man1/$title.1.gz"
}

options() { help_of "$@" | grep -oE '^  (-[a-zA-Z],)?--?[a-zA-Z][a-zA-Z0-9-]*(,--[a-z0-9-]+)?' | tr ',' '\n' | tr -d ' ' | sort -u | tr '\n' ' '; }
# "--option=word word" for options with a fixed set of words.
choices() { help_of "$@" | sed -nE 's/^  ((-[a-zA-Z]),)?(--[a-z-]+) [A-Z]+:\{([^}]*)\}.*/\2|\3=\4/p' | tr ',' ' '; }
choice_cases() {
  choices "$@" | while IFS='=' read -r option words; do printf '      %s) words="%s" ;;\n' "${option#|}" "$words"; done
}
# completion_case [SUBCOMMAND]: the completions after the word before the cursor.
completion_case() {
  printf '    case $before in\n'
  choice_cases "$@"
  printf '      -c|--config) files=yes words=$(cd /usr/share/dyslam/config_files 2>/dev/null && ls) ;;\n'
  printf '      *) files=yes; [[ $current == -* ]] && files= words="%s" ;;\n    esac\n' "$(options "$@")"
}

page "$name"
all=$(subcommands)
for subcommand in $all; do page "$name-$subcommand" "$subcommand"; done
function=_$(tr - _ <<<"$name")
{
  echo "# bash completion of $name, made from its --help"
  echo "$function() {"
  echo '  local current=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} words= files='
  if [[ -n $all ]]; then
    echo '  case ${COMP_WORDS[1]} in'
    for subcommand in $all; do
      echo "  $subcommand)"
      echo '  if ((COMP_CWORD > 1)); then'
      completion_case "$subcommand"
      echo '  fi ;;'
    done
    echo '  esac'
    echo "  ((COMP_CWORD == 1)) && files= words='$(tr '\n' ' ' <<<"$all") $(options)'"
  else
    completion_case
  fi
  echo '  COMPREPLY=($(compgen -W "$words" -- "$current"))'
  echo '  [[ -n $files ]] && compopt -o default && COMPREPLY+=($(compgen -f -- "$current"))'
  echo '  return 0'
  echo '}'
  echo "complete -F $function $name"
} >"$out/completions/$name"
bash -n "$out/completions/$name"
