# SPDX-License-Identifier: MIT
# Completion of tactor for fish. What there is to offer comes from the tool itself.

function __tactor_complete
    set -l words (commandline -opc)
    set -l typed (commandline -ct)
    for line in ($words[1] __complete $words[2..-1] "$typed" 2>/dev/null)
        if test "$line" = :folders
            __fish_complete_directories $typed ''
            continue
        end
        if not string match -q ':files*' -- $line
            echo $line
            continue
        end
        set -l extensions (string match -ra '\.\w+' -- $line)
        # "--array=": the file's name comes after it.
        set -l option (string match -r '^--[^=]*=' -- $typed)
        for path in (__fish_complete_path (string replace -r '^--[^=]*=' '' -- $typed))
            set -l name (string split -f1 \t -- $path)
            if test -z "$extensions"; or string match -q '*/' -- $name; or contains -- (path extension $name) $extensions
                echo "$option$name"
            end
        end
    end
end
complete -c tactor -f -a '(__tactor_complete)'
