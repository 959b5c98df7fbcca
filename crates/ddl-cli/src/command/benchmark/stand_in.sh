#!/bin/sh
# A stand-in for `ddl` in tests of `ddl benchmark`. It trains in twenty short epochs, each saved; resumes; exits with 130 on
# an interrupt; scores in one step. Fold `broken` fails to train, fold `stubborn` ignores the first interrupt, fold
# `patient` waits for an interrupt halfway.
verb=$1; shift
while [ $# -gt 0 ]; do
  case "$1" in
    --out|--model) run=$2;;
    --fold) fold=$2;;
    --json) shift; continue;;
  esac
  shift 2
done
echo "pid $$ $verb" >&2
if [ "$verb" = train ]; then
  mkdir -p "$run"
  [ "$fold" = broken ] && { echo "error: the loss is not a number" >&2; exit 1; }
  stopped=
  [ "$fold" = stubborn ] && trap '' TERM || trap 'stopped=1' TERM
  epoch=$(cat "$run/epoch" 2>/dev/null || echo 0)
  begun=$epoch
  echo "from epoch $epoch" >&2
  while [ "$epoch" -lt 20 ]; do
    sleep 0.05
    epoch=$((epoch + 1)); echo "$epoch" > "$run/epoch"
    echo "{\"stage\":\"train\",\"done\":$epoch,\"total\":20,\"message\":\"epoch $epoch\"}"
    [ "$fold" = stubborn ] && sleep 5
    while [ "$fold" = patient ] && [ "$begun" = 0 ] && [ "$epoch" -ge 10 ] && [ -z "$stopped" ]; do sleep 0.05; done
    [ -n "$stopped" ] && exit 130
  done
  exit 0
fi
echo "not json"
echo '{"stage":"score","done":1,"total":1,"message":""}'
echo '{}' > "$run/report.json"
