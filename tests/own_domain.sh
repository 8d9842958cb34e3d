# Reserves a domain of DDS for one test, as own_domain.hpp does; to be sourced. Sets `domain`, and keeps the lock on
# descriptor 8 until the shell and the processes that it has started end.
domain=
for turn in $(seq 600); do
  for i in $(seq 0 79); do
    candidate=$((20 + ($$ + i) % 80))
    file=/tmp/palpate-tests-domain-$candidate
    # A file of another user can be locked, but not written.
    { exec 8< "$file"; } 2> /dev/null || { exec 8>> "$file"; } 2> /dev/null || continue
    flock -n 8 || continue
    domain=$candidate
    break 2
  done
  sleep 0.1
done
[ -n "$domain" ] || { echo 'all domains of /tmp/palpate-tests-domain-* are in use by other tests' >&2; exit 1; }
