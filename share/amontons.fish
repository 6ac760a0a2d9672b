# Completion of amontons in fish; `make install` puts it to share/fish/vendor_completions.d/amontons.fish.

# Folders, and files whose names end on one of the words given.
function __amontons_files
  set start (string replace -r '^--[a-z]+=' '' -- (commandline -ct))
  for name in $start*
    if test -d $name
      echo $name/
    else if contains -- (string match -r '[^.]*$' -- $name) $argv
      echo $name
    end
  end
end

complete -c amontons -f
complete -c amontons -n 'not string match -q -- "-*" (commandline -ct)' -a '(__amontons_files inp)' -d deck
complete -c amontons -l estimate -d 'print unknowns, memory, processor time and the chosen solver, then stop'
complete -c amontons -l explain -d 'list card by card what is used, ignored or refused, then stop'
complete -c amontons -l check -d 'read the deck, check the model, then stop'
complete -c amontons -l resume -d 'continue a job that was stopped, from its checkpoint'
complete -c amontons -l no-checkpoint -d 'write no checkpoint'
complete -c amontons -l threads -x -a '1 2 4 8' -d 'work with N threads'
complete -c amontons -l outdir -x -a '(__fish_complete_directories)' -d 'folder of the result files'
complete -c amontons -l partitions -x -a '2 4 8 16' -d 'divide grid and fields of job.vtkhdf into G files'
complete -c amontons -l dialect -x -a 'abaqus calculix' -d 'what a card means where the two differ'
complete -c amontons -l frd -d 'write all fields to job.frd too'
complete -c amontons -l oldjob -x -a '(__amontons_files res)' -d 'job from whose restart file the deck continues'
complete -c amontons -l global -x -a '(__amontons_files vtkhdf frd)' -d 'results of the global model of a submodel'
complete -c amontons -l user -x -a '(__amontons_files f f90 F90 so)' -d 'routines of the user'
complete -c amontons -l progress -x -a 'auto plain none' -d 'a line per increment'
complete -c amontons -l quiet -d 'write nothing but failures'
complete -c amontons -l cards -d 'list the cards'
complete -c amontons -s v -l version -d 'print the version'
complete -c amontons -s h -l help -d 'print the options'
complete -c amontons -s i -x -a '(__amontons_files inp)' -d 'the job, as CalculiX is called'
