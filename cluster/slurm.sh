#!/usr/bin/env bash
# An experiment as a Slurm array, one shard a task, and a job that merges the shards.
#
#   bash cluster/slurm.sh submit N DIR COMMAND...      for example 64 /shared/robust robust --devices 100000
#
# DIR is on a file system that all nodes share. The shards are in DIR/parts, the outputs in DIR/merged.
# PROGRAM is the program, host-sim on the PATH by default, or that of cargo stress (target/release/stress).
# SHARDS are the shards to run, in the form of --array: all by default; 2,5-7 after these were lost.
# SBATCH_OPTIONS are further options of sbatch, for example --time=2:00:00 --partition=long.
set -euo pipefail

program=${PROGRAM:-host-sim}

submit() {
    local n=$1 dir=$2 array merge
    mkdir -p "$dir/parts"
    # shellcheck disable=SC2086
    array=$(sbatch --parsable --array="${SHARDS:-1-$n}" --cpus-per-task=1 --requeue --job-name=shards \
        --output="$dir/parts/%a.log" --open-mode=append ${SBATCH_OPTIONS:-} "$0" shard "$@")
    # The merged run names lost shards, so that it runs after failed ones too.
    # shellcheck disable=SC2086
    merge=$(sbatch --parsable --dependency="afterany:${array%%;*}" --job-name=merge \
        --output="$dir/merge.log" ${SBATCH_OPTIONS:-} "$0" merge "$n" "$dir")
    echo "array $array, merge $merge: $dir/merge.log"
}

shard() {
    local n=$1 dir=$2
    shift 2
    # The tasks share the cores, not the threads of one process.
    export RAYON_NUM_THREADS=${SLURM_CPUS_PER_TASK:-1}
    exec "$program" "$@" --shard "$SLURM_ARRAY_TASK_ID/$n" --out "$dir/parts"
}

merge() {
    local n=$1 dir=$2
    shopt -s nullglob
    local shards=("$dir/parts/shard-"*"-of-$n.jsonl")
    case ${program##*/} in
        stress) exec "$program" --merge "${shards[@]}" ;;
        *) exec "$program" merge "${shards[@]}" --out "$dir/merged" ;;
    esac
}

"$@"
