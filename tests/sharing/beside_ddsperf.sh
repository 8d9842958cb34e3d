#!/usr/bin/env bash
# Latency of messages within this machine: poses of `palpate touch --ros`, pings of `palpate doctor --network`, and, for
# DDS alone, those of Cyclone DDS's own ddsperf (by its own count), on the same loopback, one after another. Exit code
# 77 without ddsperf (cyclonedds-tools).
#   tests/sharing/beside_ddsperf.sh PALPATE ROS_LISTENER [SECONDS]
set -euo pipefail
[ -z "${PALPATE_TESTS_ONLY:-}" ] || { echo "beside_ddsperf: skipped: it has no label $PALPATE_TESTS_ONLY"; exit 77; }
palpate=$(readlink -f "$1") listener=$(readlink -f "$2") seconds=${3:-5}
command -v ddsperf > /dev/null || { echo 'beside_ddsperf: skipped: there is no ddsperf (cyclonedds-tools)'; exit 77; }
folder=$(mktemp -d)
source "$(dirname "$0")/../own_domain.sh"
running=()
end() {
  for process in "${running[@]}"; do kill "$process" 2> /dev/null || true; done
  wait
  rm -rf "$folder"
}
trap end EXIT
fail() { echo "beside_ddsperf: $*" >&2; cat "$folder"/* >&2; exit 1; }

"$palpate" --quiet make sphere -n 5000 -o "$folder/m.ply" > /dev/null
"$listener" "$domain" lab $((seconds + 3)) > "$folder/heard" & hearing=$!
running+=("$hearing")
"$palpate" --quiet touch "$folder/m.ply" --mm-per-unit 1 --backend cpu --realtime --duration "$seconds" --ros lab \
  --domain "$domain" > "$folder/touch" || fail 'touch has failed'
wait "$hearing" || fail 'nothing was heard'
poses=$(sed -n 's/^[0-9]* poses.*; latency of poses/100 Hz, latency/p' "$folder/heard")
[ -n "$poses" ] || fail 'no pose was heard'

"$palpate" serve "$folder/m.ply" --name lab --domain "$domain" > "$folder/serve" 2>&1 &
running+=($!)
until grep -q serving "$folder/serve"; do kill -0 $! || fail 'nothing is served'; sleep 0.05; done
pings=$("$palpate" doctor --network --domain "$domain" | sed -n 's/.*\(round trip .*\)/\1/p')
[ -n "$pings" ] || fail 'doctor has found no session'

# The network as palpate configures it: the loopback, without multicast.
loopback='<Interfaces><NetworkInterface address="127.0.0.1"/></Interfaces><AllowMulticast>false</AllowMulticast>'
peers='<ParticipantIndex>auto</ParticipantIndex><Peers><Peer address="127.0.0.1"/></Peers>'
domains="<Domain id=\"any\"><General>$loopback</General><Discovery>$peers</Discovery></Domain>"
export CYCLONEDDS_URI="<CycloneDDS>$domains</CycloneDDS>"
ddsperf -i "$domain" -D $((seconds + 2)) pong > "$folder/pong" 2>&1 &
running+=($!)
ddsperf -i "$domain" -D "$seconds" ping 100Hz size 128 > "$folder/ping" 2>&1 || true  # it reports its end as an error
theirs=$(sed -n 's/.*\(size 128 mean.*\)/\1/p' "$folder/ping" | tail -1)
[ -n "$theirs" ] || fail 'ddsperf has measured nothing'
echo "poses of touch --ros:      $poses"
echo "palpate doctor --network:  $pings"
echo "ddsperf ping 100Hz:        $theirs"
