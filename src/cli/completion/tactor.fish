# SPDX-License-Identifier: MIT
# Completion of tactor for fish. What there is to offer comes from the tool itself.

function __tactor_complete
    set -l words (commandline -opc)
    set -l typed (commandline -ct)
    for line in ($words[1] __complete $words[2..-1] "$typed" 2>/dev/null)
        if test "$line" != :files
            echo $line
            continue
        end
        # "--array=": the file's name comes after it.
        set -l option (string match -r '^--[^=]*=' -- $typed)
        for path in (__fish_complete_path (string replace -r '^--[^=]*=' '' -- $typed))
            echo "$option"(string split -f1 \t -- $path)
        end
    end
end
complete -c tactor -f -a '(__tactor_complete)'
