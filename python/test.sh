#!/usr/bin/env bash
# Builds the wheel of the Python package, installs it into an environment of its own in target/, and runs
# its tests. Arguments are those of pytest.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(realpath --canonicalize-missing "${CARGO_TARGET_DIR:-target}")

# The tests compare with the programs of the project.
cargo build --release --package host-sim
[ -x "$target/release/stress" ] || cargo build --release --package stress

python3 -m venv "$target/python"
python=$target/python/bin
"$python/pip" install --quiet --requirement python/requirements-test.txt
rm -rf "$target/wheels"
"$python/pip" wheel --quiet --no-deps --wheel-dir "$target/wheels" ./python
"$python/pip" install --quiet --no-deps --force-reinstall "$target"/wheels/limpid-*.whl

cd python
"$python/mypy" --cache-dir "$target/python/mypy" limpid
HOST_SIM=$target/release/host-sim STRESS=$target/release/stress "$python/pytest" -p no:cacheprovider "$@"
