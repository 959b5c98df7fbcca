#!/bin/bash
# Measures a card (gpu.md). Without one: DEV=cpu SHORT=1 bash gpu.sh
DEV=${DEV:-cuda} OUT=${OUT:-out} R=${R:-/tmp/runs} F="eth hotel univ zara1 zara2"
mkdir -p $OUT
torch=$(python3 -c "import os,torch;print(os.path.dirname(torch.__file__))")
export PATH=$PATH:/usr/local/nvidia/bin:/usr/local/cuda/bin
export GLIBC_TUNABLES=glibc.malloc.hugetlb=1 LD_LIBRARY_PATH=${LIBTORCH:-$torch}/lib DDL_DATASETS=$PWD/star
E="--epochs 3" P="25 400 10000" ONE=100000
[ $SHORT ] && E="--epochs 1 --train-pedestrians 600" P=25 ONE=400
part() { n=$1 t=$2; shift 2; timeout $t "$@" >$OUT/$n.txt 2>&1; echo $n: $?; }
train() { ./ddl train --device $DEV --threads 3 "$@"; }
published() { train --recipe published "$@"; }
forecasts() { for m in $F; do for d in cpu $DEV; do
  ./ddl forecast walk.csv --fps 2.5 --last --model $m --device $d -o $OUT/$m-$d.csv; done
  paste -d, $OUT/$m-{cpu,$DEV}.csv | awk -F, -v m=$m 'NR>1{n=NF/2;for(i=1;i<=n;i++){d=$i-$(i+n);d*=d;if(d>w)w=d}}
    END{print m,NR,"rows, at most",sqrt(w),"apart"}'; done; }
export -f train published forecasts; export DEV R E F
part info 30 bash -c "./ddl info; nvidia-smi"
part gradients 60 ./gradients every_device
part forecasts 60 bash -c forecasts
part one 60 bash -c "published --fold eth $E --out $R/one; cat $R/one/*.jsonl"
part recommended 60 bash -c "train --fold eth $E --proposal-steps 200 --out $R/two; cat $R/two/*.jsonl"
part crowd 40 ./latency --bench crowd $DEV $P
part one-path 30 ./latency --bench crowd one $DEV $ONE
part profile 60 ncu --metrics gpu__time_duration.sum --csv -s 150 -c 3500 ./ddl train --recipe published --fold eth \
  --device $DEV --epochs 1 --out $R/profile
nvidia-cuda-mps-control -d
export CUDA_MPS_ACTIVE_THREAD_PERCENTAGE=50
part runs ${LONG:-120} ./ddl benchmark --profile paper --protocol published --device $DEV --out $R/runs
cp $R/runs/report.md $OUT
echo quit | nvidia-cuda-mps-control
