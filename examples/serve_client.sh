#!/bin/sh
# SPDX-License-Identifier: MIT
# Plays a preset through `tactor serve` from the shell, with socat, and says how it ended.
#   serve_client.sh [SOCKET [STROKE]]     default: $XDG_RUNTIME_DIR/tactor.sock, park2016-1
set -eu
socket=${1:-$XDG_RUNTIME_DIR/tactor.sock}
stroke=${2:-park2016-1}
# Whoever says no more is told how its strokes end, and then the server hangs up.
echo '{"jsonrpc":"2.0","id":1,"method":"play","params":{"stroke":"'"$stroke"'"}}' |
    socat -t 3600 - "UNIX:$socket" |
    sed -n 's/.*"state":"\(finished\|cancelled\|interrupted\)".*/\1/p; s/.*"why":"\([^"]*\)".*/refused: \1/p'
